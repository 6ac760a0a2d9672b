"""Contact decks as an engineer writes them, with default settings: they finish, in at most 8 iterations per requested increment.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.decks.make_decks import Mesh
from verify.decks.planes import flat_deck, flatten, join_planes
from verify.decks.sheets import Floats, between, fix, pair, sheet

Proof = Callable[..., Case]
STEEL, SOFT, RUBBER = (210000.0, 0.3), (2000.0, 0.3), (10.0, 0.45)
Parts = list[tuple[Mesh, tuple[float, float]]]


def steps(n: int, *loads: str) -> str:
    """A step under NLGEOM for each load, in n increments."""
    text = ""
    for load in loads:
        text += f"*STEP, NLGEOM, INC=1000\n*STATIC\n{1 / n:.10g}, 1., 1e-6, {1 / n:.10g}\n{load}*END STEP\n"
    return text


def pin_in_bush() -> tuple[Parts, str, str, int, list[str]]:
    """A pin 2 % too thick is pressed into a bush with a chamfer, axisymmetric."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        inner = np.where(t < 3.2, 1.0, 1.0 + (t - 3.2) / 0.8 * 0.15)
        return inner + (3 - inner) * s, t - 4.0

    pin, bush = sheet("PIN", between(0, 1.02, 4), between(0, 4, 16)), sheet("BUSH", between(0, 1, 5), between(0, 4, 16), place)
    load = fix("BUSH_BOTTOM, 2", "BUSH_RIGHT, 1", "PIN_LEFT, 1", "PIN_TOP, 2, 2, -2.")
    return [(pin, STEEL), (bush, STEEL)], "CAX4", pair("PIN_RIGHT", "BUSH_LEFT", 0.1) + steps(20, load), 20, ["BUSH_BOTTOM", "PIN_TOP"]


def cold_fit() -> tuple[Parts, str, str, int, list[str]]:
    """A ring shrunk on another, then drawn along by its end, nodes that touch among those drawn; axisymmetric."""
    inner, outer = sheet("IN", between(1, 2.01, 4), between(0, 2, 8)), sheet("OUT", between(2, 3, 4), between(0, 2, 6))
    cards = steps(1, fix("IN_BOTTOM, 2", "OUT_BOTTOM, 2")) + steps(4, fix("IN_BOTTOM, 2, 2, 0.5"))
    return [(inner, STEEL), (outer, STEEL)], "CAX4", pair("IN_RIGHT", "OUT_LEFT", 0.15) + cards, 5, ["IN_BOTTOM", "OUT_BOTTOM"]


def gaskets() -> tuple[Parts, str, str, int, list[str]]:
    """Three steel plates with two soft layers between them, pressed and sheared; four pairs in a chain."""
    parts: Parts = []
    z = 0.0
    for name, height, n, elastic in (("A", 1.0, 8, STEEL), ("B", 0.2, 11, RUBBER), ("C", 1.0, 8, STEEL), ("D", 0.2, 11, RUBBER), ("E", 1.0, 8, STEEL)):
        parts.append((sheet(f"P{name}", between(0, 4, n), between(z, z + height, 3)), elastic))
        z += height
    pairs = "".join(pair(f"P{above}_BOTTOM", f"P{below}_TOP", 0.3) for below, above in zip("ABCD", "BCDE", strict=True))
    cards = steps(5, fix("PA_BOTTOM, 1, 2", "PE_TOP, 1", "PE_TOP, 2, 2, -0.08"), fix("PE_TOP, 1, 1, 0.1"))
    return parts, "CPE4", pairs + cards, 10, ["PA_BOTTOM", "PE_TOP"]


