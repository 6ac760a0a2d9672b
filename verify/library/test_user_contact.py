"""FRIC and UINTER of the user: equal to what *FRICTION and *SURFACE BEHAVIOR give.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

import amontons
from verify.conftest import Run
from verify.library.common import ROOT

ROUTINES = ROOT / "verify" / "library" / "routines" / "contact.f90"
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"
MU, SLOPE, STIFFNESS = 0.3, 2.0e4, 5.0e4
LINEAR = f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{STIFFNESS:g}, 1e-9, 1e-3\n"
SOFT = f"*SURFACE INTERACTION, NAME=I\n{LINEAR}*FRICTION\n{MU:g}, {SLOPE:g}\n"
SOFT_FRIC = f"*SURFACE INTERACTION, NAME=I\n{LINEAR}*FRICTION, USER, DEPVAR=2, PROPERTIES=2\n{MU:g}, {SLOPE:g}\n"
UINTER = f"*SURFACE INTERACTION, NAME=I, USER, DEPVAR=2, PROPERTIES=3\n1.\n{STIFFNESS:g}, {MU:g}, {SLOPE:g}\n"
HARD = f"*SURFACE INTERACTION, NAME=I\n*FRICTION\n{MU:g}\n"
HARD_FRIC = f"*SURFACE INTERACTION, NAME=I\n*FRICTION, USER=FRIC, PROPERTIES=1\n{MU:g}\n"


def rubbed(interaction: str, *, is_plane: bool = False, nlgeom: bool = False, dialect: str = "calculix", drag: float = 0.02) -> str:
    """A block on a larger one, pressed, then dragged along both its sides, so that some nodes stick and some slip."""
    from verify.decks import make_decks, planes, sheets

    if is_plane:
        below = planes.flatten(sheets.sheet("BELOW", sheets.between(0, 3, 6), sheets.between(-1, 0, 3)))
        above = planes.flatten(sheets.sheet("ABOVE", sheets.between(0.7, 2.1, 4), sheets.between(0, 1, 2)))
        down = 2
    else:
        ticks = np.linspace(0.0, 3.0, 5)
        below = make_decks.block(ticks, ticks, np.linspace(-1, 0, 3), "BELOW")
        above = make_decks.block(np.linspace(0.7, 2.1, 3), np.linspace(0.6, 1.9, 3), np.linspace(0, 1, 3), "ABOVE")
        down = 3
    move = f"ABOVE_TOP, 1, 1, {drag:g}\n" + ("" if is_plane else f"ABOVE_TOP, 2, 2, {0.4 * drag:g}\n")
    head = "*STEP" + (", NLGEOM" if nlgeom else "")
    steps = (
        f"{head}\n*STATIC\n0.5, 1.\n{TIGHT}*BOUNDARY\nBELOW_BOTTOM, 1, 3\nABOVE_TOP, 1, {down - 1}\nABOVE_TOP, {down}, {down}, -0.02\n*END STEP\n"
        f"{head}\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY\n{move}*END STEP\n"
    )
    pair = interaction + "*CONTACT PAIR, INTERACTION=I\nABOVE_BOTTOM, BELOW_TOP\n"
    parts = [(below, (2000.0, 0.3)), (above, (1000.0, 0.3))]
    deck = planes.flat_deck(parts, "CPE4", pair + steps) if is_plane else sheets.solid_deck(parts, pair, steps)
    return f"** dialect: {dialect}\n" + deck


def compare(run: Run, folder: Path, ours: str, theirs: str, tolerance: float, work_tolerance: float = 1e-6) -> None:
    """Displacements, reactions and contact forces at the end, relative to the largest; both stick and slip occur."""
    (folder / "ours.inp").write_text(ours)
    (folder / "theirs.inp").write_text(theirs)
    done = run(["ours"], cwd=folder)
    assert done.returncode == 0, done.stdout
    done = run(["theirs", f"user={ROUTINES}"], cwd=folder)
    assert done.returncode == 0, done.stdout
    with h5py.File(folder / "ours.vtkhdf") as a, h5py.File(folder / "theirs.vtkhdf") as b:
        for name in ("U", "RF", "CNORMF", "CSHEARF"):
            n = int(a["VTKHDF/NumberOfPoints"][0])
            x, y = a["VTKHDF/PointData"][name][-n:], b["VTKHDF/PointData"][name][-n:]
            assert np.abs(x).max() > 0, name
            assert np.abs(x - y).max() <= tolerance * np.abs(x).max(), name
        work = [f["AMONTONS/history/friction_work"][-1] for f in (a, b)]
        assert work[0] > 0
        assert abs(work[0] - work[1]) <= work_tolerance * work[0]
        status = a["VTKHDF/PointData/CSTATUS"][:]
        assert (status == 1).any()
        assert (status == 2).any()


@pytest.mark.parametrize("is_plane", [False, True])
@pytest.mark.parametrize("nlgeom", [False, True])
def test_fric_is_friction_with_a_stick_slope(run: Run, tmp_path: Path, is_plane: bool, nlgeom: bool) -> None:
    """The same return mapping in FRIC, its elastic slip in STATEV."""
    ours, theirs = (rubbed(law, is_plane=is_plane, nlgeom=nlgeom) for law in (SOFT, SOFT_FRIC))
    compare(run, tmp_path, ours, theirs, 1e-7)


@pytest.mark.parametrize("is_plane", [False, True])
def test_uinter_is_linear_with_friction(run: Run, tmp_path: Path, is_plane: bool) -> None:
    """Pressure and shear by UINTER; LINEAR's tail of 1e-9 is what remains."""
    ours, theirs = (rubbed(law, is_plane=is_plane) for law in (SOFT, UINTER))
    compare(run, tmp_path, ours, theirs, 1e-7)


