"""Forms of cards that decks of others have: tied pairs, loads on each element, values beyond a record, fields that are not there.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.conftest import Run
from verify.readers.dat_frd_files import read_dat

DIGITS = 2e-6  # seven digits are printed
LAW = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.25\n*DENSITY\n1.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"


def cubes(gap: float = 0.0) -> str:
    """Two unit cubes one above the other, the upper one a gap higher, with nodes of their own."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{1 + i + 2 * j + 4 * k + 8 * body}, {i}, {j}, {k + body * (1 + gap)}" for body in (0, 1) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=E", *(f"{1 + b}, " + ", ".join(str(n + 8 * b) for n in (1, 2, 4, 3, 5, 6, 8, 7)) for b in (0, 1))]
    lines += ["*NSET, NSET=FLOOR\n1, 2, 3, 4", "*NSET, NSET=TOP\n13, 14, 15, 16", "*SURFACE, NAME=UP\n1, S2", "*SURFACE, NAME=DOWN\n2, S1"]
    return "\n".join(lines) + "\n" + LAW + "*BOUNDARY\nFLOOR, 1, 3\n"


def step(loads: str, name: str = "ALL") -> str:
    """A static step that prints displacements."""
    return f"*STEP\n*STATIC\n{loads}*NODE PRINT, NSET={name}\nU\n*END STEP\n"


def displacements(run_deck: Run, tmp_path: Path, deck: str, *options: str) -> dict[object, tuple[float, ...]]:
    """The displacements at the end of a job that finishes."""
    done = run_deck(deck, *options)
    assert done.returncode == 0, done.stdout + done.stdout
    return {k: tuple(v) for k, v in read_dat(tmp_path / "job.dat")[-1].rows.items()}


PULL = "*CLOAD\nTOP, 3, 2.\nTOP, 1, 1.\n"
INTERACTION = "*SURFACE INTERACTION, NAME=I\n"


def test_a_tied_pair_is_a_tie(run_deck: Run, tmp_path: Path) -> None:
    """*CONTACT PAIR, TIED, ADJUST=d gives *TIE with the position tolerance d, digit for digit, and pulls."""
    deck = cubes(0.01)
    tied = displacements(run_deck, tmp_path, deck + INTERACTION + "*CONTACT PAIR, INTERACTION=I, TIED, ADJUST=0.02\nDOWN, UP\n" + step(PULL))
    tie = displacements(run_deck, tmp_path, deck + "*TIE, NAME=T, POSITION TOLERANCE=0.02\nDOWN, UP\n" + step(PULL))
    assert tied == tie
    assert sum(row[2] for k, row in tied.items()) > 0.01


def test_a_tied_pair_out_of_reach_holds_nothing(run_deck: Run) -> None:
    """Nodes farther away than ADJUST are not tied: the upper cube is free, which ends the job."""
    done = run_deck(cubes(0.01) + INTERACTION + "*CONTACT PAIR, INTERACTION=I, TIED, ADJUST=0.001\nDOWN, UP\n" + step(PULL))
    assert done.returncode != 0


N = 1500  #: elements with a load of their own


