"""Frictionless contact of curved bodies: Hertz, and the first benchmark of NAFEMS R0094.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.proof import Case, Job, observed_order
from verify.conftest import ROOT
from verify.decks.make_decks import Mesh, graded, hertz_deck, join
from verify.decks.sheets import Floats, fix, pair, plane_deck, rows_of, sheet, step
from verify.independent.deck import read_deck

Proof = Callable[..., Case]


def arc(radius: float, half: float, height: float, fine: float, n_fine: int, n_growing: int) -> Mesh:
    """The right half of a cylinder's lower part: an arc with its pole in the origin, straight columns, a flat top."""
    s = graded(half, fine, n_fine, n_growing)
    t = graded(1.0, fine / height, 4, n_growing)

    def place(x: Floats, w: Floats) -> tuple[Floats, Floats]:
        bottom = radius - np.sqrt(radius**2 - x**2)
        return x, bottom * (1 - w) + height * w

    return sheet("CYLINDER", s, t, place)


def slab(half: float, height: float, fine: float, n_fine: int, n_growing: int) -> Mesh:
    """The right half of a block below z = 0."""
    return sheet("BLOCK", graded(half, fine, n_fine, n_growing), -graded(height, fine, 4, n_growing)[::-1])


def fitted(x: Floats, p: Floats) -> tuple[float, float]:
    """Half width and peak of the ellipse p^2 = p0^2 (1 - x^2/a^2) through the pressures above 0.4 of the largest."""
    inside = p > 0.4 * p.max()
    slope, square = np.polyfit(x[inside] ** 2, p[inside] ** 2, 1)
    return float(np.sqrt(-square / slope)), float(np.sqrt(square))


def test_nafems_r0094_1(proof: Proof) -> None:
    """Cylinder of steel on a block of aluminium, 35 kN per mm, without and with friction."""
    radius, force = 50.0, 35000.0
    modulus = 1 / ((1 - 0.3**2) / 210000 + (1 - 0.3**2) / 70000)
    a = np.sqrt(4 * force * radius / (np.pi * modulus))
    p0 = np.sqrt(force * modulus / (np.pi * radius))
    case = proof(
        "nafems-r0094-1",
        title="Cylinder on a block: NAFEMS R0094 benchmark 1, Hertz in the plane",
        model="Half of a cylinder's lower part (R = 50 mm, E = 210000 MPa, columns up to x = 40 mm, flat top at its centre) on half "
        "of a block 200 x 200 mm (E = 70000 MPa), nu = 0.3, plane strain, one layer of C3D8; elements of a/5 and a/10 at the contact, slave: "
        "the cylinder. Bottom of the block fixed. The cylinder's top is pushed by a uniform pressure, in all F = 35 kN per mm of "
        "thickness, in 10 increments, small displacements; mu = 0 and 0.1.",
        formula="a = sqrt(4 F R/(pi E\\*)), p0 = sqrt(F E\\*/(pi R)), p = p0 sqrt(1 - x^2/a^2), 1/E\\* = sum (1 - nu^2)/E: "
        f"a = {a:.4f} mm, p0 = {p0:.1f} MPa. The displacement of the middle of the block's top is compared with the same block "
        "under Hertz's pressure, without contact. (code_aster SSNP154 prints -1.3069 mm for mu = 0 and 0.44 % less for mu = 0.1. "
        "The first number is not that of a block with a fixed bottom: Hertz's pressure gives -1.281 mm on fine meshes.)",
        source="Hertz (1882); Konter, Advanced finite element contact benchmarks, NAFEMS R0094 (2006); code_aster SSNP154",
        proves="Normal contact of curved bodies of different materials, driven by a force from one touching node to twenty. "
        "a/R = 0.12, so Hertz himself is 1 to 2 % off.",
    )
    jobs = {mu: case.run(r0094_1(force, mu), f"mu={mu:g}", requested=10) for mu in (0.0, 0.1)}
    mesh = join(list(r0094_parts()))
    slaves, middle = rows_of(mesh, "CYLINDER_BOTTOM"), rows_of(mesh, "BLOCK_TOP")[0]
    x, p = jobs[0.0].points[slaves, 0], jobs[0.0].last("CPRESS")[slaves]
    found_a, found_p0 = fitted(x, p)
    case.near("peak pressure p0", found_p0, p0, 0.03, why="Hertz is 1 to 2 % off at a/R = 0.12", place="x = 0", time="the end")
    coarse = case.run(r0094_1(force, 0.0, 1.2), "elements of a/5", requested=10)
    lines = rows_of(join(list(r0094_parts(1.2))), "CYLINDER_BOTTOM")
    errors = [abs(fitted(coarse.points[lines, 0], coarse.last("CPRESS")[lines])[0] / a - 1), abs(found_a / a - 1)]
    case.near("half width a", found_a, a, 0.03, why="as p0", place="x = a", time="the end", order=f"{observed_order(errors):.1f}")
    case.within("observed order", observed_order(errors), (0.75, 2.5), why="the edge is known to a part of an element; Hertz is 1 % off",
                place="x = a", time="the end")  # fmt: skip
    case.near("edge of contact", x[p > 0].max(), a, 0.6 / a, why="one element", place="x = a", time="the end")
    inner = x < 0.9 * a
    expected = p0 * np.sqrt(1 - (x[inner] / a) ** 2)
    case.near("pressure", p[inner], expected, 0.03, why="as p0", place="x < 0.9 a", time="the end")
    uz = {mu: float(job.last("U")[middle, 2]) for mu, job in jobs.items()}
    alone = case.run(block_under_hertz(a, p0), "Hertz's pressure").last("U")[rows_of(r0094_parts()[1], "BLOCK_TOP")[0], 2]
    case.near("uz", uz[0.0], alone, 0.005, why="a fifth of the error of Hertz", place="top of block", time="the end")
    case.near("uz with over without friction", uz[0.1] / uz[0.0], 1.3011 / 1.3069, 0.005, why="as published", place="top of block", time="the end")
    case.figure(lambda: pressures(x, p, a, p0), "Contact pressure against Hertz.")
    case.done()


