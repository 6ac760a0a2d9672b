"""The examples: they are what a user copies from, so they must run and be right.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from verify.library.common import cubes  # noqa: F401

HERE = Path(__file__).resolve().parent


def build(command: list[str], folder: Path) -> None:
    """Runs a compiler."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def run_example(program: Path, *words: str) -> str:
    """Runs a program that must end well."""
    done = subprocess.run([str(program), *words], cwd=program.parent, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.skipif(not shutil.which("gcc"), reason="there is no C compiler")
def test_two_coupled_jobs_in_c(root: Path, library: Path, tmp_path: Path) -> None:
    """Two bars in series agree with the closed form to 1e-12; the program itself judges."""
    build(["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", f"-I{root / 'src' / 'driver'}", str(HERE / "coupled_jobs.c"),
           "-o", "coupled_jobs", str(library), f"-Wl,-rpath,{library.parent}", "-lm"], tmp_path)  # fmt: skip
    assert "both done: 1" in run_example(tmp_path / "coupled_jobs")


@pytest.mark.skipif(not shutil.which("gfortran"), reason="there is no Fortran compiler")
def test_fortran_program(root: Path, library: Path, cubes: Path, tmp_path: Path) -> None:
    """The Fortran face: looks ahead, rolls back exactly, and ends with Amontons' law."""
    modules = Path(os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    build(["gfortran", "-std=f2018", f"-I{root / modules}", str(HERE / "press_and_look.f90"), "-o", "press_and_look",
           str(library), f"-Wl,-rpath,{library.parent}"], tmp_path)  # fmt: skip
    assert "friction over normal force:  0.300000" in run_example(tmp_path / "press_and_look", str(cubes))


def test_mu_is_identified_from_a_force_curve(cubes: Path) -> None:
    """A curve made with mu = 0.234567 gives it back to 1e-6."""
    from verify.library import identify_mu

    mu, runs = identify_mu.identify_mu(cubes, identify_mu.drag_forces(cubes, 0.234567))
    assert abs(mu - 0.234567) < 1e-6
    assert runs < 12


def test_staggered_loop_with_rollback() -> None:
    """The wall (stiffness 1000) and the flow (stiffness 400) meet at u = -h k / (E + k), to 1e-12, in few tries."""
    from verify.library import staggered

    displacements, tries = staggered.couple(400.0, 0.01)
    for window, displacement in enumerate(displacements, 1):
        assert abs(displacement + 0.01 * window / 4 * 400 / 1400) < 1e-12
    assert max(tries) <= 5
