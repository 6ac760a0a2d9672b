"""The command `amontons` of the Python package: it becomes the program that came with it.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import NoReturn

HERE = Path(__file__).resolve().parent
#: Of the package, of the tree around it, of `make install`.
PLACES = (HERE / "bin" / "amontons", HERE.parent.parent / "bin" / "amontons", HERE.parent.parent.parent.parent / "bin" / "amontons")


def program() -> Path:
    """The program.

    Raises:
        FileNotFoundError: the package was installed without it, and lies in no tree that is built.
    """
    for place in PLACES:
        if place.exists():
            return place
    raise FileNotFoundError("This package has no program amontons: it was installed without the tree of sources around it.")


def main_ccx() -> NoReturn:
    """In place of ccx: the same in the calculix dialect."""
    main("--dialect", "calculix")


def main(*options: str) -> NoReturn:
    """Runs the program with options and the words of the command line; does not come back."""
    try:
        path = str(program())
    except FileNotFoundError as error:
        print(f"*ERROR: {error}", file=sys.stderr)
        sys.exit(7)
    os.execv(path, [path, *options, *sys.argv[1:]])
