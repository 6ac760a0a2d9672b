"""The same answer however the model is written: turned, renumbered, shuffled, in other units, with two threads, run twice.

The model is a block pressed on a larger one and dragged over it until part of it slips, with friction and NLGEOM: small,
but with stick, slip and opening. Iterations may differ by one per step because they differ in the last digits.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Job
from verify.conftest import Run
from verify.decks.make_decks import Mesh, block, join, material_cards
from verify.independent.results import Floats

FIELDS = ["U", "S", "CPRESS", "CNORMF", "CSHEARF"]
YOUNG, NU, MU, PRESS, DRAG = 210000.0, 0.3, 0.3, 0.002, 0.0009
#: A card of the tight controls: the equations are solved so far that what is left is below what is compared.
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"


@dataclass
class Saying:
    """How the model is written."""

    turn: Floats | None = None  #: a rotation of all coordinates and displacements
    order: Floats | None = None  #: place k of the deck holds node order[k]
    shuffle: int = 0  #: seed of the order of cards; 0: as they are
    length: float = 1.0  #: one unit of length of the model in the deck's
    force: float = 1.0


def mesh() -> Mesh:
    """The two blocks."""
    upper = block(np.linspace(-0.5, 0.5, 5), np.linspace(-0.45, 0.55, 5), np.linspace(0, 0.5, 3), "UPPER")
    lower = block(np.linspace(-1, 1, 6), np.linspace(-1, 1, 6), np.linspace(-0.8, 0, 4), "LOWER")
    return join([upper, lower])


def deck(say: Saying) -> str:
    """The deck. Displacements are prescribed as vectors, so that a turned model is the same model."""
    model = mesh()
    n = len(model.nodes)
    order = np.arange(n) if say.order is None else say.order
    label = np.empty(n, dtype=int)
    label[order] = np.arange(1, n + 1)
    turn = np.eye(3) if say.turn is None else say.turn
    places = model.nodes @ turn.T * say.length
    blocks = ["*NODE\n" + "".join(f"{label[i]}, " + ", ".join(f"{v:.17g}" for v in places[i]) + "\n" for i in order)]
    elements = [f"{e}, " + ", ".join(str(label[i]) for i in nodes) + "\n" for e, nodes in enumerate(model.elements, 1)]
    blocks.append("*ELEMENT, TYPE=C3D8\n" + "".join(elements))
    for name, members in model.element_sets.items():
        blocks.append(f"*ELSET, ELSET={name}\n" + "".join(f"{m + 1}\n" for m in members))
    for name, entries in model.surfaces.items():
        blocks.append(f"*SURFACE, NAME={name}\n" + "".join(f"{elset}, S{face}\n" for elset, face in entries))
    young = YOUNG * say.force / say.length**2
    blocks += [material_cards(f"M{part}", (young, NU), part).replace(f"{young:g}", f"{young:.17g}") for part in ("UPPER", "LOWER")]
    blocks.append(
        f"*SURFACE INTERACTION, NAME=RUBBING\n*FRICTION\n{MU}\n*CONTACT PAIR, INTERACTION=RUBBING\nUPPER_BOTTOM, LOWER_TOP\n"
    )
    if say.shuffle:
        random.Random(say.shuffle).shuffle(blocks)
    top, bottom = model.node_sets["UPPER_TOP"], model.node_sets["LOWER_BOTTOM"]
    still = held(label, bottom, np.zeros(3))
    first = still + held(label, top, turn @ [0, 0, -PRESS] * say.length)
    second = held(label, top, turn @ [DRAG, 0.4 * DRAG, -PRESS] * say.length)
    return "".join(blocks) + step(first) + step(second)


def held(label: Floats, members: Floats, u: Floats) -> str:
    """Rows of *BOUNDARY."""
    return "".join(f"{label[i]}, {d}, {d}, {v:.17g}\n" for i in members for d, v in enumerate(u, 1))


def step(rows: str) -> str:
    """Five increments."""
    return f"*STEP, NLGEOM\n*STATIC, DIRECT\n0.2, 1.\n{TIGHT}*BOUNDARY\n{rows}*END STEP\n"


def solve(run: Run, folder: Path, say: Saying, name: str = "job", threads: int = 1) -> Job:
    """A job that has to finish."""
    folder = folder / name
    folder.mkdir()
    (folder / "job.inp").write_text(deck(say))
    done = run(["--quiet", "--threads", threads, "job"], cwd=folder, threads=threads)
    assert done.returncode == 0, done.stdout + done.stderr
    return Job(folder / "job.vtkhdf", name)


@pytest.fixture(scope="module")
def plain(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Job:
    """The model as it is."""
    job = solve(run, tmp_path_factory.mktemp("plain"), Saying())
    status = job.last("CSTATUS")
    assert (status == 1).sum() >= 3 and (status == 2).sum() >= 3, "the model has to stick and to slip"
    return job


def same(job: Job, plain: Job, tolerance: float, order: Floats | None = None, say: Saying | None = None) -> None:
    """Fields of all frames after going back to the plain model's numbering, axes and units, and the iterations per step."""
    say = say or Saying()
    turn = np.eye(3) if say.turn is None else say.turn
    back = np.arange(len(plain.points)) if order is None else np.argsort(order)
    units = {"U": say.length, "CNORMF": say.force, "CSHEARF": say.force}
    for name in FIELDS:
        found = job.field(name)[:, back] / units.get(name, say.force / say.length**2)
        if name == "S":
            found = stress_back(found, turn)
        elif found.shape[-1] == 3:
            found = found @ turn
        expected = plain.field(name)
        worst = np.abs(found - expected).max() / np.abs(expected).max()
        assert worst <= tolerance, f"{name} differs by {worst:.1e} of its largest value, allowed {tolerance:.0e}"
    for number in (1, 2):
        counts = [int(j.history["n_iterations"][j.history["step"] == number].sum()) for j in (job, plain)]
        assert abs(counts[0] - counts[1]) <= 1, f"iterations of step {number}: {counts[0]}, of the plain model {counts[1]}"