def r0094_parts(fine: float = 0.6) -> tuple[Mesh, Mesh]:
    """Cylinder and block; the lines of both meshes meet at the contact."""
    n = round(9.6 / fine)
    return arc(50.0, 40.0, 50.0, fine, n, 14), slab(100.0, 200.0, fine, n, 14)


def r0094_1(force: float, mu: float, fine: float = 0.6) -> str:
    """The deck."""
    cylinder, block = r0094_parts(fine)
    load = f"*DLOAD\nCYLINDER_TOP, P, {force / 2 / 40:.15g}\n"
    supports = fix("BLOCK_BOTTOM, 1, 3", "CYLINDER_LEFT, 1", "BLOCK_LEFT, 1")
    parts = [(cylinder, (210000, 0.3)), (block, (70000, 0.3))]
    return plane_deck(parts, pair("CYLINDER_BOTTOM", "BLOCK_TOP", mu), step(supports + load, 10))


def block_under_hertz(a: float, p0: float) -> str:
    """The block alone under forces that add up to the ellipse."""
    block = r0094_parts()[1]
    cards = "*CLOAD\n"
    for layer in (0.0, 1.0):
        nodes = rows_of(block, "BLOCK_TOP", layer)
        x = block.nodes[nodes, 0]
        ends = np.minimum(np.concatenate([[0], (x[1:] + x[:-1]) / 2, [x[-1]]]), a)
        below = p0 / 2 * (ends * np.sqrt(1 - (ends / a) ** 2) + a * np.arcsin(ends / a))
        shares = np.diff(below) / 2
        cards += "".join(f"{n + 1}, 3, {-f:.15g}\n" for n, f in zip(nodes, shares, strict=True) if f > 0)
    return plane_deck([(block, (70000, 0.3))], "", step(fix("BLOCK_BOTTOM, 1, 3", "BLOCK_LEFT, 1") + cards, 1))


