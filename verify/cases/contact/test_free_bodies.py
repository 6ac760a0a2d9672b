"""Bodies without support at the start: a proximal shift moves them into contact, and no regularization force remains at the end.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks.make_decks import Mesh, block
from verify.decks.planes import flat_deck, flatten, join_planes
from verify.decks.sheets import Floats, between, fix, pair, sheet, solid_deck, step

Proof = Callable[..., Case]
STEEL, SOFT = (210000.0, 0.3), (2000.0, 0.3)
DENSITY, GRAVITY = 1e-3, 9810.0


def heavy(deck: str) -> str:
    """BODY gets a density."""
    return deck.replace("*SOLID SECTION, ELSET=BODY", f"*DENSITY\n{DENSITY}\n*SOLID SECTION, ELSET=BODY", 1)


def gravity(is_plane: bool) -> str:
    """The weight of BODY."""
    return f"*DLOAD\nBODY, GRAV, {GRAVITY}, " + ("0., -1.\n" if is_plane else "0., 0., -1.\n")


def plane(parts: list[tuple[Mesh, tuple[float, float]]], cards: str) -> str:
    """CPE4 of thickness 1."""
    return heavy(flat_deck([(flatten(part), elastic) for part, elastic in parts], "CPE4", cards))


def regularization_work(path: Path) -> Floats:
    """history/proximal_work of the increments that converged."""
    with h5py.File(path) as file:
        history = file["AMONTONS/history"]
        return np.asarray(history["proximal_work"])[np.asarray(history["is_converged"]) == 1]


@pytest.mark.parametrize("gap", [0.01, 0.9])
@pytest.mark.parametrize("dimension", [2, 3])
def test_fall(proof: Proof, dimension: int, gap: float) -> None:
    """A block falls on a table, then the table draws it along."""
    case = proof(
        f"fall-{dimension}d-{gap:g}".replace(".", ""),
        title=f"A block without supports falls {gap:g} on a table and is drawn along, {dimension}D",
        model=f"A block of edge 1 (E = 210000, nu = 0.3, density 0.001) hangs {gap:g} above a table without any support; gravity 9810 in one "
        "increment, then the table moves sideways by 0.5 (5 increments); mu = 0.3, NLGEOM.",
        formula="At the end of the fall the table supports the weight of the block; then it goes with the table, without "
        "friction. Work of what nothing balanced: between half the weight (it grows with the load) and all of it, times the fall.",
        source="statics",
        proves="Unilateral contact from a start without support; no regularization force remains.",
    )
    weight = DENSITY * GRAVITY
    if dimension == 2:
        body, table = sheet("BODY", between(0, 1, 4), between(gap, 1 + gap, 4)), sheet("TABLE", between(-1, 2, 9), between(-1, 0, 3))
        hold = fix("TABLE_BOTTOM, 1, 2")
    else:
        body = block(between(0, 1, 3), between(0, 1, 3), between(gap, 1 + gap, 3), "BODY")
        table = block(between(-1, 2, 5), between(-1, 2, 5), between(-1, 0, 2), "TABLE")
        hold = fix("TABLE_BOTTOM, 1, 3")
    parts, up = [(body, STEEL), (table, STEEL)], dimension - 1
    cards = pair("BODY_BOTTOM", "TABLE_TOP", 0.3)
    steps = step(hold + gravity(dimension == 2), 1, True) + step(fix("TABLE_BOTTOM, 1, 1, 0.5"), 5, True)
    deck = plane(parts, cards + steps) if dimension == 2 else heavy(solid_deck(parts, cards, steps))
    job = case.run(deck, requested=6)
    landed = job.frame(1.0)
    force = (job.field("CNORMF") + job.field("CSHEARF")).sum(axis=1)
    n_body = len(flatten(body).nodes) if dimension == 2 else len(body.nodes)
    fall = job.field("U")[landed, :n_body, up]
    case.near("weight on the table", force[landed, up], weight, 1e-6, why="equilibrium", time="1", place="foot of the table")
    case.near("the block's fall", fall.mean(), -gap, 0.01, why="and both deform by about W/E = 5e-5", time="1", place="all nodes of the block")
    work = regularization_work(job.path)
    case.within("regularization work over W times the gap", work[0] / (weight * gap), (0.5, -fall.min() / gap), why="between the ramp and the whole load; the last digits are the deformation below the block", time="1",
                place="whole model")  # fmt: skip
    case.near("regularization work afterwards", work[-1], work[0], 1e-9, why="no regularization acts any more", time="2", place="whole model")
    case.near("weight on the table", force[-1, up], weight, 1e-6, why="equilibrium", time="2", place="foot of the table")
    case.near("the block goes with the table", job.last("U")[:n_body, 0].mean() / 0.5, 1.0, 1e-4, why="it sticks", time="2",
              place="all nodes of the block")  # fmt: skip
    case.done()


def test_disc_between_plates(proof: Proof) -> None:
    """A disc between two plates, one pressed by forces."""
    case = proof(
        "disc-between-plates",
        title="A disc without supports between two plates, pressed by forces",
        model="A disc of diameter 2 lies 0.01 above a fixed plate and 0.02 below another, which only a guide along x supports; the upper one is "
        "pressed down by 50 at each node of its top (5 increments). E = 210000, plane strain, mu = 0.3, NLGEOM.",
        formula="Both contacts transmit the force, and the disc does not turn.",
        source="statics",
        proves="Two bodies that only contact supports, one through the other.",
    )

    def round_place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        u, v = 2 * s - 1, 2 * t - 1
        return u * np.sqrt(1 - v * v / 2), v * np.sqrt(1 - u * u / 2) + 1.01

    disc = sheet("DISC", between(0, 1, 12), between(0, 1, 12), round_place)
    low, up = sheet("LOW", between(-2, 2, 20), between(-1, 0, 4)), sheet("UP", between(-2, 2, 20), between(2.03, 3, 4))
    cards = pair("DISC_BOTTOM", "LOW_TOP", 0.3) + pair("DISC_TOP", "UP_BOTTOM", 0.3)
    cards += step(fix("LOW_BOTTOM, 1, 2", "UP_TOP, 1") + "*CLOAD\nUP_TOP, 2, -50.\n", 5, True)
    job = case.run(plane([(disc, STEEL), (low, STEEL), (up, STEEL)], cards), requested=5)
    plane_disc = flatten(disc)
    force = (job.last("CNORMF") + job.last("CSHEARF"))[:, 1]
    total = 50.0 * 21
    case.near("below", force[plane_disc.node_sets["DISC_BOTTOM"]].sum(), total, 1e-5, why="equilibrium", place="bottom of the disc", time="the end")
    case.near("above", force[plane_disc.node_sets["DISC_TOP"]].sum(), -total, 1e-5, why="equilibrium", place="top of the disc", time="the end")
    sideways = job.last("U")[plane_disc.node_sets["DISC_BOTTOM"], 0].mean()
    case.near("it stays in the middle", sideways, 0.0, 1e-3, why="symmetry; nothing but rounding chooses a side before it touches", scale=1.0,
              place="all nodes of the disc", time="the end")  # fmt: skip
    case.done()


def test_pushed_to_a_wall(proof: Proof) -> None:
    """A block on a floor is pushed by a force, beyond the friction limit, to a wall."""
    case = proof(
        "pushed-to-a-wall",
        title="A heavy block pushed over a floor to a wall",
        model="A block of edge 1 (E = 2000, density 0.001) lies on a floor, 0.1 from a wall, and is pushed towards it by 5 at each of the 5 nodes of "
        "its side, in 4 increments; gravity 9810; mu = 0.2 at both, plane strain, NLGEOM.",
        formula="The floor and the wall take the weight and the push, and friction reverses neither.",
        source="statics",
        proves="A body that slides without support until another master stops it.",
    )
    body, floor = sheet("BODY", between(0.1, 1.1, 4), between(0, 1, 4)), sheet("FLOOR", between(-1, 3, 15), between(-1, 0, 3))
    wall = sheet("WALL", between(-1, 0, 3), between(0, 3, 11))
    cards = pair("BODY_BOTTOM", "FLOOR_TOP", 0.2) + pair("BODY_LEFT", "WALL_RIGHT", 0.2)
    loads = fix("FLOOR_BOTTOM, 1, 2", "WALL_LEFT, 1, 2") + gravity(True) + "*CLOAD\nBODY_RIGHT, 1, -5.\n"
    job = case.run(plane([(body, SOFT), (floor, STEEL), (wall, STEEL)], cards + step(loads, 4, True)), requested=4)
    whole = join_planes([flatten(part) for part in (body, floor, wall)])
    held = np.concatenate([whole.node_sets["FLOOR_BOTTOM"], whole.node_sets["WALL_LEFT"]])
    case.near("reactions", job.last("RF")[held].sum(axis=0)[:2], np.array([25.0, DENSITY * GRAVITY]), 1e-5, why="equilibrium",
              place="floor and wall", time="the end")  # fmt: skip
    pressed = job.last("U")[flatten(body).node_sets["BODY_LEFT"], 0]
    case.near("displacement to the wall", pressed.mean(), -0.1, 0.02, why="and the wall deforms by 25/E", place="side at the wall", time="the end")
    case.done()


@pytest.mark.slow
def test_slides_away(run: Run, tmp_path: Path) -> None:
    """The same without a wall: exit code 5 and FREE BODY, not a place where it happens to stop.

    The report has a bounded cost: each iteration takes no more than a factorisation of the stiffness as it is and of three parts with proximal shifts.
    """
    body, floor = sheet("BODY", between(0, 1, 4), between(0, 1, 4)), sheet("FLOOR", between(-1, 3, 15), between(-1, 0, 3))
    loads = fix("FLOOR_BOTTOM, 1, 2") + gravity(True) + "*CLOAD\nBODY_RIGHT, 1, 5.\n"
    (tmp_path / "job.inp").write_text(plane([(body, SOFT), (floor, STEEL)], pair("BODY_BOTTOM", "FLOOR_TOP", 0.2) + step(loads, 4, True)))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 5, done.stdout + done.stderr
    assert "FREE BODY" in done.stdout, done.stdout
    assert "hold the body by supports" in done.stdout
    n_iterations, n_factorisations = (int(re.search(rf"{what} +(\d+)", done.stdout)[1]) for what in ("Newton iterations", "factorisations"))
    assert n_factorisations <= 4 * n_iterations, f"{n_factorisations} factorisations in {n_iterations} iterations"


def pole(mu: float, displacements: tuple[float, ...]) -> str:
    """A node on a table, pressed by an inclined bar and pulled by a level one; small displacements, each of them in one increment."""
    c, s = np.cos(LEAN), np.sin(LEAN)
    table = [(x, y, z) for z in (-1, 0) for x, y in ((-2, -2), (6, -2), (6, 2), (-2, 2))]
    points = [(0, 0, 0), (-10 * c, 0, 10 * s), (10, 0, 0), *table]
    deck = "*NODE\n" + "".join(f"{i}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(points, start=1))
    deck += "*ELEMENT, TYPE=T3D2, ELSET=LEANING\n1, 2, 1\n*ELEMENT, TYPE=T3D2, ELSET=LEVEL\n2, 1, 3\n*ELEMENT, TYPE=C3D8, ELSET=TABLE\n"
    deck += "3, " + ", ".join(str(i) for i in range(4, 12)) + "\n*NSET, NSET=TIP\n1\n*NSET, NSET=FIXED, GENERATE\n4, 11\n"
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=TABLE, MATERIAL=M\n"
    for name, stiffness in (("LEANING", STIFF), ("LEVEL", WEAK)):
        deck += f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n{stiffness / 100:.15g}\n"
    deck += "*SURFACE, NAME=TIP_S, TYPE=NODE\nTIP,\n*SURFACE, NAME=TOP\nTABLE, S2\n"
    deck += pair("TIP_S", "TOP", mu, ", SMALL SLIDING")
    press = fix("FIXED, 1, 3", "1, 2", "3, 1, 3", "2, 2", f"2, 1, 1, {PRESS * c:.15g}", f"2, 3, 3, {-PRESS * s:.15g}")
    static = "*STEP\n*STATIC, DIRECT\n1., 1.\n"
    return deck + static + press + "*END STEP\n" + "".join(f"{static}{fix(f'3, 1, 1, {displacement:.15g}')}*END STEP\n" for displacement in displacements)


LEAN, STIFF, WEAK, PRESS = np.pi / 3, 100.0, 20.0, 0.01


def test_snap_through_of_friction(proof: Proof) -> None:
    """A node that separates at once at the friction limit, since its pressure falls faster than its pull: the next equilibrium is out of contact."""
    mu = 1.5
    case = proof(
        "snap-of-friction",
        title="A pole on a rough table that is pulled until it snaps through",
        model="A node on a rigid table under a bar that leans by 60 degrees (stiffness 100), pressed along itself by 0.01; a level bar (stiffness 20) pulls it; "
        "mu = 1.5, small displacements, DIRECT: pressed in one increment, pulled to 0.95 and 1.05 of where friction ends in one increment each.",
        formula="It sticks while (N the pressure of the leaning bar, w the pull) cos(60) k1 e + k2 w < mu sin(60) k1 e. Beyond, each slip takes more from mu N "
        "than from the pull: mu k1 s c > k1 c^2 + k2, so no slip balances. What balances next is the node in the air with both bars slack: x = w, "
        "z = (c w - e)/s.",
        source="statics of three bars",
        proves="Limit point: without an equilibrium nearby, a proximal shift leads to the next one; no regularization force remains there.",
    )
    c, s = np.cos(LEAN), np.sin(LEAN)
    end = (mu * s - c) * STIFF * PRESS / WEAK
    assert mu * STIFF * s * c > STIFF * c**2 + WEAK
    job = case.run(pole(mu, (0.95 * end, 1.05 * end)), requested=3)
    u = job.field("U")[:, 0]
    displacement = 1.05 * end
    case.near("slip before", np.abs(u[2]).max(), 0.0, 1e-12, why="it sticks", place="end of the pole", time="0.95 of the end", scale=end)
    case.near("displacement", u[3], np.array([displacement, 0.0, (c * displacement - PRESS) / s]), 1e-9, why="linear after the snap-through", place="end of the pole", time="1.05 of the end")
    case.near("forces of the supports", np.abs(job.last("RF")).max(), 0.0, 1e-6, why="both bars are slack", scale=STIFF * PRESS, time="1.05 of the end",
              place="supports")  # fmt: skip
    stored = 0.5 * (STIFF * PRESS**2 + WEAK * displacement**2)
    case.within("work of the snap-through", regularization_work(job.path)[-1], (1e-3 * stored, stored), why="friction takes a part of what both bars have stored",
                place="the pole", time="the end")  # fmt: skip
    case.true("the snap-through is noted in .cvg", "snap-through to another equilibrium" in job.path.with_suffix(".cvg").read_text(), why="a later reader needs it",
              place="the pole", time="the end")  # fmt: skip
    case.done()


@pytest.mark.parametrize("size", [0.05, 1.0])
def test_block_that_snaps_on(run: Run, tmp_path: Path, size: float) -> None:
    """A soft block dragged over eight facets with mu = 1: its rear lifts, its front sticks and separates at once; any size of increment gets to the end.

    Proximal steps lead it to the next equilibrium, which the terminal and .cvg report.
    """
    body, table = sheet("BODY", between(0, 1, 6), between(0, 1, 6)), sheet("TABLE", between(-1, 4, 20), between(-1, 0, 4))
    press = fix("TABLE_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.05")
    steps = "".join(f"*STEP, NLGEOM, INC=1000\n*STATIC\n{size}, 1., 1e-6, 1.\n{load}*END STEP\n" for load in (press, fix("BODY_TOP, 1, 1, 2.")))
    deck = flat_deck([(flatten(body), STEEL), (flatten(table), STEEL)], "CPE4", pair("BODY_BOTTOM", "TABLE_TOP", 1.0) + steps)
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    message = "snap-through to another equilibrium"
    assert message in done.stdout, done.stdout
    assert message in (tmp_path / "job.cvg").read_text()