@pytest.mark.parametrize("is_plane", [pytest.param(False, marks=pytest.mark.slow), True])
def test_fric_with_exact_contact(run: Run, tmp_path: Path, is_plane: bool) -> None:
    """LM = 1 is exact sticking, LM = 0 slips by the stress that FRIC gives: Coulomb's law under HARD contact. In space
    a node may go to slip in another iteration, and the increments may be others: the work of friction differs by their length."""
    ours, theirs = (rubbed(law, is_plane=is_plane, dialect="abaqus") for law in (HARD, HARD_FRIC))
    compare(run, tmp_path, ours, theirs, 1e-5, work_tolerance=0.01)


def test_fric_that_sticks_under_a_law(run: Run, tmp_path: Path) -> None:
    """LM = 1 under a compliant law: the stick slope gives the shear, as under *FRICTION with a coefficient that is never reached."""
    never = 1e3
    ours = rubbed(f"*SURFACE INTERACTION, NAME=I\n{LINEAR}*FRICTION\n{never:g}\n", dialect="abaqus")
    theirs = rubbed(f"*SURFACE INTERACTION, NAME=I\n{LINEAR}*FRICTION, USER=FRIC, PROPERTIES=1\n{never:g}\n", dialect="abaqus")
    (tmp_path / "ours.inp").write_text(ours)
    (tmp_path / "theirs.inp").write_text(theirs)
    assert run(["ours"], cwd=tmp_path).returncode == 0
    done = run(["theirs", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "ours.vtkhdf") as a, h5py.File(tmp_path / "theirs.vtkhdf") as b:
        n = int(a["VTKHDF/NumberOfPoints"][0])
        for name in ("U", "CNORMF", "CSHEARF"):
            x, y = a["VTKHDF/PointData"][name][-n:], b["VTKHDF/PointData"][name][-n:]
            assert np.abs(x - y).max() <= 1e-7 * np.abs(x).max(), name
        for file in (a, b):
            assert (file["VTKHDF/PointData/CSTATUS"][-n:] == 1).any()
            assert not (file["VTKHDF/PointData/CSTATUS"][-n:] == 2).any()


def test_slip_scenarios_under_fric(run: Run, tmp_path: Path) -> None:
    """The limit of a node is the shear that FRIC gives: what slides steadily is slip in equilibrium, and no node that sticks is searched for."""
    (tmp_path / "job.inp").write_text(rubbed(HARD_FRIC, is_plane=True, dialect="abaqus", drag=0.2))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        table = file["AMONTONS/iterations"]
        status, scenario, balanced = (table[name][:] for name in ("n_status", "n_scenario", "n_balanced"))
    assert status[-1, 2] > 0
    assert balanced[-1] == status[-1, 2]
    assert np.all(scenario.sum(axis=1) + balanced <= status.sum(axis=1))


def test_surfaces_are_by_mortar(run: Run, tmp_path: Path) -> None:
    """Surface to surface under calculix is at points, for which there is no STATEV: a message says that another method replaces them."""
    deck = rubbed(SOFT_FRIC).replace("*CONTACT PAIR, INTERACTION=I", "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE")
    (tmp_path / "job.inp").write_text(deck)
    assert "by the dual mortar method here" in run(["--explain", "job"], cwd=tmp_path).stdout
    (tmp_path / "job.inp").write_text(rubbed(SOFT_FRIC))
    assert "by the dual mortar method here" not in run(["--explain", "job"], cwd=tmp_path).stdout


def test_state_is_kept_with_the_increment(tmp_path: Path) -> None:
    """A rollback brings STATEV of FRIC back: the same increment again gives the same bits."""
    with amontons.Job(text=rubbed(SOFT_FRIC), user=ROUTINES) as job:
        for _ in range(3):
            job.advance()
        job.try_step(0.25)
        first = [job.get(name).tobytes() for name in ("U", "S", "RF")]
        job.rollback()
        job.try_step(0.125)
        job.rollback()
        job.try_step(0.25)
        assert [job.get(name).tobytes() for name in ("U", "S", "RF")] == first


def test_the_example_of_the_manual(run: Run, tmp_path: Path) -> None:
    """The cube of the manual in the end slides: its shear force is mu times the pressing force."""
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text()
    routines = [block.split("```")[0] for block in page.split("```fortran\n")[1:]]
    (tmp_path / "mine.f90").write_text(next(text for text in routines if "subroutine fric" in text.lower()))
    (tmp_path / "job.inp").write_text(page.split("```abaqus-fric\n")[1].split("```")[0])
    done = run(["job", "user=mine.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        force = file["VTKHDF/PointData/RF"][-n:][4:8].sum(axis=0)
    assert force[2] < 0
    assert force[0] == pytest.approx(-0.25 * force[2], rel=1e-5)


@pytest.mark.parametrize(
    ("law", "sentence"),
    [
        (SOFT_FRIC.replace("PROPERTIES=2", "PROPERTIES=20"), "the data lines hold only"),
        (UINTER + "*FRICTION\n0.1\n", "UINTER gives friction too"),
        (UINTER + LINEAR, "UINTER gives the pressure too"),
        (HARD_FRIC.replace("USER=FRIC", "USER=COEFFICIENT"), "Write it as FRIC"),
    ],
)
def test_cards_that_are_wrong(run: Run, tmp_path: Path, law: str, sentence: str) -> None:
    """Each is reported with its line."""
    (tmp_path / "job.inp").write_text(rubbed(law))
    done = run(["job", f"user={ROUTINES}"], cwd=tmp_path)
    assert done.returncode == 3
    assert sentence in done.stdout


@pytest.mark.parametrize(("law", "name"), [(HARD_FRIC, "FRIC"), (UINTER, "UINTER")])
def test_routines_that_are_missing(run: Run, tmp_path: Path, law: str, name: str) -> None:
    """A file without them, and no file at all."""
    (tmp_path / "job.inp").write_text(rubbed(law))
    done = run(["job", f"user={ROUTINES.with_name('j2.f')}"], cwd=tmp_path)
    assert done.returncode == 4
    assert name in done.stdout
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 2
    assert name in done.stdout
