"""The package with what it drives: libamontons.so beside the modules, the program in bin.

Both come from the tree around this folder: those of AMONTONS_LIB and AMONTONS_BIN, else what `make` builds there. Without that tree
(this folder alone) the package has no library of its own and looks for an installed one.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

TREE = Path(__file__).resolve().parent.parent
HAS_TREE = (TREE / "Makefile").exists() and (TREE / "src" / "driver").exists()


def built() -> list[tuple[Path, str]]:
    """Library and program with their places in the package; built first unless they are given."""
    if "AMONTONS_LIB" not in os.environ:
        kept = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
        subprocess.run(["make", "-C", str(TREE), "build"], env=kept, check=True)
    library = TREE / os.environ.get("AMONTONS_LIB", "lib") / "libamontons.so"
    program = TREE / os.environ.get("AMONTONS_BIN", "bin") / "amontons"
    return [(library, "libamontons.so"), (program, "bin/amontons"), (TREE / "LICENSE", "LICENSE")]


class WithLibrary(build_py):
    """Adds library and program to the modules."""

    def run(self) -> None:
        """Copies them, without the names for debuggers."""
        super().run()
        if not HAS_TREE or self.editable_mode:
            return
        for source, place in built():
            target = Path(self.build_lib) / "amontons" / place
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, target)
            if source.name != "LICENSE" and shutil.which("strip"):
                subprocess.run(["strip", "--strip-debug", str(target)], check=True)


class ForThisPlatform(bdist_wheel):
    """Any Python 3, but one kind of machine."""

    def get_tag(self) -> tuple[str, str, str]:
        """The middle part says that no C interface of Python is used."""
        return ("py3", "none", super().get_tag()[2])


class Binary(Distribution):
    """A package that is not the same on all machines."""

    def has_ext_modules(self) -> bool:
        """With the library it is not."""
        return HAS_TREE


setup(cmdclass={"build_py": WithLibrary, "bdist_wheel": ForThisPlatform} if HAS_TREE else {}, distclass=Binary)
