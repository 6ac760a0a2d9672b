"""UMAT with DELETE on *DEPVAR, field variables of the nodes (PREDEF) and USDFLD beside UMAT.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.independent.results import read_field
from verify.library.common import ROOT
from verify.library.test_user_fields import bar, right_forces

ROUTINES = ROOT / "verify" / "library" / "routines" / "fields.f90"
E, LIMIT, AREA = 1000.0, 0.005, 0.01
DECK_ERROR, NOT_CONVERGED = 3, 5


def law(limit: float, *, delete: str = ", DELETE=1", more: str = "") -> str:
    """The material of the routines."""
    return f"*MATERIAL, NAME=M\n*USER MATERIAL, CONSTANTS=2\n{E}, {limit}\n*DEPVAR{delete}\n4\n{more}".rstrip("\n")


def steps(*ends: float, nlgeom: str = "") -> str:
    """The loaded end moves, ten increments a step."""
    return "".join(f"*STEP{nlgeom}\n*STATIC\n0.1, 1., 0.1, 0.1\n*BOUNDARY\nRIGHT, 1, 1, {u}\n*EL PRINT, ELSET=BAR\nSDV\n*END STEP\n" for u in ends)


def state(path: Path) -> np.ndarray:
    """STATEV of the points at the end."""
    with h5py.File(path) as file:
        values = np.asarray(file["AMONTONS/integration_points/SDV"])
        return values[-(len(values) // len(file["VTKHDF/Steps/Values"])) :]


KINDS = [("C3D8", 4), ("C3D8R", 4), ("CPS4", 2), ("CPS4R", 2), ("T3D2", 1)]


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize(("kind", "m"), KINDS)
def test_bar_that_breaks(run: Run, tmp_path: Path, kind: str, m: int, nlgeom: str) -> None:
    """A bar of two elements, the left one four times as stiff: the right one breaks where its strain exceeds the limit. The bar then
    carries no force, also when it is pushed back; the left part springs back, and the job continues to the end."""
    deck = bar(2, kind, law(LIMIT), steps(0.01, -0.001, nlgeom=nlgeom))
    strong = law(0.0).replace("NAME=M", "NAME=STRONG").replace(f"{E}", f"{4 * E}")
    section = "*SOLID SECTION, ELSET=BAR, MATERIAL=M"
    thickness = deck.split(section + "\n")[1].split("*BOUNDARY")[0]
    deck = deck.replace(section, f"*ELSET, ELSET=FIRST\n1\n*ELSET, ELSET=SECOND\n2\n{strong}\n*SOLID SECTION, ELSET=FIRST, MATERIAL=STRONG\n{thickness}"
                        "*SOLID SECTION, ELSET=SECOND, MATERIAL=M")  # fmt: skip
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    force = right_forces(tmp_path / "job.vtkhdf", m)
    u = np.arange(1, 11) * 0.001
    strain = u * 4 / 5 / 0.5
    whole = strain <= LIMIT
    expected = np.where(whole, E * strain * AREA, 0.0)
    assert 0 < whole.sum() < 10
    assert np.abs(force[:10] - expected).max() <= (0.02 if nlgeom else 1e-9) * expected.max()
    assert np.abs(force[~np.r_[whole, np.zeros(10, bool)]]).max() <= 1e-9 * expected.max(), "for good, in compression too"
    middle = read_field(tmp_path / "job.vtkhdf", "U")[-1][m : 2 * m, 0]
    assert np.abs(middle).max() <= 1e-9, "the left part is free of stress"
    points = state(tmp_path / "job.vtkhdf")
    half = len(points) // 2
    assert (points[:half, 0] == 1).all()
    assert (points[half:, 0] == 0).all()


def test_all_points_deleted(run: Run, tmp_path: Path) -> None:
    """A bar whose elements are all gone: no force; nodes stay where they are, or finite; under a force the job ends with a message."""
    (tmp_path / "job.inp").write_text(bar(4, "C3D8", law(LIMIT), steps(0.01)))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert right_forces(tmp_path / "job.vtkhdf", 4)[-1] == pytest.approx(0.0, abs=1e-12)
    assert np.abs(read_field(tmp_path / "job.vtkhdf", "U")[-1]).max() <= 0.01 + 1e-12
    loaded = steps(0.01).replace("*BOUNDARY\nRIGHT, 1, 1, 0.01", f"*CLOAD\nRIGHT, 1, {E * 2 * LIMIT * AREA / 4}")
    (tmp_path / "job.inp").write_text(bar(4, "C3D8", law(LIMIT), loaded))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == NOT_CONVERGED, done.stdout


@pytest.mark.parametrize(("value", "is_there"), [("", True), ("*INITIAL CONDITIONS, TYPE=SOLUTION\n2, 0., 0., 0., 0.\n", False)])
def test_state_at_the_start(run: Run, tmp_path: Path, value: str, is_there: bool) -> None:  # noqa: FBT001
    """The variable is 1 at the start; initial conditions may delete an element from the start, and others keep 1."""
    (tmp_path / "job.inp").write_text(bar(2, "C3D8", law(0.0), value + steps(0.01)))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert right_forces(tmp_path / "job.vtkhdf", 4)[-1] == pytest.approx(E * 0.01 * AREA if is_there else 0.0, rel=1e-9, abs=1e-12)
    assert state(tmp_path / "job.vtkhdf")[:, 0].tolist() == [1.0] * 8 + [1.0 if is_there else 0.0] * 8


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("DELETE=1", "DELETE=5", "DELETE must be the number of a state variable, 1 to 4"),
        (f"*USER MATERIAL, CONSTANTS=2\n{E}, {LIMIT}", f"*USER DEFINED FIELD\n*ELASTIC\n{E}, 0.", "has DELETE on *DEPVAR but no *USER MATERIAL"),
    ],
)
def test_wrong_cards(run: Run, tmp_path: Path, old: str, new: str, words: str) -> None:
    """Numbers of no variable, and materials without UMAT."""
    deck = bar(2, "C3D8", law(LIMIT), steps(0.01))
    assert deck.count(old) == 1
    (tmp_path / "job.inp").write_text(deck.replace(old, new))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == DECK_ERROR, done.stdout
    assert words in " ".join((done.stdout + done.stderr).split())


@pytest.mark.parametrize(("kind", "m"), [("C3D8", 4), ("CPS4", 2), ("T3D2", 1)])
def test_usdfld_before_umat(run: Run, tmp_path: Path, kind: str, m: int) -> None:
    """UMAT gets the field variable and the STATEV that USDFLD gave: E (1 - e/2/0.01), e the strain at the start of the increment."""
    (tmp_path / "job.inp").write_text(bar(3, kind, law(0.0, delete="", more="*USER DEFINED FIELD\n"), steps(0.008)))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    u = np.arange(1, 11) * 0.0008
    before = np.r_[0.0, u[:-1]]
    assert right_forces(tmp_path / "job.vtkhdf", m) == pytest.approx(E * (1 - 0.5 * before / 0.01) * u * AREA, rel=1e-9)
    points = state(tmp_path / "job.vtkhdf")
    assert points[:, 2].tolist() == [10.0] * len(points), "calls of USDFLD, one an increment"
    assert points[:, 3] == pytest.approx(-0.5 * before[-1] / 0.01, rel=1e-9)


def test_field_variables_of_nodes(run: Run, tmp_path: Path) -> None:
    """*FIELD without USDFLD: PREDEF at the start of the increment, DPRED its change; E (1 + f) grows with it."""
    initial = "*INITIAL CONDITIONS, TYPE=FIELD\nALL, 0.5\n"
    field = "*FIELD\nALL, 1.5\n*EL PRINT"
    (tmp_path / "job.inp").write_text(bar(3, "C3D8", law(0.0, delete=""), initial + steps(0.008).replace("*EL PRINT", field)))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    t = np.arange(1, 11) / 10
    assert right_forces(tmp_path / "job.vtkhdf", 4) == pytest.approx(E * (1 + 0.5 + t) * 0.008 * t * AREA, rel=1e-9)
    assert state(tmp_path / "job.vtkhdf")[:, 3] == pytest.approx(1.4, rel=1e-9)
    assert "no effect" not in done.stdout + done.stderr


def test_usdfld_writes_behind_field(run: Run, tmp_path: Path) -> None:
    """A field variable that does not exist: named, in place of damage to the memory."""
    text = ROUTINES.read_text().replace("  statev(3) =", "  field(nfield + 2) = 1\n  statev(3) =")
    (tmp_path / "wrong.f90").write_text(text)
    (tmp_path / "job.inp").write_text(bar(3, "C3D8", law(0.0, delete="", more="*USER DEFINED FIELD\n"), steps(0.008)))
    done = run(["job", "user=wrong.f90"], cwd=tmp_path)
    assert done.returncode == NOT_CONVERGED, done.stdout
    assert "The routine USDFLD of wrong.f90 is wrong at element 1, integration point 1" in done.stdout
    assert "it wrote number 3 of the array FIELD, which has 1." in done.stdout
