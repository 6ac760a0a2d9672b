"""Hard contact problems of small size, by class: loose bodies, soft on hard, snap fits and rolling, buckling, many points, folds, exteriors.

SPDX-License-Identifier: GPL-3.0-or-later

Each problem is a function of `draw`, which gives the usual value of a parameter for the first set, and a value between two bounds at random for the
second set, to which nothing is tuned, and of the options of its contact pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random

import numpy as np

from verify.decks.grids import Body, Place, bodies_deck, grid
from verify.decks.loose_bodies import DENSITY, GRAVITY, Pile, stack, wall
from verify.decks.make_decks import Floats
from verify.decks.sheets import between, fix, pair

STEEL, SOFT = "*ELASTIC\n210000., 0.3\n", "*ELASTIC\n2000., 0.3\n"
RUBBER = "*HYPERELASTIC, NEO HOOKE\n0.5, 0.04\n"  #: E about 3, nu 0.48


class Draw:
    """Parameters of a set: the usual ones without a seed, else at random."""

    def __init__(self, seed: str = "") -> None:
        self.random = Random(seed) if seed else None

    def __call__(self, usual: float, low: float, high: float) -> float:
        """A real number, with three digits."""
        return usual if self.random is None else float(f"{self.random.uniform(low, high):.3g}")

    def count(self, usual: int, low: int, high: int) -> int:
        """A whole number."""
        return usual if self.random is None else self.random.randint(low, high)


@dataclass(frozen=True)
class Problem:
    """A deck, and what its end is checked by."""

    deck: str
    mu: float  #: of all its pairs; 1e30 where friction has no limit
    loads: tuple[float, ...]  #: resultant of all loads at the end; NaN: forces along the radius have none
    reaction: tuple[str, int, float, float] | None = None  #: node set, direction, its reaction in closed form, tolerance [-]


def elastic(young: float, nu: float = 0.3) -> str:
    """*ELASTIC."""
    return f"*ELASTIC\n{young:.6g}, {nu:.6g}\n"


def step(cards: str, n: int, words: str = "") -> str:
    """A step of length 1 in n requested increments."""
    return f"*STEP, NLGEOM, INC=2000{words}\n*STATIC\n{1 / n:.10g}, 1., 1e-6, {1 / n:.10g}\n{cards}*END STEP\n"


def _annulus(name: str, radii: Sequence[float] | Floats, centre: tuple[float, float], n: int) -> Body:
    """A ring or a roller: T0 its rim, T1 its bore."""
    def place(s: Floats, t: Floats) -> list[Floats]:
        return [centre[0] + t * np.sin(s), centre[1] - t * np.cos(s)]

    return grid(name, between(0, 2 * np.pi, n), np.asarray(radii)[::-1], place=place, is_closed=True)


def _profile(low: Callable[[Floats], Floats], high: Callable[[Floats], Floats]) -> Place:
    """Columns between two heights; further coordinates as they are. The last line is the height."""
    def place(s: Floats, *others: Floats) -> list[Floats]:
        t = others[-1]
        return [s, *others[:-1], low(s) * (1 - t) + high(s) * t]

    return place


# ------------------------------------------------------------------------------------------------------------- a: loose bodies


def _pile(pile: Pile) -> Problem:
    return Problem(pile.deck, pile.mu, (pile.push, -pile.weight))


def stack_of(n: int, gap: float, draw: Draw, options: str) -> Problem:
    """A stack of blocks with gaps."""
    return _pile(stack(n, draw(gap, 0.005, 0.25), cells=draw.count(2, 1, 4), options=options))


def wall_of(n: int, draw: Draw, options: str) -> Problem:
    """A wall of bricks with gaps."""
    return _pile(wall(n, draw.count(n, 2, 5), draw(0.01, 0.002, 0.1), options=options))


def falling_block(draw: Draw, options: str) -> Problem:
    """A block falls on a table, without any support."""
    return _pile(stack(1, draw(0.5, 0.2, 1.5), push=0.1, cells=draw.count(3, 2, 5), options=options))


def tower(draw: Draw, options: str) -> Problem:
    """Blocks of eight elements one above the other in space, with gaps, each smaller than the one below."""
    n, gap, mu = draw.count(6, 3, 10), draw(0.02, 0.005, 0.2), 0.3
    table = grid("TABLE", between(-2, 2, 5), between(-2, 2, 5), [-1, -0.4, 0])
    bodies, cards, below, low = [(table, STEEL)], "", "TABLE_W1", gap
    for i in range(n):
        half = 0.8 - 0.03 * i
        body = grid(f"B{i + 1}", between(-half, half, 2), between(-half, half, 2), between(low, low + 0.6, 2))
        bodies.append((body, STEEL + f"*DENSITY\n{DENSITY:g}\n"))
        cards += pair(f"B{i + 1}_W0", below, mu, options)
        below, low = f"B{i + 1}_W1", low + 0.6 + gap
    weight = sum(DENSITY * GRAVITY * float(np.prod(np.ptp(body.nodes, axis=0))) for body, _ in bodies[1:])
    loads = "*DLOAD\n" + "".join(f"{body.name}, GRAV, {GRAVITY:g}, 0.02, 0., -1.\n" for body, _ in bodies[1:])
    return Problem(bodies_deck(bodies, "C3D8", cards + step(fix("TABLE_W0, 1, 3") + loads, 1)), mu, (0.02 * weight, 0.0, -weight))


# --------------------------------------------------------------------------------------------------------- b: soft sliding on hard


def ironing(shape: str, is_slab_soft: bool, facets: int, draw: Draw, options: str) -> Problem:
    """An indenter is pressed on a slab in space and drawn over its facets, some facets in each increment."""
    mu, ratio, facet = draw(0.3, 0.1, 0.5), draw(10.0, 4.0, 30.0), 0.4
    radius, depth, drag = draw(1.0, 0.8, 1.6), draw(0.2, 0.1, 0.25), 2.4
    bottom = (lambda s: 0.02 + radius - np.sqrt(radius**2 - s**2)) if shape == "curved" else (lambda s: 0.02 + 0 * s)
    indenter = grid("IRON", between(-0.6, 0.6, 6), between(0.2, 1.2, 3), between(0, 1, 3), place=_profile(bottom, lambda s: 1.0 + 0 * s))
    slab = grid("SLAB", between(-1.6, 4.4, 15), between(0, 1.4, 4), [-1.0, -0.6, -0.25, 0])
    soft, hard = elastic(100.0, 0.32), elastic(100.0 * ratio, 0.32)
    parts = [(indenter, hard if is_slab_soft else soft), (slab, soft if is_slab_soft else hard)]
    n = round(drag / (facets * facet))
    press = step(fix("SLAB_W0, 1, 3", "IRON_W1, 1, 2", f"IRON_W1, 3, 3, {-depth - 0.02:.6g}"), 5)
    cards = pair("IRON_W0", "SLAB_W1", mu, options) + press + step(fix(f"IRON_W1, 1, 1, {drag:g}"), n)
    return Problem(bodies_deck(parts, "C3D8", cards), mu, (0.0, 0.0, 0.0))


# ------------------------------------------------------------------------------------------- c: snap fits, crushing, grooves, rollers


def clip(n_thick: int, kind: str, mu: float, draw: Draw, options: str) -> Problem:
    """A snap fit: an elastic arm whose nose rides over a hook and snaps down behind it."""
    height, back = draw(1.0, 0.7, 1.1), draw(0.8, 0.6, 1.2)
    mu = draw(mu, 0.5 * mu, 1.1 * mu)

    def nose(s: Floats) -> Floats:
        return 1.2 - height * np.interp(s, [0.0, 1.2, 1.6, 1.6 + back], [0, 1, 1, 0])

    def hook(s: Floats) -> Floats:
        return height * np.interp(s, [-2.8 - back, -2.8, -2.4, -1.2], [0, 1, 1, 0])

    along = np.concatenate([between(0, 2.4, 2 * n_thick), between(2.4, 10, 3 * n_thick)[1:]])
    width = [between(0, 1, 2)] if kind == "C3D8" else []
    arm = grid("ARM", along, *width, between(0, 1, n_thick), place=_profile(nose, lambda s: 2.2 + 0 * s))
    block = grid("HOOK", between(-6, 0, 24), *width, [0, 0.4, 0.75, 1], place=_profile(lambda s: -1.5 + 0 * s, hook))
    low, last = ("T0", 2) if kind != "C3D8" else ("W0", 3)
    top = low[0] + "1"
    root = fix(f"HOOK_{low}, 1, {last}", f"ARM_S1, 2, {last}", "ARM_S1, 1, 1, -5.8")
    deck = bodies_deck([(arm, elastic(2000.0)), (block, STEEL)], kind, pair(f"ARM_{low}", f"HOOK_{top}", mu, options) + step(root, 15))
    return Problem(deck, mu, (0.0,) * last)


def crushed_ring(draw: Draw, options: str) -> Problem:
    """A ring is crushed between plates to less than half its height."""
    thick, mu, crush = draw(0.5, 0.3, 0.8), draw(0.2, 0.0, 0.5), draw(0.55, 0.3, 0.6)
    ring = _annulus("RING", between(5 - thick, 5, 3), (0, 5), 64)
    ring.select("MIDDLE", lambda x: np.abs(x[:, 0]) < 1e-6)
    low, high = grid("LOW", between(-9, 9, 36), between(-1, 0, 2)), grid("HIGH", between(-9, 9, 37), between(10, 11, 2))
    cards = pair("RING_T0", "LOW_T1", mu, options) + pair("RING_T0", "HIGH_T0", mu, options)
    cards += step(fix("LOW_T0, 1, 2", "HIGH_T1, 1", f"HIGH_T1, 2, 2, {-10 * crush:.6g}", "RING_MIDDLE, 1"), 20)
    return Problem(bodies_deck([(ring, SOFT), (low, STEEL), (high, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


def ball_in_groove(n: int, draw: Draw, options: str) -> Problem:
    """A ball is pressed into a V groove and drawn along it."""
    angle, mu, depth = draw(0.75, 0.5, 0.9), draw(0.3, 0.05, 0.5), draw(0.06, 0.02, 0.08)

    def place(u: Floats, v: Floats, w: Floats) -> list[Floats]:
        return [u * np.sqrt(1 - v * v / 2 - w * w / 2 + v * v * w * w / 3), v * np.sqrt(1 - w * w / 2 - u * u / 2 + w * w * u * u / 3),
                w * np.sqrt(1 - u * u / 2 - v * v / 2 + u * u * v * v / 3)]

    ball = grid("BALL", between(-1, 1, n), between(-1, 1, n), between(-1, 1, n), place=place)
    ball.surface("LOWER", lambda x: x[:, 2] < 0.3)
    foot = -1 / np.cos(angle)
    groove = grid("GROOVE", between(-1.6, 1.6, 2 * n), between(-1.2, 2.2, n + 1), [0, 0.5, 0.8, 1],
                  place=_profile(lambda s: foot - 1.0 + 0 * s, lambda s: foot + np.tan(angle) * np.abs(s)))
    ball.select("CAP", lambda x: x[:, 2] > 0.55)
    cards = pair("BALL_LOWER", "GROOVE_W1", mu, options) + step(fix("GROOVE_W0, 1, 3", "BALL_CAP, 1, 2", f"BALL_CAP, 3, 3, {-depth:.6g}"), 5)
    cards += step(fix("BALL_CAP, 2, 2, 0.8"), 10)
    return Problem(bodies_deck([(ball, SOFT), (groove, STEEL)], "C3D8", cards), mu, (0.0, 0.0, 0.0))


def rollers(n_rollers: int, draw: Draw, options: str) -> Problem:
    """A plate is pressed on rollers and drawn: they roll."""
    mu, depth, drag = draw(0.3, 0.15, 0.6), draw(0.03, 0.01, 0.05), draw(1.2, 0.5, 2.0)
    wide = 1.3 * n_rollers + 1.5
    table = grid("TABLE", between(-wide, wide, 16 * n_rollers), between(-0.8, 0, 2))
    plate = grid("PLATE", between(-wide, wide, 15 * n_rollers), between(2, 2.8, 2))
    bodies, cards, held = [(table, STEEL), (plate, STEEL)], "", []
    for i in range(n_rollers):
        name = f"R{i + 1}"
        bodies.append((_annulus(name, between(0.4, 1, 4), (2.6 * (i - (n_rollers - 1) / 2), 1), 48), SOFT))
        cards += pair(f"{name}_T0", "TABLE_T1", mu, options).replace("ON_", f"{name}_ON_")
        cards += pair(f"{name}_T0", "PLATE_T0", mu, options).replace("ON_", f"{name}_ON_")
        held.append(f"{name}_T1, 1")
    fixed = ["TABLE_T0, 1, 2", "PLATE_T1, 1", f"PLATE_T1, 2, 2, {-depth:.6g}"]
    cards += step(fix(*fixed, *held), 4)
    cards += step(fix("TABLE_T0, 1, 2", f"PLATE_T1, 1, 1, {drag:.6g}", f"PLATE_T1, 2, 2, {-depth:.6g}").replace("*BOUNDARY", "*BOUNDARY, OP=NEW"), 20)
    return Problem(bodies_deck(bodies, "CPE4", cards), mu, (0.0, 0.0))


def saddle(draw: Draw, options: str) -> Problem:
    """A roller is pressed into a saddle of nearly its radius and turned by its rigid bore."""
    mu, depth, turn = draw(0.3, 0.05, 0.6), draw(0.06, 0.02, 0.08), draw(0.6, 0.3, 0.9)
    gap = draw(0.03, 0.01, 0.1)
    roller = _annulus("ROLLER", between(0.4, 1, 5), (0, 0), 48)

    def place(s: Floats, t: Floats) -> list[Floats]:
        radius = 1 + gap + 0.8 * (1 - t)
        return [radius * np.sin(s), gap - radius * np.cos(s)]

    base = grid("SADDLE", between(-1.2, 1.2, 25), [0, 0.5, 0.8, 1], place=place)
    cards = "*NODE, NSET=HUB\n90001, 0., 0.\n*RIGID BODY, NSET=ROLLER_T1, REF NODE=90001\n" + pair("ROLLER_T0", "SADDLE_T1", mu, options)
    cards += step(fix("SADDLE_T0, 1, 2", "HUB, 1", f"HUB, 2, 2, {-depth:.6g}", "HUB, 6"), 5) + step(fix(f"HUB, 6, 6, {turn:.6g}"), 12)
    return Problem(bodies_deck([(roller, SOFT), (base, SOFT)], "CPE4", cards), mu, (0.0, 0.0))


# ------------------------------------------------------------------------------------------------ d: buckling and snapping in contact


def rings_on_each_other(draw: Draw, options: str) -> Problem:
    """Two rings one above the other are pressed between plates."""
    thick, mu, crush = draw(0.4, 0.3, 0.6), draw(0.2, 0.05, 0.4), draw(0.4, 0.2, 0.45)
    low, high = _annulus("R1", between(3 - thick, 3, 2), (0, 3), 48), _annulus("R2", between(3 - thick, 3, 2), (draw(0.0, 0.0, 0.05), 9), 52)
    floor, plate = grid("LOW", between(-6, 6, 24), between(-1, 0, 2)), grid("HIGH", between(-6, 6, 25), between(12, 13, 2))
    for ring in (low, high):
        ring.select("FOOT", lambda x: np.arange(len(x)) == np.argmin(x[:, 1] + 1e-3 * np.abs(x[:, 0])))
    cards = pair("R1_T0", "LOW_T1", mu, options) + pair("R2_T0", "R1_T0", mu, options) + pair("R2_T0", "HIGH_T0", mu, options)
    cards += step(fix("LOW_T0, 1, 2", "HIGH_T1, 1", f"HIGH_T1, 2, 2, {-12 * crush:.6g}", "R1_FOOT, 1", "R2_FOOT, 1"), 20)
    return Problem(bodies_deck([(low, SOFT), (high, SOFT), (floor, STEEL), (plate, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


def _arch(thick: float, angle: float) -> Body:
    """A shallow arch of radius 10: S0, S1 its ends, T1 its back."""
    def place(s: Floats, t: Floats) -> list[Floats]:
        return [(10 + t) * np.sin(s), (10 + t) * np.cos(s) - 10]

    return grid("ARCH", between(-angle, angle, 48), between(-thick, 0, 2), place=place)


def stamped_arch(is_force: bool, draw: Draw, options: str) -> Problem:
    """A stamp presses a shallow arch through, moved or under a pressure far beyond the limit load."""
    thick, angle, mu = draw(0.25, 0.2, 0.3), draw(0.35, 0.3, 0.4), draw(0.2, 0.0, 0.4)
    arch = _arch(thick, angle)
    stamp = grid("STAMP", between(-0.6, 0.6, 6), between(0, 1, 3), place=_profile(lambda s: 0.01 + 0.2 * s**2, lambda s: 1.0 + 0 * s))
    deep = 2.2 * 10 * (1 - np.cos(angle))
    loads = "*DLOAD\n" + "".join(f"STAMP_TOP, P3, {draw(12.0, 8.0, 20.0):.6g}\n" if is_force else "")
    moved = fix("ARCH_S0, 1, 2", "ARCH_S1, 1, 2", "STAMP_T1, 1", *([] if is_force else [f"STAMP_T1, 2, 2, {-deep:.6g}"]))
    cards = f"*ELSET, ELSET=STAMP_TOP\n{', '.join(str(len(arch.elements) + e + 1) for e, _ in stamp.sides['T1'])}\n"
    cards += pair("STAMP_T0", "ARCH_T1", mu, options) + step(moved + (loads if is_force else ""), 20)
    pressure = float(loads.split()[-1]) * 1.2 if is_force else 0.0
    return Problem(bodies_deck([(arch, SOFT), (stamp, STEEL)], "CPE4", cards), mu, (0.0, -pressure))


def bushing(draw: Draw, options: str) -> Problem:
    """A rubber bushing in its bore: its rigid shaft goes off the centre, then turns far; the rim slips in the bore."""
    mu, turn, off = draw(0.3, 0.1, 0.6), draw(1.2, 0.8, 1.6), draw(0.15, 0.05, 0.3)
    rubber = _annulus("RUBBER", between(1, 2, 6), (0, 0), 48)
    housing = _annulus("HOUSING", [2.0, 2.3, 2.7], (0, 0), 52)
    cards = "*NODE, NSET=SHAFT\n90001, 0., 0.\n*RIGID BODY, NSET=RUBBER_T1, REF NODE=90001\n" + pair("RUBBER_T0", "HOUSING_T1", mu, options)
    cards += step(fix("HOUSING_T0, 1, 2", f"SHAFT, 1, 1, {off:.6g}", "SHAFT, 2", "SHAFT, 6"), 5) + step(fix(f"SHAFT, 6, 6, {turn:.6g}"), 20)
    return Problem(bodies_deck([(rubber, RUBBER), (housing, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


def strut_in_channel(draw: Draw, options: str) -> Problem:
    """A strut, hardly bent, is compressed between two walls: it buckles, lies down on one wall and buckles on towards the other."""
    thick, mu, play, short = draw(0.3, 0.2, 0.4), draw(0.2, 0.0, 0.4), draw(0.5, 0.3, 0.8), draw(0.6, 0.3, 0.8)
    strut = grid("STRUT", between(0, 10, 60), between(-thick / 2, thick / 2, 3), place=lambda s, t: [s, t + 0.02 * np.sin(np.pi * s / 10)])
    low, high = -thick / 2 - play, thick / 2 + play
    walls = [grid("LOW", between(-1, 11, 48), between(low - 1, low, 2)), grid("HIGH", between(-1, 11, 49), between(high, high + 1, 2))]
    cards = pair("STRUT_T0", "LOW_T1", mu, options) + pair("STRUT_T1", "HIGH_T0", mu, options)
    cards += step(fix("LOW_T0, 1, 2", "HIGH_T1, 1, 2", "STRUT_S0, 1, 2", "STRUT_S1, 2", f"STRUT_S1, 1, 1, {-short:.6g}"), 20)
    return Problem(bodies_deck([(strut, SOFT), *((wall, STEEL) for wall in walls)], "CPE4", cards), mu, (0.0, 0.0))


# ------------------------------------------------------------------------------------------------------ e: many points, little behind


def belt(draw: Draw, options: str) -> Problem:
    """A belt over half a fixed pulley: one end under tension, the other drawn. Tension there: exp(mu pi) times the first."""
    mu, tension, n = draw(0.3, 0.1, 0.5), draw(2.0, 0.5, 4.0), draw.count(80, 60, 100)

    def place(s: Floats, t: Floats) -> list[Floats]:
        radius = 5 + t
        return [np.where(np.abs(s) <= np.pi / 2, radius * np.sin(np.clip(s, -np.pi / 2, np.pi / 2)), np.sign(s) * radius),
                np.where(np.abs(s) <= np.pi / 2, radius * np.cos(np.clip(s, -np.pi / 2, np.pi / 2)), 5 * (np.pi / 2 - np.abs(s)))]

    band = grid("BAND", between(-np.pi / 2 - 0.4, np.pi / 2 + 0.4, n), [0, 0.05, 0.1], place=place)
    pulley = _annulus("PULLEY", [3.5, 4.2, 4.7, 5.0], (0, 0), 90)
    end = [i + 1 for i, (x, y) in enumerate(band.nodes) if abs(y - band.nodes[:, 1].min()) < 1e-9 and x < 0]
    cards = pair("BAND_T0", "PULLEY_T0", mu, options)
    pulled = "*CLOAD\n" + "".join(f"{node}, 2, {-tension * share:.6g}\n" for node, share in zip(end, (0.25, 0.5, 0.25), strict=True))
    cards += step(fix("PULLEY_T1, 1, 2", "BAND_S0, 1", "BAND_S1, 1, 2") + pulled, 5) + step(fix("BAND_S1, 2, 2, -0.3"), 10)
    return Problem(bodies_deck([(band, elastic(5000.0)), (pulley, STEEL)], "CPE4", cards), mu, (0.0, -tension),
                   ("BAND_S1", 2, -tension * np.exp(mu * np.pi), 0.05))


def pressed_plates(draw: Draw, options: str) -> Problem:
    """Plates of equal width, five of them, pressed on each other: uniform stress E/(1 - nu^2) strain."""
    mu, strain, n = draw(0.3, 0.0, 0.6), draw(0.002, 0.001, 0.005), draw.count(40, 30, 60)
    plates = [grid(f"P{k + 1}", between(0, 10, n + 3 * k), between(k, k + 1, 2)) for k in range(5)]
    cards = "".join(pair(f"P{k + 1}_T0", f"P{k}_T1", mu, options) for k in range(1, 5))
    cards += step(fix("P1_T0, 2", "P1_S0, 1", *(f"P{k}_S0, 1" for k in range(2, 6)), f"P5_T1, 2, 2, {-5 * strain:.6g}"), 2)
    force = 10 * 2000.0 / (1 - 0.09) * strain
    return Problem(bodies_deck([(plate, SOFT) for plate in plates], "CPE4", cards), mu, (0.0, 0.0), ("P1_T0", 2, force, 0.02))


def leaf_spring(draw: Draw, options: str) -> Problem:
    """Leaves on each other, clamped at one end; the end of the uppermost one is pressed down: they bend and slide on each other."""
    mu, deep, n = draw(0.2, 0.0, 0.4), draw(1.0, 0.5, 1.5), draw.count(5, 3, 7)
    leaves = [grid(f"L{k + 1}", between(0, 10, 50 + k), between(0.25 * k, 0.25 * (k + 1), 2)) for k in range(n)]
    cards = "".join(pair(f"L{k + 1}_T0", f"L{k}_T1", mu, options) for k in range(1, n))
    cards += step(fix(*(f"L{k}_S0, 1, 2" for k in range(1, n + 1)), f"L{n}_S1, 2, 2, {-deep:.6g}"), 10)
    return Problem(bodies_deck([(leaf, STEEL) for leaf in leaves], "CPE4", cards), mu, (0.0, 0.0))


# --------------------------------------------------------------------------------------------------------------- f: folded lips


def wiper(draw: Draw, options: str) -> Problem:
    """A rubber blade is pressed on a plate and dragged: it folds over."""
    thick, mu, depth = draw(0.4, 0.3, 0.6), draw(0.4, 0.1, 0.8), draw(0.5, 0.2, 0.7)
    lip = grid("LIP", between(-thick / 2, thick / 2, 3), between(0.01, 3, 18))
    lip.surface("TIP", lambda x: x[:, 1] < 1.5)
    plate = grid("PLATE", between(-6, 3, 45), between(-1, 0, 2))
    cards = pair("LIP_TIP", "PLATE_T1", mu, options) + step(fix("PLATE_T0, 1, 2", "LIP_T1, 1, 2") + fix("LIP_T1, 1, 1, 0.3"), 4)
    cards += step(fix(f"LIP_T1, 2, 2, {-depth - 0.01:.6g}"), 10) + step(fix("LIP_T1, 1, 1, 2.5"), 20)
    return Problem(bodies_deck([(lip, RUBBER), (plate, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


def shaft_seal(draw: Draw, options: str) -> Problem:
    """A shaft with a cone at its end is pushed along the lip of a seal, which bends aside and lies down on it."""
    thick, mu, over = draw(0.4, 0.3, 0.6), draw(0.3, 0.0, 0.5), draw(0.8, 0.4, 1.0)
    lip = grid("LIP", between(-thick / 2, thick / 2, 3), between(0, 2.5, 15))
    lip.surface("FREE", lambda x: x[:, 1] < 1.8)
    shaft = grid("SHAFT", between(-8, -0.5, 40), between(0, 1, 3), place=_profile(lambda s: -2.0 + 0 * s, lambda s: over - (over + 0.3) * np.clip((s + 2.0) / 1.5, 0, 1)))
    cards = pair("LIP_FREE", "SHAFT_T1", mu, options) + step(fix("SHAFT_T0, 2", "SHAFT_T0, 1, 1, 5.", "LIP_T1, 1, 2"), 40)
    return Problem(bodies_deck([(lip, RUBBER), (shaft, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


def plug(draw: Draw, options: str) -> Problem:
    """A rubber plug is driven into a bore that is narrower, over the chamfer of the bore."""
    over, mu = draw(0.15, 0.05, 0.2), draw(0.2, 0.0, 0.4)
    rubber = grid("PLUG", between(0, 1, 6), between(0, 2, 14), place=lambda s, t: [s * (1 - 0.15 * np.clip(1 - t / 0.4, 0, 1)), t])
    rubber.surface("SIDE", lambda x: (x[:, 0] > 0.8) & (x[:, 1] < 1.99))
    bore = grid("BORE", [0, 0.4, 0.7, 1], between(-4, 0.3, 40),
                place=lambda s, t: [(1 - over + (over + 0.05) * np.clip((t + 1) / 1, 0, 1)) * (1 - s) + 2.0 * s, t])
    cards = pair("PLUG_SIDE", "BORE_S0", mu, options) + step(fix("BORE_S1, 1, 2", "PLUG_S0, 1", "PLUG_T1, 2, 2, -2.8"), 30)
    return Problem(bodies_deck([(rubber, RUBBER), (bore, STEEL)], "CAX4", cards), mu, (np.nan, 0.0))


def flattened_lip(draw: Draw, options: str) -> Problem:
    """A rubber lip that leans is pressed flat by a plate on the base on which it stands."""
    thick, mu, lean, flat = draw(0.4, 0.3, 0.5), draw(0.3, 0.0, 0.6), draw(0.6, 0.4, 0.8), draw(0.45, 0.3, 0.5)
    lip = grid("LIP", between(-thick / 2, thick / 2, 3), between(0, 2.5, 15), place=lambda s, t: [s * np.cos(lean) + t * np.sin(lean), t * np.cos(lean) - s * np.sin(lean)])
    lip.surface("FREE", lambda x: x[:, 1] > 0.6)
    top = float(lip.nodes[:, 1].max()) + 0.01
    plate = grid("PLATE", between(-2, 6, 40), between(top, top + 1, 2))
    cards = pair("LIP_FREE", "PLATE_T0", mu, options) + step(fix("LIP_T0, 1, 2", "PLATE_T1, 1", f"PLATE_T1, 2, 2, {-flat * top:.6g}"), 20)
    return Problem(bodies_deck([(lip, RUBBER), (plate, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


def o_ring(draw: Draw, options: str) -> Problem:
    """A rubber O-ring is crushed in its groove between bottom, side and cover, then pressed against the side."""
    mu, crush, push = draw(0.2, 0.0, 0.4), draw(0.3, 0.15, 0.35), draw(0.3, 0.1, 0.4)
    ring = _annulus("RING", between(0.15, 1, 5), (0, 1), 48)
    bottom, cover = grid("BOTTOM", between(-3, 3, 36), between(-1, 0, 2)), grid("COVER", between(-3, 3, 37), between(2, 3, 2))
    side = grid("SIDE", between(1.05, 2, 2), between(-0.05, 1.3, 9))
    cards = pair("RING_T0", "BOTTOM_T1", mu, options) + pair("RING_T0", "COVER_T0", mu, options) + pair("RING_T0", "SIDE_S0", mu, options)
    held = fix("BOTTOM_T0, 1, 2", "SIDE_S1, 2", "COVER_T1, 1")
    cards += step(held + fix("SIDE_S1, 1", f"COVER_T1, 2, 2, {-2 * crush:.6g}"), 10) + step(fix(f"SIDE_S1, 1, 1, {-push:.6g}"), 10)
    return Problem(bodies_deck([(ring, RUBBER), (bottom, STEEL), (cover, STEEL), (side, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


# ------------------------------------------------------------------------------------------------------------- g: whole exteriors


def pin_in_bore(kind: str, draw: Draw, options: str) -> Problem:
    """A pin in the bore of a lug; both whole exteriors are the pair."""
    play, mu, off = draw(0.02, 0.005, 0.05), draw(0.15, 0.0, 0.4), draw(0.08, 0.04, 0.15)
    pin, lug = _annulus("PIN", between(0.3, 1, 4), (0, 0), 40), _annulus("LUG", [1 + play, 1.3, 1.7, 2.2], (0, 0), 44)
    if kind == "C3D8":
        pin, lug = _extruded(pin, between(-0.5, 1.0, 4)), _extruded(lug, between(0, 0.6, 2))
    rim, bore = "LUG_T0", "PIN_T1"
    cards = pair("PIN_ALL", "LUG_ALL", mu, options) + step(fix(f"{rim}, 1, {pin.dimension}", f"{bore}, 2, {pin.dimension}", f"{bore}, 1, 1, {off:.6g}"), 5)
    return Problem(bodies_deck([(pin, STEEL), (lug, SOFT)], kind, cards), mu, (0.0,) * pin.dimension)


def _extruded(body: Body, z: Floats) -> Body:
    """Layers of cubes over a plane body; W0 and W1 are its ends."""
    n, e, m = len(body.nodes), len(body.elements), len(z) - 1
    nodes = np.concatenate([np.column_stack([body.nodes, np.full(n, height)]) for height in z])
    elements = np.concatenate([np.column_stack([body.elements + k * n, body.elements + (k + 1) * n]) for k in range(m)])
    turned = {1: 3, 2: 4, 3: 5, 4: 6}
    sides = {name: [(element + k * e, turned[face]) for k in range(m) for element, face in faces] for name, faces in body.sides.items()}
    sides |= {"W0": [(i, 1) for i in range(e)], "W1": [(i + (m - 1) * e, 2) for i in range(e)]}
    return Body(body.name, nodes, elements, sides)


def thin_plates(kind: str, draw: Draw, options: str) -> Problem:
    """A thin plate is bent onto another, whole exterior on whole exterior."""
    thick, mu, deep = draw(0.1, 0.05, 0.2), draw(0.2, 0.0, 0.4), draw(0.5, 0.2, 0.8)
    gap = draw(0.02, 0.005, 0.06)
    width = [between(0, 1, 3)] if kind == "C3D8" else []
    other = [between(-0.1, 1.1, 4)] if kind == "C3D8" else []
    upper = grid("UPPER", between(0, 4, 24), *width, between(gap, gap + thick, 1))
    lower = grid("LOWER", between(0, 4.2, 21), *other, between(-thick, 0, 1))
    last = 3 if kind == "C3D8" else 2
    cards = pair("UPPER_ALL", "LOWER_ALL", mu, options) + step(fix(f"LOWER_S0, 1, {last}", f"UPPER_S0, 1, {last}", f"UPPER_S1, {last}, {last}, {-deep:.6g}"), 10)
    return Problem(bodies_deck([(upper, STEEL), (lower, STEEL)], kind, cards), mu, (0.0,) * last)


def knuckle(draw: Draw, options: str) -> Problem:
    """A fork, a tongue between its arms and a pin through all of them: whole exteriors in three pairs."""
    play, mu, pull = draw(0.02, 0.01, 0.04), draw(0.15, 0.0, 0.3), draw(0.1, 0.06, 0.15)
    ring = _annulus("X", [1 + play, 1.4, 2.0], (0, 0), 32)
    pin = _extruded(_annulus("PIN", between(0.3, 1, 3), (0, 0), 28), between(-1.4, 1.4, 7))
    tongue = _extruded(ring, between(-0.4, 0.4, 2))
    arms = [_extruded(ring, between(low, low + 0.5, 2)) for low in (-0.4 - play - 0.5, 0.4 + play)]
    tongue.name, arms[0].name, arms[1].name = "TONGUE", "ARM1", "ARM2"
    cards = pair("PIN_ALL", "TONGUE_ALL", mu, options) + "".join(pair("PIN_ALL", f"ARM{i}_ALL", mu, options) for i in (1, 2))
    cards += "".join(pair("TONGUE_ALL", f"ARM{i}_ALL", mu, options).replace("ON_", "TONGUE_ON_") for i in (1, 2))
    held = fix("ARM1_T0, 1, 3", "ARM2_T0, 1, 3", "TONGUE_T0, 2, 3", f"TONGUE_T0, 1, 1, {pull:.6g}", "PIN_W0, 3")
    deck = bodies_deck([(pin, STEEL), (tongue, SOFT), *((arm, SOFT) for arm in arms)], "C3D8", cards + step(held, 5))
    return Problem(deck, mu, (0.0, 0.0, 0.0))


def block_on_block(draw: Draw, options: str) -> Problem:
    """A block is pressed on a block and drawn, whole exterior on whole exterior."""
    mu, depth, drag = draw(0.3, 0.05, 0.6), draw(0.01, 0.002, 0.02), draw(0.6, 0.2, 1.0)
    body = grid("BODY", between(0, 1, 5), between(0, 1, 5), between(0.005, 0.5, 3))
    table = grid("TABLE", between(-0.5, 2.3, 9), between(-0.5, 1.5, 7), between(-1, 0, 3))
    cards = pair("BODY_ALL", "TABLE_ALL", mu, options) + step(fix("TABLE_W0, 1, 3", "BODY_W1, 1, 2", f"BODY_W1, 3, 3, {-0.005 - depth:.6g}"), 4)
    return Problem(bodies_deck([(body, STEEL), (table, SOFT)], "C3D8", cards + step(fix(f"BODY_W1, 1, 1, {drag:.6g}"), 10)), mu, (0.0, 0.0, 0.0))


def ring_on_mandrel(draw: Draw, options: str) -> Problem:
    """A ring with play on a mandrel is pulled off the centre: whole exteriors of two sheets."""
    play, mu, pull = draw(0.05, 0.02, 0.1), draw(0.2, 0.0, 0.4), draw(0.6, 0.3, 0.8)
    mandrel, ring = _annulus("MANDREL", [1.6, 1.8, 2.0], (0, 0), 48), _annulus("RING", [2 + play, 2.1 + play, 2.2 + play], (0, 0), 52)
    ring.select("HOOK", lambda x: x[:, 0] > x[:, 0].max() - 1e-6)
    cards = pair("RING_ALL", "MANDREL_ALL", mu, options) + step(fix("MANDREL_T1, 1, 2", "RING_HOOK, 2", f"RING_HOOK, 1, 1, {pull:.6g}"), 10)
    return Problem(bodies_deck([(ring, STEEL), (mandrel, STEEL)], "CPE4", cards), mu, (0.0, 0.0))


Build = Callable[[Draw, str], Problem]


def problems() -> dict[str, dict[str, Build]]:
    """All problems by class and name."""
    return {
        "a": {"stack of 8": lambda d, o: stack_of(8, 0.01, d, o), "stack of 25": lambda d, o: stack_of(25, 0.1, d, o),
              "stack of 40": lambda d, o: stack_of(40, 0.02, d, o), "wall 3 x 3": lambda d, o: wall_of(3, d, o), "wall 4 x 4": lambda d, o: wall_of(4, d, o),
              "falling block": falling_block, "tower in space": tower},
        "b": {f"{shape}, {'slab' if soft else 'indenter'} soft, {n} facets": lambda d, o, a=(shape, soft, n): ironing(*a, d, o)
              for shape, soft, n in (("curved", False, 1), ("curved", False, 2), ("curved", True, 1), ("curved", True, 2), ("flat", False, 1), ("flat", True, 1))},
        "c": {"clip, 4 elements, mu 0.2": lambda d, o: clip(4, "CPE4", 0.2, d, o), "clip, 8 elements, mu 0.2": lambda d, o: clip(8, "CPE4", 0.2, d, o),
              "clip, 4 elements, mu 0.5": lambda d, o: clip(4, "CPE4", 0.5, d, o), "clip, 8 elements, mu 0.5": lambda d, o: clip(8, "CPE4", 0.5, d, o),
              "clip in space, mu 0.2": lambda d, o: clip(4, "C3D8", 0.2, d, o),
              "crushed ring": crushed_ring, "ball in groove": lambda d, o: ball_in_groove(6, d, o), "two rollers": lambda d, o: rollers(2, d, o), "saddle": saddle},
        "d": {"two rings": rings_on_each_other, "arch, moved stamp": lambda d, o: stamped_arch(False, d, o),
              "arch, pressed stamp": lambda d, o: stamped_arch(True, d, o), "bushing": bushing, "strut in channel": strut_in_channel},
        "e": {"belt": belt, "ball in groove, fine": lambda d, o: ball_in_groove(9, d, o), "five rollers": lambda d, o: rollers(5, d, o),
              "pressed plates": pressed_plates, "leaf spring": leaf_spring},
        "f": {"wiper": wiper, "shaft seal": shaft_seal, "plug": plug, "flattened lip": flattened_lip, "O-ring": o_ring},
        "g": {"pin in bore": lambda d, o: pin_in_bore("CPE4", d, o), "pin in bore, space": lambda d, o: pin_in_bore("C3D8", d, o),
              "thin plates": lambda d, o: thin_plates("CPE4", d, o), "thin plates, space": lambda d, o: thin_plates("C3D8", d, o), "knuckle": knuckle,
              "block on block": block_on_block, "ring on mandrel": ring_on_mandrel},
    }