def in_a_corner() -> tuple[Parts, str, str, int, list[str]]:
    """A block driven into a corner of two walls; its edge, which touches both, is moved along one of them by its support."""
    body, floor = sheet("BODY", between(0.02, 1, 4), between(0.02, 1, 4)), sheet("FLOOR", between(-1, 3, 15), between(-1, 0, 3))
    wall = sheet("WALL", between(-1, 0, 3), between(0, 3, 11))
    pairs = pair("BODY_BOTTOM", "FLOOR_TOP", 0.2) + pair("BODY_LEFT", "WALL_RIGHT", 0.2)
    load = fix("FLOOR_BOTTOM, 1, 2", "WALL_LEFT, 1, 2", "BODY_TOP, 2, 2, -0.1", "BODY_RIGHT, 1, 1, -0.1")
    return [(body, SOFT), (floor, STEEL), (wall, STEEL)], "CPE4", pairs + steps(4, load), 4, ["FLOOR_BOTTOM", "WALL_LEFT", "BODY_TOP", "BODY_RIGHT"]


def wedge() -> tuple[Parts, str, str, int, list[str]]:
    """A wedge driven between two soft blocks that stand still at first."""

    def taper(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return 6 * s - 5.8, 0.05 + (0.5 + 0.9 * (1 - s)) * t

    body = sheet("WEDGE", between(0, 1, 12), between(0, 1, 4), taper)
    low, up = sheet("LOW", between(0, 8, 30), between(-1, 0.05, 3)), sheet("UP", between(0, 8, 30), between(0.56, 2.06, 5))
    pairs = pair("WEDGE_BOTTOM", "LOW_TOP", 0.1) + pair("WEDGE_TOP", "UP_BOTTOM", 0.1)
    load = fix("LOW_BOTTOM, 1, 2", "UP_TOP, 1, 2", "WEDGE_LEFT, 1, 1, 1.5")
    return [(body, STEEL), (low, SOFT), (up, SOFT)], "CPE4", pairs + steps(20, load), 20, ["LOW_BOTTOM", "UP_TOP", "WEDGE_LEFT"]


def gasket_at_edges() -> tuple[Parts, str, str, int, list[str]]:
    """A soft gasket as wide as the plates that press and shear it: its corners are pressed out over the edges of both."""
    low, up = sheet("LOW", between(0, 4, 16), between(0, 1, 4)), sheet("UP", between(0, 4, 14), between(1.2, 2.2, 4))
    gasket = sheet("GASKET", between(0, 4, 24), between(1, 1.2, 3))
    pairs = pair("GASKET_BOTTOM", "LOW_TOP", 0.3) + pair("GASKET_TOP", "UP_BOTTOM", 0.3)
    cards = steps(5, fix("LOW_BOTTOM, 1, 2", "UP_TOP, 1", "UP_TOP, 2, 2, -0.02"), fix("UP_TOP, 1, 1, 0.05"))
    return [(low, STEEL), (gasket, RUBBER), (up, STEEL)], "CPE4", pairs + cards, 10, ["LOW_BOTTOM", "UP_TOP"]


@pytest.mark.parametrize("make", [pin_in_bush, cold_fit, gaskets, in_a_corner, wedge, gasket_at_edges], ids=lambda make: make.__name__)
def test_defaults(proof: Proof, make: Callable[[], tuple[Parts, str, str, int, list[str]]]) -> None:
    """It finishes in equilibrium within the iterations that every case is allowed."""
    parts, kind, cards, requested, held = make()
    name = make.__name__.replace("_", "-")
    case = proof(
        f"defaults-{name}",
        title=f"Default settings: {name.replace('-', ' ')}",
        model=f"{make.__doc__} {kind}, NLGEOM, {requested} requested increments.",
        formula="The reactions of all supports are in equilibrium; 8 iterations per requested increment are enough.",
        source="statics",
        proves="Contact as an engineer writes it converges without a setting.",
    )
    planes = [(flatten(part), elastic) for part, elastic in parts]
    job = case.run(flat_deck(planes, kind, cards), requested=requested)
    whole = join_planes([plane for plane, _ in planes])
    nodes = np.unique(np.concatenate([whole.node_sets[side] for side in held]))
    force = job.last("RF")[nodes, 1]
    case.near("sum of the reactions along y", force.sum() / np.abs(force).sum(), 0.0, 1e-5, why="the tolerance of Newton's method", scale=1.0,
              place="all nodes", time="the end")  # fmt: skip
    case.true("they press", bool(np.abs(force).max() > 0), why="else nothing is shown", place="all nodes", time="the end")
    case.done()
