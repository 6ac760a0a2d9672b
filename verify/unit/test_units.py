"""Runs every unit test program that make built: one test for each `test_*.f90` below this folder."""

import os
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
PROGRAMS = HERE.parent.parent / os.environ.get("AMONTONS_UNITS", "build/unit")
TIME_LIMIT = 300  # [s]


@pytest.mark.parametrize("name", sorted(path.stem for path in HERE.glob("*/test_*.f90")))
def test_unit(name: str, tmp_path: Path) -> None:
    """The program ends well, says how many checks passed, and none failed."""
    program = PROGRAMS / name
    assert program.exists(), f"{program} is not there; `make unit` builds it."
    done = subprocess.run([program], cwd=tmp_path, capture_output=True, text=True, timeout=TIME_LIMIT)
    output = f"{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    assert done.returncode == 0, f"{name} ended with {done.returncode}:\n{output}"
    last_line = (done.stdout.splitlines() or [""])[-1]
    assert last_line.strip().endswith("passed, 0 failed"), f"{name} did not come to its end:\n{output}"
