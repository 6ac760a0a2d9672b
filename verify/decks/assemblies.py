"""Small assemblies for general contact: a bolted flange with a shell gasket, and a rubber lip that a plate presses on its own base.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verify.decks.grids import Body, bodies_deck, grid
from verify.decks.make_decks import Floats, _set_card
from verify.decks.sheets import between, fix

STEEL, GASKET, RUBBER = "*ELASTIC\n210000., 0.3\n", "*ELASTIC\n2000., 0.3\n", "*HYPERELASTIC, NEO HOOKE\n0.5, 0.04\n"
PRELOAD = 5000.0  #: of a quarter of the bolt
HOLE, WIDTH, SHANK = 4.0, 20.0, 3.6
THICK, RADIUS, BASE, FREE, TURN = 0.3, 0.5, 3.0, 2.4, 2.2  #: of the lip: thickness, its bend, the straight parts, the angle
GAP = 0.42  #: between the floor and the plate at the end: one and a half thicknesses less what the tip is squeezed


def _interaction(mu: float) -> str:
    """The interaction DRY; without friction it has no card of it."""
    return "*SURFACE INTERACTION, NAME=DRY\n" + (f"*FRICTION\n{mu}\n" if mu > 0 else "")


def general(mu: float) -> str:
    """All exteriors, with friction."""
    return f"{_interaction(mu)}*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PROPERTY ASSIGNMENT\n, , DRY\n"


def by_hand(mu: float, *pairs: str) -> str:
    """Pairs of surfaces, with friction."""
    card = "*CONTACT PAIR, INTERACTION=DRY, TYPE=SURFACE TO SURFACE\n"
    return _interaction(mu) + "".join(f"{card}{line}\n" for line in pairs)


def without(body: Body, is_cut: Callable[[Floats], np.ndarray]) -> Body:
    """A body without the cells whose middles are in a region; its sides go."""
    elements = body.elements[~is_cut(body.nodes[body.elements].mean(axis=1))]
    kept, numbers = np.unique(elements, return_inverse=True)
    return Body(body.name, body.nodes[kept], numbers.reshape(elements.shape), {})


FLANGE_PAIRS = ("BELOW, LOWER_INNER", "ABOVE, UPPER_INNER", "BOLT_HEAD, UPPER_OUTER", "BOLT_NUT, LOWER_OUTER")


def flange(contact: str) -> str:
    """A quarter of two plates with a hole, a gasket of shells between them and a bolt with pre-tension, whose stretch is then kept."""
    x = between(0, WIDTH, 5)

    def plate(name: str, z: Floats, inner: float, outer: float) -> Body:
        body = without(grid(name, x, x, z), lambda m: (m[:, :2] < HOLE).all(axis=1))
        body.surface("INNER", lambda m: np.abs(m[:, 2] - inner) < 1e-9)
        body.surface("OUTER", lambda m: np.abs(m[:, 2] - outer) < 1e-9)
        return body

    lower, upper = plate("LOWER", between(-5.5, -0.5, 2), -0.5, -5.5), plate("UPPER", between(0.5, 5.5, 2), 0.5, 5.5)
    across, along = [0, 1.8, SHANK, HOLE, 5.6, 7.2], [-8.5, -7, -5.5, -2.75, 0, 2.75, 5.5, 7, 8.5]
    bolt = without(grid("BOLT", across, across, along), lambda m: (np.abs(m[:, 2]) < 5.5) & (m[:, :2] > SHANK).any(axis=1))
    over_plate = lambda m: (m[:, :2] > HOLE).any(axis=1)  # noqa: E731
    bolt.surface("HEAD", lambda m: (np.abs(m[:, 2] - 5.5) < 1e-9) & over_plate(m))
    bolt.surface("NUT", lambda m: (np.abs(m[:, 2] + 5.5) < 1e-9) & over_plate(m))
    for body in (bolt, lower, upper):
        body.select("XS", lambda p: np.abs(p[:, 0]) < 1e-9)
        body.select("YS", lambda p: np.abs(p[:, 1]) < 1e-9)
    lower.select("FOOT", lambda p: (np.abs(p[:, 2] + 5.5) < 1e-9) & (p[:, 0] > WIDTH - 1e-9))
    middles = bolt.nodes[bolt.elements].mean(axis=1)[:, 2]
    cut = np.flatnonzero((middles > -2.75) & (middles < 0)) + 1  # the bolt has the first labels
    held = fix(*(f"{name}_{side}S, {axis}" for name in ("BOLT", "LOWER", "UPPER", "GASKET") for axis, side in enumerate("XY", start=1)))
    cards = "*SURFACE, NAME=CUT\n" + "".join(f"{e}, S2\n" for e in cut) + "*NODE\n90000, 0., 0., 20.\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=90000\n"
    cards += _gasket() + contact + held + fix("LOWER_FOOT, 3")
    cards += f"*STEP\n*STATIC\n*CLOAD\n90000, 1, {PRELOAD}\n*END STEP\n*STEP\n*STATIC\n*BOUNDARY, FIXED\n90000, 1, 1\n*END STEP\n"
    return bodies_deck([(bolt, STEEL), (lower, STEEL), (upper, STEEL)], "C3D8I", cards)


def _gasket() -> str:
    """Shells of thickness 1 in the plane z = 0, around the hole; the first label is 90001."""
    line = np.concatenate([[0.0], between(HOLE, WIDTH, 5)])
    squares = without(grid("GASKET", line, line), lambda m: (m < HOLE).all(axis=1))
    first = 90001
    lines = ["*NODE", *(f"{first + i}, {x:.9g}, {y:.9g}, 0." for i, (x, y) in enumerate(squares.nodes))]
    lines += ["*ELEMENT, TYPE=S4, ELSET=GASKET", *(f"{first + i}, " + ", ".join(str(first + k) for k in row) for i, row in enumerate(squares.elements))]
    for axis, side in enumerate("XY"):
        lines += _set_card("NSET", f"GASKET_{side}S", np.flatnonzero(np.abs(squares.nodes[:, axis]) < 1e-9) + first - 1)
    lines += ["*MATERIAL, NAME=GASKET", GASKET + "*SHELL SECTION, ELSET=GASKET, MATERIAL=GASKET", "1.",
              "*SURFACE, NAME=ABOVE", "GASKET, SPOS", "*SURFACE, NAME=BELOW", "GASKET, SNEG", ""]  # fmt: skip
    return "\n".join(lines)


def rubber_lip(n: int, contact: str) -> str:
    """A strip of rubber whose base lies on a fixed floor; its free part leans over the base, and a steel plate presses its round tip on it."""
    bend, tip = RADIUS * TURN, THICK / 2
    end = BASE + bend + FREE

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle, beyond = np.clip((s - BASE) / RADIUS, 0, TURN), np.maximum(s - BASE - bend, 0)
        out = (0.5 - t) * THICK * np.sqrt(1 - (0.95 * np.clip((s - end) / tip + 1, 0, 1)) ** 2)
        x = RADIUS - (RADIUS - out) * np.sin(angle) + np.maximum(BASE - s, 0) - np.cos(TURN) * beyond
        return x, RADIUS - (RADIUS - out) * np.cos(angle) + np.sin(TURN) * beyond

    parts = [between(0, BASE, 6 * n), between(BASE, BASE + bend, 4 * n), between(BASE + bend, end - tip, 6 * n),
             end - tip + tip * np.sin(between(0, np.pi / 2, n))]  # fmt: skip
    lip = grid("LIP", np.concatenate([parts[0], *(part[1:] for part in parts[1:])]), between(0, 1, n), place=place)
    lip.select("FOOT", lambda p: (np.abs(p[:, 1] + THICK / 2) < 1e-9) & (p[:, 0] > RADIUS - 1e-9))
    low = float(lip.nodes[:, 1].max()) + 0.02

    def bevel(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return s, t + 0.3 * np.clip((1.2 - s) / 0.4, 0, 1) * (low + 0.5 - t) / 0.5

    plate = grid("PLATE", between(0.8, 4.6, 8 * n), between(low, low + 0.5, 1), place=bevel)
    cards = fix("LIP_FOOT, 1, 2", "PLATE_T1, 1", f"PLATE_T1, 2, 2, {GAP - low:.6g}")
    step = f"*STEP, NLGEOM, INC=1000\n*STATIC\n0.05, 1., 1e-6, 0.1\n{cards}*END STEP\n"
    return bodies_deck([(lip, RUBBER), (plate, STEEL)], "CPE4", contact + step)


def snap_hook(contact: str, largest: float, way: float = 6.6, n: int = 3) -> str:
    """A clamped arm with a hook that is pushed over a catch of the same plastic, as is usual, by default settings but for the largest
    increment: at the end the back of the hook is behind the catch.
    """
    arm, depth, land, height = 10.0, 1.0, 0.6, 1.2
    ends = np.cumsum([arm, depth / np.tan(np.radians(80)), land, (depth + 0.3) / np.tan(np.radians(30))])
    lines = [between(0, ends[0], 8 * n), ends[1:2], between(ends[1], ends[2], 2 * n)[1:], between(ends[2], ends[3], 6 * n)[1:]]

    def hook_at(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        low = np.interp(s, ends, [0, -depth, -depth, 0.3])
        return s, low + (height - low) * t

    hook = grid("HOOK", np.concatenate(lines), between(0, 1, 3 * n), place=hook_at)
    steps = ends[3] + 0.3 + np.cumsum([0.0, depth / np.tan(np.radians(40)), 0.8, depth / np.tan(np.radians(75))])
    m = max(n - 1, 1)
    lines = [between(steps[0] - 2, steps[0], 3 * m), *(between(*steps[i : i + 2], k * m)[1:] for i, k in enumerate((3, 2, 2))),
             between(steps[3], steps[3] + 6, 4 * m)[1:]]  # fmt: skip

    def catch_at(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return s, -4 + (2.95 + np.interp(s, steps, [0, depth, depth, 0])) * t

    catch = grid("CATCH", np.concatenate(lines), between(0, 1, 3 * m), place=catch_at)
    hook.surface("SKIN", lambda x: x[:, 0] > 0)
    catch.surface("SKIN", lambda x: x[:, 1] > -4)
    cards = contact + fix("CATCH_T0, 1, 2") + f"*STEP, NLGEOM, INC=1000\n*STATIC\n0.02, 1., 1e-7, {largest}\n"
    cards += fix(f"HOOK_S0, 1, 1, {way}", "HOOK_S0, 2") + "*END STEP\n"
    return bodies_deck([(catch, "*ELASTIC\n2500., 0.38\n"), (hook, "*ELASTIC\n2500., 0.38\n")], "CPE4", cards)
