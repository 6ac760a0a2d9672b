"""Writes the page of all modules from the table of src/README.md and the first line of each file:

    python -m verify.tools.module_table > doc/developer/modules.md

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys

from verify.tools.lint import Module, in_order, read_layers, read_modules


def first_sentence(module: Module) -> str:
    """What the module says of itself."""
    return module.lines[0].removeprefix("!> ").replace("*", "\\*").replace("|", "\\|")


def page() -> str:
    """A table for each folder, bottom-up."""
    modules = {module.name: module for module in read_modules()}
    layers = read_layers()
    order = in_order(modules, list(layers))[0]
    lines = ["# All modules", "", "Written by `make doc` from `src/README.md`, the `use` lines and the first line of each file, bottom-up."]
    for folder, sentence in layers.items():
        lines += ["", f"## {folder}", "", sentence, "", "| module | what it holds | uses |", "|---|---|---|"]
        lines += [f"| `{name}` | {first_sentence(modules[name])} | {', '.join(modules[name].uses)} |"
                  for name in order if modules[name].folder == folder]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(page())