@pytest.mark.slow
def test_hertz_point(proof: Proof) -> None:
    """input/hertz_octant.inp: a ball on a rigid flat, and the same on elements twice as large."""
    radius, modulus = 50.0, 20000 / (1 - 0.3**2)
    case = proof(
        "hertz-point",
        title="Ball on a rigid flat: Hertz",
        model="input/hertz_octant.inp: by symmetry one octant of an elastic ball (R = 50, E = 20000, nu = 0.3) on a fixed plate; the "
        "equator goes down by 0.5 in 5 increments, small displacements. C3D8, elements of 1.5 and 0.75 at the contact.",
        formula="With P the force found: a = (3 P R/(4 E\\*))^(1/3), p0 = 3 P/(2 pi a^2), p = p0 sqrt(1 - r^2/a^2), "
        "E\\* = E/(1 - nu^2). The equator is not far away, so P is up to 10 % above 4/3 E\\* sqrt(R) d^(3/2).",
        source="Hertz (1882)",
        proves="Contact of a doubly curved face, in three dimensions.",
    )
    coarse = ball_pressures(case.run(hertz_deck(1.5), "elements of 1.5", requested=5), hertz_deck(1.5), radius, modulus)
    text = (ROOT / "input" / "hertz_octant.inp").read_text()
    r, p, force, a, p0 = ball_pressures(case.run(text, "elements of 0.75", requested=5), text, radius, modulus)
    case.within("P over Hertz's", force / (4 / 3 * modulus * np.sqrt(radius) * 0.5**1.5), (1.0, 1.1), why="the equator is near",
                place="equator", time="the end")  # fmt: skip
    inner = r < 0.5 * a
    expected = p0 * np.sqrt(1 - (r[inner] / a) ** 2)
    case.near("pressure", p[inner], expected, 0.01, why="elements of a/7", place="r < a/2", scale=p0, time="the end")
    case.near("edge of contact", r[p > 0].max(), a, 0.75 / a, why="one element", place="r = a", time="the end")
    case.near("edge of contact", coarse[0][coarse[1] > 0].max(), coarse[3], 1.5 / coarse[3], why="one element", place="r = a",
              time="elements of 1.5")  # fmt: skip
    errors = [mean_error(*coarse), mean_error(r, p, force, a, p0)]
    order = observed_order(errors)
    case.near("pressure, mean error over p0", errors[1], 0.0, 0.01, why="elements of a/7", place="r < 0.9 a", time="the end", scale=1.0,
              order=f"{order:.1f}")  # fmt: skip
    case.within("observed order", order, (1.5, 3.0), why="second order in the mean where the pressure is smooth; Hertz is exact for small a/R alone",
                place="r < 0.9 a", time="the end")  # fmt: skip
    case.figure(lambda: pressures(r, p, a, p0), "Contact pressure at all slave nodes against Hertz.")
    case.done()


def ball_pressures(job: Job, text: str, radius: float, modulus: float) -> tuple[Floats, Floats, float, float, float]:
    """Radius and pressure of the slave nodes, the force found on the whole ball, Hertz's a and p0 for it."""
    deck = read_deck(text, ROOT / "input")
    force = -4 * float(job.last("RF")[deck.node_sets["BALL_EQUATOR"], 2].sum())
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    slaves = deck.surface_nodes(deck.pairs[0].slave)
    return np.linalg.norm(deck.nodes[slaves, :2], axis=1), job.last("CPRESS")[slaves], force, a, 3 * force / (2 * np.pi * a**2)


def mean_error(r: Floats, p: Floats, _: float, a: float, p0: float) -> float:
    """Root of the mean square of the error of the pressure over p0, for r < 0.9 a."""
    inner = r < 0.9 * a
    return float(np.sqrt(np.mean((p[inner] - p0 * np.sqrt(1 - (r[inner] / a) ** 2)) ** 2)) / p0)


def pressures(x: Floats, p: Floats, a: float, p0: float) -> object:
    """Found pressures over the ellipse."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.5))
    axes = figure.subplots()
    line = np.linspace(0, a, 200)
    axes.plot(line, p0 * np.sqrt(1 - (line / a) ** 2), "k-", label="Hertz")
    near = x < 1.3 * a
    axes.plot(x[near], p[near], "o", ms=4, label="Amontons")
    axes.set(xlabel="distance from the middle", ylabel="contact pressure")
    axes.legend()
    return figure