def stress_back(stress: Floats, turn: Floats) -> Floats:
    """xx yy zz xy yz xz in the plain model's axes."""
    places = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]
    full = np.empty((*stress.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(places):
        full[..., i, j] = full[..., j, i] = stress[..., k]
    full = turn.T @ full @ turn
    return np.stack([full[..., i, j] for i, j in places], axis=-1)


def test_turned(run: Run, tmp_path: Path, plain: Job) -> None:
    """Rotated by 35 degrees about a skew axis."""
    axis = np.array([2.0, -1.0, 2.0]) / 3
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle = np.radians(35)
    say = Saying(turn=np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
    same(solve(run, tmp_path, say), plain, 1e-8, say=say)


def test_renumbered(run: Run, tmp_path: Path, plain: Job) -> None:
    """Nodes in a random order with other labels."""
    say = Saying(order=np.random.default_rng(5).permutation(len(plain.points)))
    same(solve(run, tmp_path, say), plain, 1e-8, order=say.order)


@pytest.mark.parametrize("seed", [1, 2])
def test_shuffled_cards(run: Run, tmp_path: Path, plain: Job, seed: int) -> None:
    """The cards of the model in another order: nodes, elements, sets, surfaces, materials, contact."""
    same(solve(run, tmp_path, Saying(shuffle=seed)), plain, 1e-8)


@pytest.mark.parametrize(
    ("length", "force"), [(1e-3, 1.0), (1e-3, 1e-3), (1 / 25.4, 0.22480894387096)], ids=["SI", "m-kN", "inch-pound"]
)
def test_units(run: Run, tmp_path: Path, plain: Job, length: float, force: float) -> None:
    """N and mm as N and m, kN and m, pound and inch."""
    say = Saying(length=length, force=force)
    same(solve(run, tmp_path, say), plain, 1e-8, say=say)


def test_two_threads(run: Run, tmp_path: Path, plain: Job) -> None:
    """Two threads: 1e-10."""
    same(solve(run, tmp_path, Saying(), threads=2), plain, 1e-10)


def test_twice(run: Run, tmp_path: Path, plain: Job) -> None:
    """The same run again: bitwise."""
    again = solve(run, tmp_path, Saying())
    for name in FIELDS:
        assert again.field(name).tobytes() == plain.field(name).tobytes(), f"{name} is not the same bit by bit"
