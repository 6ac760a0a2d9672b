"""CETOL: the increments of creep are as long as its accuracy allows, against closed forms."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

CUBE = (
    "*NODE, NSET=ALL\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n"
    "*NSET, NSET=RIGHT\n2, 3, 6, 7\n*NSET, NSET=LEFT\n1, 4, 5, 8\n*NSET, NSET=FRONT\n1, 2, 5, 6\n*NSET, NSET=BELOW\n1, 2, 3, 4\n"
    "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\nLEFT, 1\nFRONT, 2\nBELOW, 3\n"
)
DIALECTS = ("abaqus", "calculix")


def material(young: float, creep: str) -> str:
    """Norton creep."""
    return f"*MATERIAL, NAME=M\n*ELASTIC\n{young}, .3\n*CREEP\n{creep}\n"


def increments(folder: Path) -> list[float]:
    """The lengths of the accepted increments of the last step."""
    rows = [line.split() for line in (folder / "job.sta").read_text(encoding="utf-8").splitlines()]
    steps = [row for row in rows if row and row[0].isdigit() and not row[2].endswith("U")]
    return [float(row[6]) for row in steps if row[0] == steps[-1][0]]


def finish(run_deck: Run, deck: str, dialect: str) -> str:
    """The output of a job that ends well."""
    done = run_deck(deck, f"--dialect={dialect}")
    assert done.returncode == 0, done.stdout + done.stderr
    return " ".join((done.stdout + done.stderr).split())


def relaxing(procedure: str, out: str = "*EL PRINT, ELSET=E\nS\n") -> str:
    """A bar of E = 1e5 is stretched to 300 and held for a time of 1000, with the rate 1e-12 q^4."""
    text = CUBE + material(1e5, "1e-12, 4., 0.") + "*STEP\n*STATIC\n*BOUNDARY\nRIGHT, 1, 1, .003\n*END STEP\n"
    return text + f"*STEP, INC=10000\n*VISCO{procedure}\n{out}*END STEP\n"


def relaxed(time: float) -> float:
    """q' = -E A q^n from 300."""
    return (300.0**-3 + 3 * 1e5 * 1e-12 * time) ** (-1 / 3)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_relaxing_bar(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """A relaxing bar against (q0^-3 + 3 E A t)^(-1/3).

    The error of backward Euler is half the sum of the differences that CETOL limits: E times half of n CETOL for n increments bounds
    the error of the stress (the flow relaxes it), and a hundredth of CETOL, in ten times as many increments, divides it by more
    than five.
    """
    errors, counts = [], []
    for cetol in (1e-5, 1e-7):
        finish(run_deck, relaxing(f", CETOL={cetol}\n.01, 1000., 1e-9"), dialect)
        stress = read_dat(tmp_path / "job.dat")[-1].rows[(1, 1)][0]
        errors.append(abs(stress - relaxed(1000.0)))
        counts.append(len(increments(tmp_path)))
        assert errors[-1] <= 0.5 * counts[-1] * cetol * 1e5
    assert errors[0] < 0.76  # CalculiX 2.20 with CETOL=1e-5 ends at 15.687, 0.75 from the closed form 14.938
    assert errors[1] < errors[0] / 5
    assert 5 * counts[0] < counts[1] < 20 * counts[0]


@pytest.mark.parametrize("dialect", DIALECTS)
def test_primary_creep_bar(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """A bar under 82 for 72000 in one *VISCO step of growing increments: A q^n t^(m+1)/(m+1) to the digits of the loose criteria."""
    text = CUBE + material(210000.0, "4.38e-18, 7.27, -.47")
    text += "*STEP, INC=1000\n*VISCO, CETOL=1e-4\n1., 72000., 1e-8\n*DLOAD\n1, P4, -82.\n*NODE PRINT, NSET=RIGHT\nU\n*END STEP\n"
    finish(run_deck, text, dialect)
    closed = 4.38e-18 * 82**7.27 * 72000**0.53 / 0.53 + 82 / 210000
    assert read_dat(tmp_path / "job.dat")[-1].rows[(7,)][0] == pytest.approx(closed, rel=1e-4)  # CalculiX 2.20: 0.9 % less
    lengths = increments(tmp_path)
    assert lengths[0] < 0.1  # at once 1 would creep by 5e-4 from rest: more than CETOL
    assert max(lengths) > 100


@pytest.mark.parametrize("dialect", DIALECTS)
def test_each_increment_is_within_the_tolerance(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """The rates times the lengths, from the printed stresses: A (q0^n - q1^n) dt of each increment, the greatest near CETOL."""
    cetol = 1e-5
    finish(run_deck, relaxing(f", CETOL={cetol}\n1., 1000., 1e-9"), dialect)
    tables = read_dat(tmp_path / "job.dat")
    times, stresses = [0.0], [300.0]
    for table in tables:
        times.append(table.time - 1.0)
        stresses.append(table.rows[(1, 1)][0])
    found = [1e-12 * (a**4 - b**4) * (t1 - t0) for a, b, t0, t1 in zip(stresses, stresses[1:], times, times[1:], strict=False)]
    assert max(found) <= 1.001 * cetol
    assert max(found) > 0.8 * cetol  # the next length aims at 0.85 of it


@pytest.mark.parametrize("dialect", DIALECTS)
def test_without_cetol_no_increment_is_longer_than_the_first(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """Nothing says how long increments of creep may be: they stay as the deck has the first, unless it gives the largest."""
    said = finish(run_deck, relaxing("\n5., 1000."), dialect)
    assert increments(tmp_path) == pytest.approx([5.0] * 200)
    assert "Without CETOL nothing limits the error of creep" in said
    said = finish(run_deck, relaxing("\n5., 1000., , 50."), dialect)
    assert max(increments(tmp_path)) == pytest.approx(50.0)
    assert "Without CETOL" not in said


@pytest.mark.parametrize("dialect", DIALECTS)
def test_direct_warns(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """DIRECT keeps the increments; a line says by how much CETOL is exceeded."""
    said = finish(run_deck, relaxing(", CETOL=1e-5, DIRECT\n100., 1000."), dialect)
    assert len(increments(tmp_path)) == 10
    first = read_dat(tmp_path / "job.dat")[0].rows[(1, 1)][0]
    ratio = 1e-12 * (300.0**4 - first**4) * 100 / 1e-5
    given = re.search(r"differ by ([0-9.]+) CETOL; DIRECT keeps its length", said)
    assert given
    assert float(given[1]) == pytest.approx(ratio, rel=1e-4)
    said = finish(run_deck, relaxing(", CETOL=1e-5, DIRECT\n.001, .01"), dialect)
    assert "CETOL" not in said


def test_creep_that_no_increment_holds(run_deck: Run) -> None:
    """The least increment is too long: exit 5, with the element and what to do."""
    done = run_deck(relaxing(", CETOL=1e-5\n100., 1000., 100."))
    assert done.returncode == 5
    said = " ".join((done.stdout + done.stderr).split())
    assert "CREEP: the creep strains by the conditions at the end and at the start of the increment differ by" in said
    assert "CETOL in element 1" in said
    assert "a smaller least increment (the third number after *VISCO)" in said


@pytest.mark.parametrize("value", ["0.", "-1e-5"])
def test_refused(run_deck: Run, value: str) -> None:
    """An invalid tolerance."""
    done = run_deck(relaxing(f", CETOL={value}\n1., 1000."))
    assert done.returncode == 3
    assert "CETOL must be positive" in " ".join((done.stdout + done.stderr).split())


def test_factor_of_the_cut_back(run_deck: Run, tmp_path: Path) -> None:
    """DA of CONTROLS: the second attempt is DA times CETOL over the difference found by the first."""
    lengths = []
    for factor in (0.85, 0.5):
        controls = f"*CONTROLS, PARAMETERS=TIME INCREMENTATION\n8, 12\n, , , {factor}\n"
        finish(run_deck, relaxing(", CETOL=1e-5\n100., 1000., 1e-9", controls + "*EL PRINT, ELSET=E\nS\n"), "abaqus")
        rows = [line.split() for line in (tmp_path / "job.sta").read_text(encoding="utf-8").splitlines()]
        lengths.append([float(row[6]) for row in rows if row and row[0] == "2" and row[1] == "1"][1])
    assert lengths[1] / lengths[0] == pytest.approx(0.5 / 0.85, rel=1e-4)
