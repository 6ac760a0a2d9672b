"""Seals of rubber between bodies of steel, with supports and loads and no pair: an O-ring, a U-cup, a wiper lip.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import numpy as np

from verify.decks.assemblies import RUBBER, STEEL
from verify.decks.grids import Body, bodies_deck, grid
from verify.decks.make_decks import Floats
from verify.decks.sheets import between, fix

RING_RADIUS, CORD = 10.0, 2.0  #: of the O-ring: mean radius, diameter of its section
CUP_SLOT, CUP_LEG, CUP_LEAN = 0.12, 0.35, 0.25  #: of the U-cup: width of its slot at the root, thickness of its legs, how far they lean out
LIP_LENGTH, LIP_THICK, SLIT = 1.5, 0.3, 0.5  #: of the wiper; the slit between the housing and the shaft


def step_of(cards: str, largest: float = 0.1) -> str:
    """A step with automatic increments."""
    return f"*STEP, NLGEOM, INC=1000\n*STATIC\n{largest / 2}, 1., 1e-6, {largest}\n{cards}*END STEP\n"


def _disc(name: str, n: int) -> Body:
    """A disc of radius CORD / 2 at RING_RADIUS: a square of 2 n by 2 n elements within n rings of 8 n."""
    s = between(-1, 1, 2 * n)
    u, v = (a.ravel() for a in np.meshgrid(s, s))
    largest = np.maximum(np.abs(u), np.abs(v))
    bulge = 0.65 + 0.35 * largest / np.maximum(np.hypot(u, v), 1e-9)  # sides between those of a square and of a circle
    core = 0.5 * CORD / 2 * np.stack([u, v], axis=1) * bulge[:, None]
    index = np.arange(len(core)).reshape(2 * n + 1, -1)
    quads = [np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)]
    around = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    angle = np.pi * (-0.75 + 2 * np.arange(len(around)) / len(around))
    rim = CORD / 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    nodes, inner = [core], around
    for k in range(1, n + 1):
        nodes.append(core[around] + (rim - core[around]) * k / n)
        outer = len(core) + (k - 1) * len(around) + np.arange(len(around))
        quads.append(np.stack([inner, outer, np.roll(outer, -1), np.roll(inner, -1)], axis=1))
        inner = outer
    return Body(name, np.concatenate(nodes) + [RING_RADIUS, 0], np.concatenate(quads), {})


def o_ring(n: int, kind: str, contact: str, squeeze: float, groove: float | None = None) -> str:
    """An O-ring, free to slide, that a plate squeezes by a share of its section; with a groove's half width also between two walls."""
    half = 0.8 * CORD if groove is None else groove
    ring, r = _disc("RING", n), CORD / 2
    low = grid("LOW", between(RING_RADIUS - half, RING_RADIUS + half, 4 * n), between(-r - 0.5, -r, 1))
    top = grid("TOP", between(RING_RADIUS - 0.98 * half, RING_RADIUS + 0.98 * half, 4 * n), between(r, r + 0.5, 1))
    walls = [] if groove is None else [
        grid("INNER", between(RING_RADIUS - half - 0.5, RING_RADIUS - half, 1), between(-r - 0.5, r, 4 * n)),
        grid("OUTER", between(RING_RADIUS + half, RING_RADIUS + half + 0.5, 1), between(-r - 0.5, r, 4 * n))]  # fmt: skip
    cards = fix("LOW, 1, 2", "TOP, 1", f"TOP, 2, 2, {-squeeze * CORD}", *(f"{wall.name}, 1, 2" for wall in walls))
    return bodies_deck([(ring, RUBBER), (low, STEEL), (top, STEEL), *((wall, STEEL) for wall in walls)], kind, contact + step_of(cards))


def u_cup(n: int, contact: str, close: float) -> str:
    """A U-cup whose legs lean outwards; two walls come towards each other by `close` each, until the legs touch one another."""
    half, low, high = CUP_SLOT / 2 + CUP_LEG, 0.5, 2.0
    x = np.concatenate([between(-half, -CUP_SLOT / 2, n), between(-CUP_SLOT / 2, CUP_SLOT / 2, n)[1:], between(CUP_SLOT / 2, half, n)[1:]])
    y = np.concatenate([between(0, low, n), between(low, high, 5 * n)[1:]])
    cup = grid("CUP", x, y)
    at = cup.nodes[cup.elements].mean(axis=1)
    kept, elements = np.unique(cup.elements[(np.abs(at[:, 0]) > CUP_SLOT / 2) | (at[:, 1] < low)], return_inverse=True)
    nodes = cup.nodes[kept]
    nodes[:, 0] += CUP_LEAN * np.sign(nodes[:, 0]) * np.clip((nodes[:, 1] - low) / (high - low), 0, 1)
    cup = Body("CUP", nodes, elements.reshape(-1, 4), {})
    cup.select("FOOT", lambda p: (p[:, 1] < 1e-9) & (np.abs(p[:, 0]) < 0.15))
    inner = half + CUP_LEAN + 0.01
    walls = [grid("LEFT", between(-inner - 0.5, -inner, 1), between(0.01, high + 0.5, 8 * n)),
             grid("RIGHT", between(inner, inner + 0.5, 1), between(0.01, high + 0.5, 8 * n))]  # fmt: skip
    floor = grid("FLOOR", between(-1.5, 1.5, 12 * n), between(-0.4, 0, 1))
    cards = fix("CUP_FOOT, 1, 2", "FLOOR, 1, 2", "LEFT, 2", "RIGHT, 2", f"LEFT, 1, 1, {close}", f"RIGHT, 1, 1, {-close}")
    return bodies_deck([(cup, RUBBER), *((body, STEEL) for body in (*walls, floor))], "CPE4", contact + step_of(cards))


def wiper_lip(n: int, material: str, contact: str, way: float) -> str:
    """A lip that hangs from a housing; a shaft with a bevel passes below and lays it against the housing."""

    def taper(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return s * LIP_THICK * (1 + 0.3 * t), t * LIP_LENGTH

    def bevel(x: Floats, y: Floats) -> tuple[Floats, Floats]:
        return x, y - 0.8 * np.clip(x + 1.4, 0, 1) * (y - bottom) / (-SLIT - bottom)

    bottom = -LIP_LENGTH - 1.5
    lip = grid("LIP", between(-0.5, 0.5, 2 * n), between(-1, 0, 8 * n), place=taper)
    lip.select("ROOT", lambda p: np.abs(p[:, 1]) < 1e-9)
    housing = grid("HOUSING", between(-3, 3, 12 * n), between(0, 0.5, 1))
    shaft = grid("SHAFT", between(-7, -0.4, 20 * n), between(bottom, -SLIT, 2 * n), place=bevel)
    cards = fix("LIP_ROOT, 1, 2", "HOUSING, 1, 2", "SHAFT, 2", f"SHAFT, 1, 1, {way}")
    return bodies_deck([(lip, material), (housing, STEEL), (shaft, STEEL)], "CPE4", contact + step_of(cards, 0.04))