def test_loads_on_single_elements(run_deck: Run, tmp_path: Path) -> None:
    """A bar of many elements in tension along x, each with a body force of its own: the end moves by the sum of f L x / (E A).

    With nu = 0 the bar is one of uniform strain in each element; force b_e on element e of length h and E = 1000: the nodal forces of
    the element are half at each of its ends, so the end moves by sum b_e h (x_e) / E with x_e the middle of the element."""
    h = 0.5
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{1 + 4 * i + k}, {h * i}, {k % 2}, {k // 2}" for i in range(N + 1) for k in range(4)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=E"]
    lines += [f"{1 + i}, " + ", ".join(str(1 + 4 * i + k) for k in (0, 4, 5, 1, 2, 6, 7, 3)) for i in range(N)]
    lines += ["*NSET, NSET=END", str(1 + 4 * N), LAW.replace("0.25", "0.").strip(), "*BOUNDARY", "1, 1, 3", "2, 1", "3, 1", "4, 1", "2, 3", "3, 2"]
    forces = [1e-3 * (1 + i % 7) for i in range(N)]
    loads = "*DLOAD\n" + "".join(f"{1 + i}, BX, {f:.6g}\n" for i, f in enumerate(forces))
    expected = sum(f * h * (i + 0.5) * h for i, f in enumerate(forces)) / 1000.0
    (row,) = displacements(run_deck, tmp_path, "\n".join(lines) + "\n" + step(loads, "END")).values()
    assert row[0] == pytest.approx(expected, rel=DIGITS)


def test_values_beyond_a_record(run_deck: Run, tmp_path: Path) -> None:
    """CalculiX reads E, nu and a temperature of *ELASTIC and passes over the rest, with a note here; Abaqus's form is an error."""
    tie = "*TIE, NAME=T\nDOWN, UP\n"
    plain = cubes() + tie + step(PULL)
    longer = plain.replace("1000., 0.25", "1000., 0.25, , 7.")
    assert displacements(run_deck, tmp_path, longer, "--dialect=calculix") == displacements(run_deck, tmp_path, plain, "--dialect=calculix")
    assert "the first 3 values count" in run_deck(longer, "--dialect=calculix").stdout
    done = run_deck(longer)
    assert done.returncode == 3
    assert "4 values; at most 3" in done.stdout


@pytest.mark.parametrize("field", ["ROTATION", "HYDROSTATIC FLUID PRESSURE", "TEMPERATURE", "VOLUMETRIC LAGRANGE MULTIPLIER"])
def test_controls_of_other_fields(run_deck: Run, tmp_path: Path, field: str) -> None:
    """*CONTROLS for a field that is not there changes nothing; for displacements an invalid value is an error."""
    deck = cubes() + "*TIE, NAME=T\nDOWN, UP\n"
    card = f"*CONTROLS, PARAMETERS=FIELD, FIELD={field}\n-1., 1., , , , , ,\n"
    assert displacements(run_deck, tmp_path, deck + step(card + PULL)) == displacements(run_deck, tmp_path, deck + step(PULL))
    assert run_deck(deck + step(card.replace(field, "DISPLACEMENT") + PULL)).returncode == 3


def test_a_surface_without_faces(run_deck: Run, tmp_path: Path) -> None:
    """A surface without faces is a note if no card names it, else an error."""
    deck = cubes() + "*TIE, NAME=T\nDOWN, UP\n*SURFACE, NAME=NONE\n"
    displacements(run_deck, tmp_path, deck + step(PULL))
    done = run_deck(deck + step(PULL + "*DSLOAD\nNONE, P, 1.\n"))
    assert done.returncode == 3
    assert "The surface 'NONE' has no faces." in done.stdout


def test_global_axes(run_deck: Run, tmp_path: Path) -> None:
    """*SYSTEM without data is the global system; with data it is refused."""
    deck = cubes() + "*TIE, NAME=T\nDOWN, UP\n" + step(PULL)
    assert displacements(run_deck, tmp_path, "*SYSTEM\n" + deck) == displacements(run_deck, tmp_path, deck)
    done = run_deck("*SYSTEM\n0., 0., 0., 1., 0., 0.\n" + deck)
    assert done.returncode == 3
    assert "Local axes of coordinates are not supported" in done.stdout


def test_an_amplitude_in_a_file(run_deck: Run, tmp_path: Path) -> None:
    """*AMPLITUDE, INPUT=file is the same as its data lines."""
    deck = cubes() + "*TIE, NAME=T\nDOWN, UP\n*AMPLITUDE, NAME=A{}\n" + step(PULL.replace("*CLOAD", "*CLOAD, AMPLITUDE=A"))
    (tmp_path / "history.txt").write_text("0., 0., 1., 0.5\n")
    written = displacements(run_deck, tmp_path, deck.format("\n0., 0., 1., 0.5"))
    assert displacements(run_deck, tmp_path, deck.format(", INPUT=history.txt")) == written


def test_a_moment_in_the_plane_needs_no_follower(run_deck: Run, tmp_path: Path) -> None:
    """In a plane model *CLOAD, FOLLOWER with a moment is the moment; in space it is refused."""
    deck = """*NODE, NSET=ALL
1, 0., 0.
2, 4., 0.
3, 4., 1.
4, 0., 1.
9, 4., 0.5
*ELEMENT, TYPE=CPE4, ELSET=E
1, 1, 2, 3, 4
*NSET, NSET=END
2, 3
*RIGID BODY, NSET=END, REF NODE=9
""" + LAW + "*BOUNDARY\n1, 1, 2\n4, 1, 2\n"
    moment = "*CLOAD{}\n9, 6, 5.\n"
    large = step(moment).replace("*STEP", "*STEP, NLGEOM")
    plain, turning = (displacements(run_deck, tmp_path, deck + large.format(word)) for word in ("", ", FOLLOWER"))
    assert plain == turning
    space = cubes() + "*NODE\n90, 0.5, 0.5, 2.\n*TIE, NAME=T\nDOWN, UP\n*RIGID BODY, NSET=TOP, REF NODE=90\n"
    done = run_deck(space + large.format(", FOLLOWER").replace("9, 6", "90, 6"))
    assert done.returncode == 3
    assert "FOLLOWER turns forces" in done.stdout


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
def test_parameters_of_beams_that_statics_does_not_need(run_deck: Run, tmp_path: Path, dialect: str) -> None:
    """LUMPED, ROTARY INERTIA and POISSON as Abaqus/CAE writes them change no digit of a cantilever, F l^3/(3 E I) at its end."""
    nodes = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {i}.\n" for i in range(9))
    beams = "*ELEMENT, TYPE=B31, ELSET=E\n" + "".join(f"{i + 1}, {i + 1}, {i + 2}\n" for i in range(8))
    law = "*MATERIAL, NAME=M\n*ELASTIC\n1e5, 0.25\n*BOUNDARY\n1, 1, 6\n*NSET, NSET=TIP\n9\n"
    section = "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT{}\n1., 1.\n0., 1., 0.\n"
    extra = ", LUMPED=NO, ROTARY INERTIA=EXACT, POISSON=0.3, TEMPERATURE=GRADIENTS"
    rows = [displacements(run_deck, tmp_path, nodes + beams + law + section.format(more) + step("*CLOAD\nTIP, 3, -10.\n", "TIP"), f"--dialect={dialect}")
            for more in ("", extra)]
    assert rows[0] == rows[1]
    exact = 10 * 8**3 / (3 * 1e5 / 12)  # bending alone
    assert next(iter(rows[0].values()))[2] == pytest.approx(-exact, rel=0.03)  # shear adds 1 % at this length, and two-node beams are too stiff by 1 %


def test_a_pair_of_a_missing_surface_of_shells(run_deck: Run) -> None:
    """A contact pair of shells whose slave surface is missing is an error with its line, as in any model."""
    deck = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n*ELEMENT, TYPE=S4, ELSET=E\n1, 1, 2, 3, 4\n"
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SHELL SECTION, ELSET=E, MATERIAL=M\n0.1\n*SURFACE, NAME=S\nE, SPOS\n"
    done = run_deck(deck + INTERACTION + "*CONTACT PAIR, INTERACTION=I\nMISSING, S\n" + step(""))
    assert done.returncode == 3
    assert "There is no surface 'MISSING'" in done.stdout, done.stdout


def test_data_of_failure_theories(run_deck: Run, tmp_path: Path) -> None:
    """*FAIL STRESS and *FAIL STRAIN give data for output that is not written: they are read past with a note."""
    deck = cubes() + "*TIE, NAME=T\nDOWN, UP\n"
    cards = "*FAIL STRESS\n1830., -1096., 57., -228., 71., -1., 0.\n*FAIL STRAIN\n0.01, -0.01, 0.02, -0.02, 0.03\n"
    longer = deck.replace("*DENSITY", cards + "*DENSITY")
    assert displacements(run_deck, tmp_path, longer + step(PULL)) == displacements(run_deck, tmp_path, deck + step(PULL))
    assert "*FAIL STRESS is read past" in run_deck(longer + step(PULL)).stdout
