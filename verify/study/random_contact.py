"""Contact at random: a body of any shape and element kind is pressed on a table, dragged along it and lifted, with all controls as they are.

    python -m verify.study.random_contact --seeds 1 100      a row for each job that failed or cut back, and the sums
    python -m verify.study.random_contact --deck 17          the deck of one seed
    python -m verify.study.random_contact --peer ccx         CalculiX runs the same decks, but those with a rigid head
    python -m verify.study.random_contact --laws             the surfaces give by a law; a table by law as well
    python -m verify.study.random_contact --laws --peer ccx  CalculiX runs those in its dialect

Shapes, meshes, element kinds, stiffness, friction, formulation, load and increments are drawn from the seed. The head of the body is moved
along, so that each of these jobs has an equilibrium: one that fails is a fault of the program.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from random import Random

import numpy as np

from verify.decks.make_decks import Floats, block, contact_cards, material_cards
from verify.decks.planes import grid_rows, has_shape, number_mid_sides
from verify.decks.solids import as_kind
from verify.readers.sta_cvg_files import read_sta
from verify.study.random_laws import MAX_TIED, Law, draw_law

ROOT = Path(__file__).resolve().parents[2]


SOLIDS = ["C3D4", "C3D8", "C3D8I", "C3D10", "C3D20R"]
PLANES = ["CPE3", "CPE4", "CPE4R", "CPE6", "CPE8R"]
YOUNG = 1.0e4  #: of the table [stress]
HEAD = 900001  #: reference node of a head that is pressed by a force
PRINTED = "*NODE PRINT, NSET=BODY_LOW, FREQUENCY=1000\nU\n*NODE PRINT, NSET=TABLE_LOW, FREQUENCY=1000, TOTALS=ONLY\nRF\n"  #: with a law
PEER_LIMIT = 60.0  #: seconds for a job of CalculiX
Place = Callable[[float, float, float], tuple[float, float, float]]


@dataclass
class Part:
    """A body made of the unit cube or square; indices from 0."""

    kind: str
    nodes: Floats  #: (n, 3); y is the height
    elements: list[list[int]]
    ends: list[list[int]]  #: nodes of the lower and of the upper side
    faces: list[list[tuple[int, int]]]  #: (element, face from 1) there


def part(kind: str, cells: tuple[int, int, int], place: Place) -> Part:
    """A grid of cells in the unit cube, cut into elements of a kind and put in its place."""
    lines = [np.linspace(0.0, 1.0, n + 1) for n in cells]
    if kind.startswith("C3D"):
        solids = as_kind(block(*lines, name="GRID"), kind)
        unit, elements = solids.nodes, solids.elements.tolist()
        ends = [solids.where(1, y).tolist() for y in (0.0, 1.0)]
        faces = [solids.outer_faces(end) for end in ends]
    else:
        corners = [[x, y, 0.0] for y in lines[1] for x in lines[0]]
        elements, middles = number_mid_sides(grid_rows(cells[0] + 1, cells[1] + 1, kind), len(corners), kind)
        unit = np.array(corners + [np.mean([corners[a], corners[b]], axis=0).tolist() for a, b in middles])
        ends = [np.flatnonzero(np.abs(unit[:, 1] - y) < 1e-9).tolist() for y in (0.0, 1.0)]
        n = 3 if has_shape(kind, "36") else 4
        faces = [[(e, f) for e, row in enumerate(elements) for f in range(1, n + 1) if {row[f - 1], row[f % n]} <= set(end)] for end in ends]
    return Part(kind, np.array([place(*at) for at in unit]), elements, ends, faces)


def part_cards(body: Part, name: str, offset: int) -> str:
    """Nodes, elements, node sets NAME_LOW and NAME_HIGH and their surfaces; labels follow the offset."""
    lines = ["*NODE", *(f"{offset + i}, " + ", ".join(f"{v:.12g}" for v in x) for i, x in enumerate(body.nodes, start=1))]
    lines.append(f"*ELEMENT, TYPE={body.kind}, ELSET={name}")
    for i, row in enumerate(body.elements, start=1):
        labels = [str(offset + i), *(str(offset + n + 1) for n in row)]
        lines.append(", ".join(labels[:11]) + (",\n" + ", ".join(labels[11:]) if len(labels) > 11 else ""))
    for end, nodes, faces in zip(("LOW", "HIGH"), body.ends, body.faces, strict=True):
        lines += [f"*NSET, NSET={name}_{end}", *(f"{offset + n + 1}" for n in nodes)]
        lines += [f"*SURFACE, NAME={name}_{end}", *(f"{offset + e + 1}, S{f}" for e, f in faces)]
    return "\n".join(lines) + "\n"


def body_place(draw: Random, is_space: bool) -> tuple[str, Place]:
    """The shape of the body that is pressed: its name, and where it is at the start."""
    shape, height, gap = draw.choice(["box", "round", "wedge", "tilted"]), draw.choice([0.5, 1.0]), draw.choice([0.0, 0.0, 0.02])
    below = {
        "box": lambda s: 0.0,
        "round": lambda s: 1.2 - math.sqrt(1.2**2 - (s - 0.5) ** 2),
        "wedge": lambda s: 0.15 * abs(2 * s - 1),
        "tilted": lambda s: 0.05 * s,
    }[shape]
    return shape, lambda s, t, w: (0.5 + s, gap + below(s) * (1 - t) + height * t, 0.1 + 0.4 * w if is_space else 0.0)


def force_cards(head: list[int], has_law: bool) -> tuple[str, str]:
    """What makes the head one for a force, and the node that takes it: a rigid body; with a law equations, which CalculiX takes for plane heads too."""
    if not has_law:
        return f"*NODE\n{HEAD}, 1., 2., 0.3\n*RIGID BODY, NSET=BODY_HIGH, REF NODE={HEAD}\n", str(HEAD)
    first, *others = (n + 1 for n in head)
    return "".join(f"*EQUATION\n2\n{n}, 2, 1., {first}, 2, -1.\n" for n in others), str(first)


def eased(law: Law, kind: str, shape: str, place: Place) -> tuple[str, str, Place]:
    """What a law cannot do without, so that an equilibrium exists: element kind, shape and place of the body.

    Tied surfaces lie on each other: those of CalculiX are drawn together over a gap. In its dialect C3D8R have no stiffness to speak of against hourglasses
    where one row of nodes is pressed; and each face has a normal of its own, so that no node may stand on the line between two of them.
    """
    if law.behavior == "TIED":
        height = place(0.0, 1.0, 0.0)[1]
        return kind, "box", lambda s, t, w: (place(s, t, w)[0], height * t, place(s, t, w)[2])
    if law.dialect == "calculix" and law.kind.startswith("NODE"):
        return kind.replace("C3D8R", "C3D8I"), shape, lambda s, t, w: (place(s, t, w)[0] + 0.037, *place(s, t, w)[1:])
    return kind, shape, place


def random_deck(seed: int, has_law: bool = False) -> str:
    """The deck of a seed; its first line lists the drawn parameters. With a contact law the surfaces are compliant, and the quantities compared with CalculiX are printed."""
    draw = Random(seed)
    is_space = draw.random() < 0.5
    kinds = (SOLIDS + ["C3D8R"] * has_law) if is_space else PLANES
    depth = (draw.choice([1, 2]), draw.choice([1, 2, 3])) if is_space else (0, 0)
    shape, place = body_place(draw, is_space)
    kind, cells = draw.choice(kinds), (draw.choice([3, 4, 6]), draw.choice([2, 3]), depth[0])
    table_kind, table_cells = draw.choice(kinds), (draw.choice([6, 8, 11]), draw.choice([2, 3]), depth[1])
    young, poisson, mu = draw.choice([1e3, 1e4, 2e5]), draw.choice([0.0, 0.3, 0.4]), draw.choice([0.0, 0.1, 0.3, 0.6, 1.0])
    form = draw.choice(["NODE TO SURFACE", "SURFACE TO SURFACE"])
    is_force, depth_pressed, drag = draw.random() < 0.3, draw.choice([0.002, 0.02, 0.06]), draw.choice([0.0, 0.05, 0.3, 0.8])
    n_increments, is_finite, is_lifted = draw.choice([1, 5, 10]), draw.random() < 0.8, draw.random() < 0.3
    pair = ("BODY_LOW", "TABLE_HIGH")
    if form.startswith("SURFACE") and draw.random() < 0.4:
        pair = pair[::-1]  # by nodes the smaller body would lie between the nodes of the table
    law = draw_law(Random(f"law {seed}"), min(young, YOUNG), 1.0 / cells[0], mu, form) if has_law else None
    if law:
        kind, shape, place = eased(law, kind, shape, place)
        drag, is_lifted = (min(drag, MAX_TIED), False) if law.behavior == "TIED" else (drag, is_lifted)
    body = part(kind, cells, place)
    table = part(table_kind, table_cells, lambda s, t, w: (3.0 * s, t - 1.0, 0.6 * w if is_space else 0.0))
    head_cards, loaded = force_cards(body.ends[1], has_law) if is_force else ("", "")
    head = loaded if is_force and not law else "BODY_HIGH"
    start = f"*STEP, INC=200{', NLGEOM' if is_finite else ''}\n*STATIC\n{1 / n_increments:.6g}, 1., 1e-4, {1 / n_increments:.6g}\n"
    steps = [f"*BOUNDARY\nTABLE_LOW, 1, 3\n{head}, 1, 1\n{head}, 3, {6 if is_force and not law else 3}\n"]
    force = 0.5 * depth_pressed * min(young, YOUNG) * (0.4 if is_space else 1.0)
    steps[0] += f"*CLOAD\n{loaded}, 2, {-force:.9g}\n" if is_force else f"{head}, 2, 2, {-depth_pressed - 0.02:.9g}\n"
    if drag > 0.0:
        across = f"{head}, 3, 3, {min(0.3 * drag, 0.05):.9g}\n" if is_space else ""
        steps += [f"*BOUNDARY\n{head}, 1, 1, {drag}\n{across}", f"*BOUNDARY\n{head}, 1, 1, {-0.2 * drag:.9g}\n"]
    if is_lifted and not is_force:
        steps.append(f"*BOUNDARY\n{head}, 2, 2, 0.1\n")
    thickness = "" if is_space else "1.\n"
    description = f"{body.kind} {shape} on {table.kind}, {law.kind.lower() if law else form.lower()}, slave {pair[0]}, E {young:g}, nu {poisson}, mu {mu}, " + (
        f"{'force' if is_force else 'displacement'}, pressed {depth_pressed}, dragged {drag}, {n_increments} increments a step"
        f"{', lifted' if is_lifted else ''}{'' if is_finite else ', small displacements'}{f', {law.dialect}, law {law.description}' if law else ''}"
    )
    materials = material_cards("BODY", (young, poisson), "BODY") + thickness + material_cards("TABLE", (YOUNG, 0.3), "TABLE") + thickness
    return (
        f"** seed {seed}: {description}\n{f'** dialect: {law.dialect}' + chr(10) if law else ''}"
        f"{part_cards(body, 'BODY', 0)}{part_cards(table, 'TABLE', 100000)}{head_cards}{materials}"
        + (law.cards(*pair) if law else contact_cards(*pair, mu, form))
        + "".join(f"{start}{step}{PRINTED if law else ''}*END STEP\n" for step in steps)
    )


@dataclass
class Outcome:
    """What a job did."""

    seed: int
    description: str
    code: int
    increments: int
    failed: int
    iterations: int
    seconds: float

    @property
    def law(self) -> str:
        """The kind and the stiffness of its law."""
        return self.description.split(", law ")[1] if ", law " in self.description else "HARD"


def run(seed: int, program: Path, folder: Path, limit: float = 600.0, has_law: bool = False) -> Outcome:
    """Runs the deck of a seed in a folder of its own."""
    words = [str(program), "--quiet", "--no-checkpoint", "job"]
    return outcome_of(seed, random_deck(seed, has_law), words, folder, limit, lambda done: done.returncode)


def run_peer(seed: int, peer: str, folder: Path, has_law: bool = False) -> Outcome:
    """The same by CalculiX, which says at its end whether it finished."""
    return outcome_of(seed, random_deck(seed, has_law), [peer, "-i", "job"], folder, PEER_LIMIT, lambda done: int("Job finished" not in done.stdout))


def is_for_peer(text: str, has_law: bool) -> bool:
    """Whether CalculiX takes a deck as it is meant: hard contact without a rigid head, laws of its dialect."""
    return "** dialect: calculix" in text if has_law else "RIGID BODY" not in text


def outcome_of(seed: int, text: str, words: list[str], folder: Path, limit: float, code_of: Callable[[subprocess.CompletedProcess], int]) -> Outcome:
    """What a program makes of a deck; a job that takes longer than the limit counts as one that does not finish."""
    here = folder / f"{seed}"
    here.mkdir(parents=True)
    (here / "job.inp").write_text(text)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    began = time.monotonic()
    try:
        code = code_of(subprocess.run(words, cwd=here, env=environment, capture_output=True, text=True, timeout=limit, check=False))
    except subprocess.TimeoutExpired:
        code = 1
    seconds = time.monotonic() - began
    attempts = read_sta(here / "job.sta")
    failed = sum(attempt.is_failed for attempt in attempts)
    iterations = sum(attempt.iterations for attempt in attempts)
    return Outcome(seed, text.splitlines()[0][3:], code, len(attempts) - failed, failed, iterations, seconds)


def sums(outcomes: list[Outcome]) -> str:
    """Jobs, increments and iterations in a sentence."""
    made, ended = sum(o.increments for o in outcomes), sum(o.code == 0 for o in outcomes)
    iterations = sum(o.iterations for o in outcomes)
    return (f"{len(outcomes)} jobs, {ended} finish, {sum(o.failed == 0 and o.code == 0 for o in outcomes)} without a failed attempt; "
            f"{made} increments, {sum(o.failed for o in outcomes)} failed attempts, {iterations} iterations, {iterations / max(made, 1):.2f} per increment")  # fmt: skip


def main() -> int:
    """Counts a range of seeds, or prints one deck."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs=2, default=(1, 100), metavar=("FIRST", "LAST"))
    parser.add_argument("--deck", type=int, metavar="SEED")
    parser.add_argument("--laws", action="store_true", help="surfaces that give by a law in place of hard contact")
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--peer", help="a program of CalculiX in place of ours, 60 s for each job")
    parser.add_argument("--jobs", type=int, default=1, help="at a time")
    parser.add_argument("--folder", type=Path, help="a new folder that keeps decks and results, and runs.csv")
    arguments = parser.parse_args()
    if arguments.deck is not None:
        print(random_deck(arguments.deck, arguments.laws), end="")
        return 0
    seeds = list(range(arguments.seeds[0], arguments.seeds[1] + 1))
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(arguments.jobs) as pool:
        folder = arguments.folder or Path(scratch)
        if arguments.peer:
            seeds = [seed for seed in seeds if is_for_peer(random_deck(seed, arguments.laws), arguments.laws)]
            outcomes = list(pool.map(lambda seed: run_peer(seed, arguments.peer, folder, arguments.laws), seeds))
        else:
            outcomes = list(pool.map(lambda seed: run(seed, arguments.program.resolve(), folder, has_law=arguments.laws), seeds))
    if arguments.folder:
        with (folder / "runs.csv").open("w", newline="") as file:
            csv.writer(file).writerows([[f.name for f in fields(Outcome)], *(astuple(o) for o in outcomes)])
    for o in outcomes:
        if o.code != 0 or o.failed > 0:
            print(f"{o.description}: exit {o.code}, {o.increments} increments, {o.failed} failed attempts, {o.iterations} iterations")
    if arguments.laws:
        for law in sorted({o.law for o in outcomes}, key=lambda law: (law.split()[0], *map(float, law.split()[1:]))):
            print(f"{law}: {sums([o for o in outcomes if o.law == law])}")
    print(sums(outcomes))
    return int(any(o.code != 0 for o in outcomes))


if __name__ == "__main__":
    sys.exit(main())
