"""Writes the page of all modules from the table of src/README.md and the first line of each file:

    python -m verify.tools.module_table > doc/developer/modules.md

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator

from verify.tools.lint import Module, in_order, read_layers, read_modules


def first_sentence(module: Module) -> str:
    """What the module says of itself."""
    return module.lines[0].removeprefix("!> ").replace("*", "\\*").replace("|", "\\|")


def public_types(module: Module) -> Iterator[tuple[str, str]]:
    """The public types of a module, each with the first line of its docstring."""
    public = set(re.findall(r"\w+_type\b", " ".join(re.findall(r"^  public ::(?:[^\n]*&\n)*[^\n]*", "\n".join(module.lines), re.M))))
    for number, line in enumerate(module.lines):
        if (found := re.match(r"  type(?:\s*,[^:]*)?\s*::\s*(\w+)$", line)) and found[1] in public:
            above = number
            while module.lines[above - 1].lstrip().startswith("!"):
                above -= 1
            yield found[1], module.lines[above].strip().removeprefix("!>").strip().replace("|", "\\|")


def page() -> str:
    """A table for each folder, bottom-up, and one of all public types."""
    modules = {module.name: module for module in read_modules()}
    layers = read_layers()
    order = in_order(modules, list(layers))[0]
    lines = ["# All modules", "", "Written by `make doc` from `src/README.md`, the `use` lines and the first line of each file, bottom-up."]
    for folder, sentence in layers.items():
        lines += ["", f"## {folder}", "", sentence, "", "| module | what it holds | uses |", "|---|---|---|"]
        lines += [f"| `{name}` | {first_sentence(modules[name])} | {', '.join(modules[name].uses)} |"
                  for name in order if modules[name].folder == folder]
    lines += ["", "## Public types", "", "| type | module | what it is |", "|---|---|---|"]
    types = sorted((name, module, sentence) for module in order for name, sentence in public_types(modules[module]))
    lines += [f"| `{name}` | `{module}` | {sentence} |" for name, module, sentence in types]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(page())
