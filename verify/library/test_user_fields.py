"""Field variables by a routine USDFLD (*USER DEFINED FIELD): a graded bar, a stiffness that breaks, cut-backs, resumed jobs, bad decks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.independent.results import read_field
from verify.library.common import ROOT, check_shorter_increments

USDFLD = ROOT / "verify" / "library" / "routines" / "usdfld.f90"
DECK_ERROR, USAGE, SETUP, NOT_CONVERGED = 3, 2, 4, 5
MODULUS, BROKEN = 1000.0, 500.0


def bar(n: int, kind: str, material: str, steps: str) -> str:
    """n elements along x, of length 1 in all and section 0.01; LEFT is held along x, RIGHT is the loaded end, and nu is 0."""
    side = 0.1
    section = {"C3D8": [(0, 0), (side, 0), (side, side), (0, side)], "CPS4": [(0, 0), (side, 0)], "T3D2": [(0, 0)]}[kind.rstrip("R")]
    m = len(section)
    lines = ["*NODE, NSET=ALL", *(f"{m * i + k + 1}, {i / n}, {y}, {z}" for i in range(n + 1) for k, (y, z) in enumerate(section))]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=BAR")
    for e in range(n):
        near, far = [m * e + k + 1 for k in range(m)], [m * (e + 1) + k + 1 for k in range(m)]
        row = {8: near + far, 4: [near[0], far[0], far[-1], near[-1]], 2: near[:1] + far[:1]}[2 * m]
        lines.append(", ".join(map(str, [e + 1, *row])))
    left, right = ", ".join(map(str, range(1, m + 1))), ", ".join(str(m * n + k + 1) for k in range(m))
    thickness = {"C3D8": "", "CPS4": f"{side}\n", "T3D2": f"{side * side}\n"}[kind.rstrip("R")]
    held = {"C3D8": "1, 2, 3\n2, 3\n4, 2\n", "CPS4": "1, 2\n", "T3D2": "ALL, 2, 3\n"}[kind.rstrip("R")]
    return "\n".join([*lines, "*NSET, NSET=LEFT", left, "*NSET, NSET=RIGHT", right, material,
                      f"*SOLID SECTION, ELSET=BAR, MATERIAL={material.split('NAME=')[1].split(chr(10))[0]}"]) \
        + f"\n{thickness}*BOUNDARY\nLEFT, 1\n{held}{steps}"  # fmt: skip


def law(name: str, rows: str, variables: int = 0) -> str:
    """A material whose modulus depends on field variable 1."""
    depvar = f"*DEPVAR\n{variables}\n" if variables else ""
    return f"*MATERIAL, NAME={name}\n*ELASTIC, DEPENDENCIES=1\n{rows}\n{depvar}*USER DEFINED FIELD"


GRADED = law("GRADED", f"{MODULUS}, 0., , 0.\n{2 * MODULUS}, 0., , 1.")
FRAGILE = law("BROKEN", f"{MODULUS}, 0., , 0.\n{BROKEN}, 0., , 1.", 2)
PULL = "*STEP{nlgeom}\n*STATIC, DIRECT\n0.1, 1.\n*BOUNDARY\nRIGHT, 1, 1, 0.01\n*EL PRINT, ELSET=BAR\nSDV\n*END STEP\n"


@pytest.mark.parametrize(("kind", "m"), [("C3D8R", 4), ("CPS4R", 2)])
def test_graded_bar(kind: str, m: int, run: Run, tmp_path: Path) -> None:
    """E = E0 (1 + x): the end moves by F/(A E0) ln 2; elements of one point sum h/E at their middles."""
    n, force = 20, 0.3
    (tmp_path / "job.inp").write_text(bar(n, kind, GRADED, f"*STEP\n*STATIC\n1., 1.\n*CLOAD\nRIGHT, 1, {force / m}\n*END STEP\n"))
    done = run(["job", f"user={USDFLD}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    end = read_field(tmp_path / "job.vtkhdf", "U")[-1][-m:, 0]
    middles = (np.arange(n) + 0.5) / n
    assert end == pytest.approx(force / 0.01 / MODULUS * (1 / (1 + middles)).sum() / n, rel=1e-9)
    # the midpoint rule of 1/(1 + x) lacks h^2/24 3/4, which is h^2/22.2 of ln 2
    assert end == pytest.approx(force / 0.01 / MODULUS * np.log(2), rel=1 / (22 * n**2))


def expected_forces() -> np.ndarray:
    """At the ends of the increments: E u A, E by the largest stress at the starts."""
    stress, modulus, forces = 0.0, MODULUS, []
    for u in np.arange(1, 11) * 0.001:
        modulus = BROKEN if stress > 5.5 else modulus
        stress = modulus * u
        forces.append(stress * 0.01)
    return np.array(forces)


def right_forces(path: Path, m: int) -> np.ndarray:
    """The force on the loaded end in each frame but the first."""
    return np.array([rf[-m:, 0].sum() for rf in read_field(path, "RF")])[1:]


@pytest.mark.parametrize(("kind", "m"), [("C3D8", 4), ("CPS4", 2), ("T3D2", 1)])
def test_stiffness_that_breaks(kind: str, m: int, run: Run, tmp_path: Path) -> None:
    """GETVRM gives the stress at the start of the increment; STATEV is kept, printed, and written."""
    (tmp_path / "job.inp").write_text(bar(3, kind, FRAGILE, PULL.format(nlgeom="")))
    done = run(["job", f"user={USDFLD}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert right_forces(tmp_path / "job.vtkhdf", m) == pytest.approx(expected_forces(), rel=1e-9)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        statev = np.asarray(file["AMONTONS/integration_points/SDV"])[-1]
    assert statev.tolist() == [1, 10]


def test_resumed_job(run: Run, tmp_path: Path) -> None:
    """A job that the routine ends in the sixth increment resumes bitwise with one that does not."""
    text = USDFLD.read_text()
    place = "    statev(2) = statev(2) + 1\n"
    assert text.count(place) == 1
    (tmp_path / "ends.f90").write_text(text.replace(place, f"{place}    if (kinc == 6) call xit\n"))
    deck = bar(3, "C3D8", FRAGILE, PULL.format(nlgeom=", NLGEOM"))
    for folder in ("whole", "parts"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "job.inp").write_text(deck)
    assert run(["job", f"user={USDFLD}"], cwd=tmp_path / "whole").returncode == 0
    assert run(["job", f"user={tmp_path / 'ends.f90'}"], cwd=tmp_path / "parts").returncode == NOT_CONVERGED
    assert run(["--resume", "job", f"user={USDFLD}"], cwd=tmp_path / "parts").returncode == 0
    whole, parts = (tmp_path / folder / "job.vtkhdf" for folder in ("whole", "parts"))
    assert np.array_equal(right_forces(whole, 4), right_forces(parts, 4))


def test_shorter_increments(run: Run, tmp_path: Path) -> None:
    """PNEWDT below 1 repeats the increment with a shorter one."""
    deck = bar(2, "C3D8", law("SLOW", f"{MODULUS}, 0., , 0.\n{BROKEN}, 0., , 1."), PULL.format(nlgeom="").replace(", DIRECT", "").replace("*EL PRINT, ELSET=BAR\nSDV\n", ""))
    check_shorter_increments(run, tmp_path, deck, USDFLD, 0.05)
    assert right_forces(tmp_path / "job.vtkhdf", 4)[-1] == pytest.approx(MODULUS * 0.01 * 0.01, rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "words", "code", "message"),
    [
        ("", "", [], USAGE, "*USER DEFINED FIELD needs the user routine USDFLD"),
        ("", "", [f"user={ROOT / 'verify/library/routines/loads.f90'}"], SETUP, "needs the user routine USDFLD, which is not in"),
        ("*USER DEFINED FIELD\n", "", [f"user={USDFLD}"], DECK_ERROR, "has *DEPVAR but no *USER MATERIAL or *USER DEFINED FIELD"),
        ("*USER DEFINED FIELD\n", "*USER DEFINED FIELD\n*USER MATERIAL, CONSTANTS=0\n", [f"user={USDFLD}"], DECK_ERROR,
         "has *USER MATERIAL beside laws of ours"),
        ("BROKEN", "STOPPED", [f"user={USDFLD}"], NOT_CONVERGED, "A user routine has ended the job (XIT or STDB_ABQERR)"),
    ],
)  # fmt: skip
def test_errors(old: str, new: str, words: list[str], code: int, message: str, run: Run, tmp_path: Path) -> None:
    """Each with a sentence and its exit code."""
    deck = bar(2, "C3D8", FRAGILE, PULL.format(nlgeom=""))
    (tmp_path / "job.inp").write_text(deck.replace(old, new) if old else deck)
    done = run(["job", *words], cwd=tmp_path)
    assert done.returncode == code, done.stdout + done.stderr
    assert message in " ".join((done.stdout + done.stderr).split())


def test_manual(run: Run, tmp_path: Path) -> None:
    """The bar of the manual: E is 1500 and 2500 in the middle of its two elements; STATEV is the stress at the start of the last
    increment, half of 15.
    """
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text().split("## USDFLD\n")[1]
    for name, kind in (("my.f90", "fortran"), ("job.inp", "abaqus-usdfld")):
        (tmp_path / name).write_text(page.split(f"```{kind}\n")[1].split("```")[0])
    done = run(["job", "user=my.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert read_field(tmp_path / "job.vtkhdf", "U")[-1][-4:, 0] == pytest.approx(15 / 1500 + 15 / 2500, rel=1e-9)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert np.asarray(file["AMONTONS/integration_points/SDV"])[-2:] == pytest.approx(7.5, rel=1e-9)
