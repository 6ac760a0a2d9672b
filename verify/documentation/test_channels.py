"""The conda recipe and the container file: they render, and name what the tree has.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re

import pytest

from verify.conftest import ROOT


def test_conda_recipe() -> None:
    """The recipe renders for this version, with the libraries that the program is linked with."""
    rattler_build = pytest.importorskip("rattler_build")
    recipe = rattler_build.Stage0Recipe.from_yaml((ROOT / "share" / "conda" / "recipe.yaml").read_text())
    variants = rattler_build.VariantConfig.from_yaml("c_compiler: [gcc]\nfortran_compiler: [gfortran]\nc_stdlib: [sysroot]\n")
    (rendered,) = [variant.recipe for variant in recipe.render(variants)]
    version = re.search(r"VERSION = '(.*)'", (ROOT / "src" / "base" / "version.f90").read_text())
    assert version
    assert str(rendered.package.version) == version.group(1)
    assert {"suitesparse", "metis", "hdf5", "openblas", "zlib"} <= {str(name) for name in rendered.requirements.host}


def test_targets_of_the_channels() -> None:
    """The targets and files that recipe and container file name exist."""
    makefile = (ROOT / "Makefile").read_text()
    words = (ROOT / "Containerfile").read_text() + (ROOT / "share" / "conda" / "recipe.yaml").read_text()
    targets = re.findall(r"\bmake (?:BUILD=portable )?(?:\S+=\S+ )*([a-z-]+)", words)
    assert {"deb", "build", "place"} <= set(targets)
    for target in {"deb", "build", "place"}:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target
    assert (ROOT / "input" / "three_cubes.inp").exists()
