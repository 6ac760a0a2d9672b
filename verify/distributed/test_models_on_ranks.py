"""Embedded elements, submodels, shells and composite shells on several ranks against the serial program.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from verify.cases.constraints.test_embedded_elements import bar, beam
from verify.cases.contact.test_no_separation import blocks
from verify.cases.contact.test_no_separation import deck as deck_of_blocks
from verify.decks.beams import beam as beam_of_elements
from verify.decks.beams import rectangle
from verify.decks.shells import Shell, held, section, shell
from verify.decks.submodels import CARD, block, homogeneous_global, plate_global, plate_submodel, submodel
from verify.distributed.ranks_and_serial import DIALECT, TOLERANCE, difference, program, run, with_solver

if not program("amontons-mpi").exists():
    pytest.skip("there is no amontons-mpi: make MPI=1 builds it", allow_module_level=True)
if shutil.which("mpiexec") is None:
    pytest.skip("there is no mpiexec", allow_module_level=True)

LOW, HIGH = np.zeros(3), np.array([4.0, 3.0, 2.0])
FINITE = "*STEP, NLGEOM, INC=100\n*STATIC\n0.5, 1.\n"
ITERATED = 1e-7  #: of a field: a direction of Newton's method is solved to a thousandth of its tolerance
THIN = 1e-8  #: of a field of shells: rounding times the condition of bending, (length over thickness) squared
LAYERS = "*MATERIAL, NAME=M\n*ELASTIC\n210000., .3\n*MATERIAL, NAME=SOFT\n*ELASTIC\n20000., .2\n*SHELL SECTION, ELSET=E, COMPOSITE{}\n.1, 3, M\n.2, 3, SOFT\n.1, 3, M\n"


def assert_equal_on_ranks(folder: Path, deck: str, tolerance: float, *options: str, solver: str = "") -> None:
    """Equal statuses, increments and Newton iterations on 1, 2 and 4 ranks, and fields within the tolerance of their largest value; by the
    default solver on one rank the same bits."""
    serial = run(folder / "serial", deck, 0, *options)
    assert serial.code == 0, serial.text
    assert np.abs(serial.fields["U"]).max() > 0
    for n in (1, 2, 4):
        what, worst = difference(serial, run(folder / f"ranks{n}", with_solver(deck, solver), n, *options))
        assert what == "" and worst <= (0.0 if n == 1 and not solver else tolerance), f"{n} ranks: {what} {worst}"


@pytest.mark.parametrize("solver", ["", "ITERATIVE SCALING", "MUMPS"])
@pytest.mark.parametrize("kind", ["C3D8", "C3D20R"])
def test_embedded_bars(tmp_path: Path, kind: str, solver: str) -> None:
    """Bars through hosts of several parts, under a shear and NLGEOM."""
    _, cards = beam(kind, (6, 2, 2))
    points = np.stack([np.linspace(0.1, 3.9, 9), np.linspace(0.3, 0.7, 9), np.full(9, 0.61)], axis=1)
    deck = cards + "*SOLID SECTION, ELSET=BODY, MATERIAL=CONCRETE\n" + bar(points) + "*EMBEDDED ELEMENT, HOST ELSET=BODY\nBAR\n"
    deck += FINITE + "*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 1, 0.04\nRIGHT, 2, 2, 0.2\nRIGHT, 3, 3\n*END STEP\n"
    assert_equal_on_ranks(tmp_path, deck, ITERATED if solver else TOLERANCE, solver=solver)


@pytest.mark.parametrize("kind", ["NODE TO SURFACE", "SURFACE TO SURFACE"])
def test_surfaces_that_do_not_part(tmp_path: Path, kind: str) -> None:
    """A cube that pulls at its table with its heel and presses it with its toe, with friction (finer criteria: fields follow the last iterate)."""
    bodies = blocks((6, 4), margin=1.0)
    cards = f"*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, NO SEPARATION\n*FRICTION\n0.8\n*CONTACT PAIR, INTERACTION=I, TYPE={kind}\nUP_W0, LOW_W1\n"
    start = "*STEP, NLGEOM\n*STATIC\n0.5, 1.\n*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10\n*BOUNDARY\n"
    cards += f"{start}LOW_W0, 1, 3\nUP_W1, 1, 2\nUP_W1, 3, 3, -0.001\n*END STEP\n{start}UP_W1, 1, 1, 0.1\n*END STEP\n"
    assert_equal_on_ranks(tmp_path, deck_of_blocks(bodies, cards), TOLERANCE)


@pytest.mark.parametrize("kind", ["C3D8", "C3D10"])
def test_submodel(tmp_path: Path, kind: str) -> None:
    """A submodel driven by a global model over all its increments; the global model is computed on ranks, too."""
    steps = "*STEP, NLGEOM\n*STATIC, DIRECT\n0.25, 1.\n{}*END STEP\n"
    coarse = block("C3D8", (2, 2, 2), LOW, HIGH, shake=0.2)
    assert_equal_on_ranks(tmp_path / "global", homogeneous_global(coarse, steps), TOLERANCE)
    fine = block(kind, (3, 3, 3), LOW + 0.5, HIGH - 0.4, shake=0.2)
    driven = steps.replace("{}", "*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n")
    assert_equal_on_ranks(tmp_path / "submodel", submodel(fine, CARD.format("../../global/ranks2/job.vtkhdf"), driven), TOLERANCE)


def test_submodel_of_the_calculix_dialect(tmp_path: Path) -> None:
    """The region around a hole, driven from .frd."""
    assert run(tmp_path, plate_global(), 0, DIALECT).code == 0
    (tmp_path / "job.frd").rename(tmp_path / "global.frd")
    assert_equal_on_ranks(tmp_path / "submodel", plate_submodel(CARD.format("../../global.frd")), TOLERANCE, DIALECT)


def strip(kind: str) -> Shell:
    """A cantilever of 8 x 4 cells."""
    return shell(kind, (8, 4), lambda u, v: (10 * u, 4 * v, 0 * u))


def end_forces(body: Shell) -> str:
    """Forces across the strip and along its side."""
    return f"*CLOAD\n{body.at(1.0, 0.5) + 1}, 3, 1.\n{body.at(1.0, 0.0) + 1}, 2, 5.\n"


@pytest.mark.parametrize("nodal", ["", ", NODAL THICKNESS"])
@pytest.mark.parametrize(("kind", "dialect"), [("S4", "abaqus"), ("S8R", "abaqus"), ("S6", "calculix"), ("S8R", "calculix")])
def test_composite_shells(tmp_path: Path, kind: str, dialect: str, nodal: str) -> None:
    """Layers as solids of their own, or one solid through all; of even thickness and tapered."""
    body = strip(kind)
    deck = body.cards() + LAYERS.format(nodal)
    if nodal:
        deck += "*NODAL THICKNESS\n" + "".join(f"{i + 1}, {0.4 * (1 - 0.5 * u):.15g}\n" for i, (u, _) in enumerate(body.uv))
    deck += held(body.where(0, 0.0), "1, 6") + "*STEP\n*STATIC\n" + end_forces(body) + "*END STEP\n"
    assert_equal_on_ranks(tmp_path, deck, THIN, f"--dialect={dialect}")


@pytest.mark.parametrize("card", ["NSET", "TIE NSET"])
@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
def test_rigid_body_of_shells(tmp_path: Path, dialect: str, card: str) -> None:
    """A rigid end, loaded at its reference node. Under NLGEOM the path of Newton's method, not the result, follows the rounding of redundant
    constraints, in the serial program, too."""
    body = strip("S4")
    patch = "".join(f"{i + 1},\n" for i in range(len(body.nodes)) if body.uv[i, 0] > 0.74)
    deck = body.cards() + section(2.1e5, 0.3, 0.4) + f"*NODE\n9001, 11., 2., 0.\n*NSET, NSET=R\n{patch}*RIGID BODY, {card}=R, REF NODE=9001\n"
    deck += held(body.where(0, 0.0), "1, 6") + "*STEP\n*STATIC\n*CLOAD\n9001, 3, 20.\n9001, 4, 30.\n*END STEP\n"
    assert_equal_on_ranks(tmp_path, deck, THIN, f"--dialect={dialect}")


@pytest.mark.parametrize("kind", ["B31", "B32"])
def test_beams(tmp_path: Path, kind: str) -> None:
    """A cantilever under a force and a moment, NLGEOM."""
    deck = beam_of_elements(kind, rectangle(0.4, 0.6)) + "*BOUNDARY\n1, 1, 6\n" + FINITE + "*CLOAD\nEND, 2, 2.\nEND, 4, 1.\n*END STEP\n"
    assert_equal_on_ranks(tmp_path, deck, THIN)
