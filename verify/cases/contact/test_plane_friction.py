"""Friction in the plane and about an axis: a slope, a fit pulled out, a slab that is drawn, the punch of NAFEMS R0094.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.contact.test_sliding import DENSITY, GRAVITY, SLOPE, SOFT
from verify.cases.proof import Case, Job, observed_order
from verify.conftest import Run
from verify.decks.make_decks import graded
from verify.decks.planes import flat_deck, flatten, join_planes
from verify.decks.sheets import Floats, between, fix, pair, plane_deck, rows_of, sheet, step

Proof = Callable[..., Case]

# ------------------------------------------------------------------------------------------ block on a slope


def slope_deck(mu: float, with_spring: bool) -> str:
    """A block 2 x 1 on a table, gravity leans by SLOPE; the spring is a soft sheet from its back to a wall."""
    body, table = flatten(sheet("BODY", between(0, 2, 4), between(0, 1, 2))), flatten(sheet("TABLE", between(-3, 4, 1), [-1.0, 0.0]))
    parts = [(body, (1e9, 0.0)), (table, (1e9, 0.0))]
    ties, supports = "", ["TABLE_TOP, 1, 2", "TABLE_BOTTOM, 1, 2"]
    if with_spring:
        spring = flatten(sheet("SPRING", [-1.0, 0.0], between(0, 1, 2)))
        parts.append((spring, (SOFT, 0.0)))
        n = len(body.nodes) + len(table.nodes)
        rows = zip(body.node_sets["BODY_LEFT"], spring.node_sets["SPRING_RIGHT"] + n, strict=True)
        ties = "".join(f"*EQUATION\n2\n{s + 1}, {d}, 1., {b + 1}, {d}, -1.\n" for b, s in rows for d in (1, 2))
        supports.append("SPRING_LEFT, 1, 2")
    load = f"*DLOAD\nBODY, GRAV, {GRAVITY}, {np.sin(SLOPE):.15g}, {-np.cos(SLOPE):.15g}, 0.\n"
    cards = ties + pair("BODY_BOTTOM", "TABLE_TOP", mu) + step(fix(*supports) + load, 5)
    return flat_deck(parts, "CPE4", cards).replace("*SOLID SECTION", f"*DENSITY\n{DENSITY}\n*SOLID SECTION", 1)


def test_block_on_a_slope(proof: Proof, run: Run, tmp_path: Path) -> None:
    """Below the critical angle it sticks; above it a spring lets it slip by what statics says, and without one it goes."""
    case = proof(
        "slope-plane",
        title="Block on an inclined plane by CPE4",
        model="A stiff block 2 x 1 (E = 1e9, density 1, 4 x 2 CPE4 of thickness 1) on a fixed table; gravity 9.81 leans by 20 degrees, in 5 "
        "increments, small displacements. mu = 1.0001 tan 20: alone. mu = 0.8 tan 20: with a weightless sheet 1 x 1 of E = 50 between its back and a "
        "wall, in which it hangs with k = 50; and alone.",
        formula="Sticks if mu > tan 20. Else slip = W (sin 20 - mu cos 20)/k with the spring, and no equilibrium without it.",
        source="Coulomb (1785); Ansys VM29; code_aster SSNV503",
        proves="The limit of friction in the plane, exactly; and that an unsupported sliding body is reported, not computed.",
    )
    weight = 2 * DENSITY * GRAVITY
    stuck = case.run(slope_deck(1.0001 * np.tan(SLOPE), False), "sticks", requested=5)
    far = float(np.abs(stuck.last("U")).max())
    case.within("largest displacement", far, (0.0, 1e-6), why="only elastic: W/(G A) = 2e-8 (near its limit some nodes may slip so far)",
                place="all nodes", time="the end, 20 degrees")  # fmt: skip
    total = (stuck.last("CSHEARF") + stuck.last("CNORMF")).sum(axis=0)[:2]
    case.near("contact force", total, weight * np.array([-np.sin(SLOPE), np.cos(SLOPE)]), 1e-6, why="equilibrium",
              place="all slave nodes", time="the end")  # fmt: skip
    mu = 0.8 * np.tan(SLOPE)
    hung = case.run(slope_deck(mu, True), "with a spring", requested=5)
    slip = weight * (np.sin(SLOPE) - mu * np.cos(SLOPE)) / SOFT
    touching = np.abs(hung.last("CNORMF")[:, 1]) > 0
    case.near("slip", hung.last("U")[touching, 0], slip, 1e-5, why="the block itself is 2e7 times as stiff as the spring",
              place="all slave nodes", time="the end")  # fmt: skip
    case.near("friction", hung.last("CSHEARF")[:, 0].sum(), -mu * weight * np.cos(SLOPE), 1e-5, why="mu N", place="all slave nodes", time="the end")
    (tmp_path / "gone.inp").write_text(slope_deck(mu, False))
    done = run(["gone"], cwd=tmp_path)
    case.true("exit code 5 alone", done.returncode == 5, why="the block has no support", place="the job without a spring", time="the end")
    case.true("and it says FREE BODY", "FREE BODY" in done.stdout, why="a clear reason", place="the job without a spring", time="the end")
    case.done()


# ------------------------------------------------------------------------------------------ a fit is pulled out


def test_pull_out(proof: Proof) -> None:
    """Two rings with interference by CAX4, then the inner one is pulled out of the outer one."""
    young, d, mu, length = 206e9, 0.002, 0.1, 0.5
    ri, rm, ro = 1.25, 1.516, 1.75
    ru = rm + d
    p = young * d / (rm * (ro**2 + rm**2) / (ro**2 - rm**2) + rm * (ru**2 + ri**2) / (ru**2 - ri**2))
    case = proof(
        "shrink-fit-pull-out-axisymmetric",
        title="Shrink fit with pull-out, axisymmetric: Lame",
        model="Two rings, radii 1.25, 1.516 and 1.75 m, 0.5 m long, E = 206 GPa, nu = 0, mu = 0.1, CAX4, 4 along, 3 and 6 through each; the inner one is 2 mm "
        "too large. Step 1 establishes contact (1 increment), step 2 pulls the inner face of the inner ring by 20 mm along the axis (10 increments), small "
        "displacements.",
        formula=f"Lame with the rings' own radii: p = {p:.5g} Pa; pull-out force mu p 2 pi R L = {mu * p * 2 * np.pi * rm * length:.5g} N.",
        source="Lame (1852)",
        proves="Sliding along the axis: friction of the full circle, at the limit to the tolerance of Newton's method.",
    )
    supports = fix("INNER_LEFT, 2", "OUTER_RIGHT, 2")
    steps = step(supports, 1) + step(fix("INNER_LEFT, 2, 2, 0.02"), 10)
    area, errors = 2 * np.pi * rm * length, []
    for cells in (3, 6):
        inner = flatten(sheet("INNER", between(ri, ru, cells), between(0, length, 4)))
        outer = flatten(sheet("OUTER", between(rm, ro, cells), between(0, length, 4)))
        deck = flat_deck([(inner, (young, 0.0)), (outer, (young, 0.0))], "CAX4", pair("INNER_RIGHT", "OUTER_LEFT", mu) + steps)
        job = case.run(deck, f"{cells} elements", requested=11)
        slaves = inner.node_sets["INNER_RIGHT"]
        normal = np.linalg.norm(job.field("CNORMF")[:, slaves], axis=2).sum(axis=1)
        errors.append(abs(normal[job.frame(1.0)] / (area * p) - 1))
    case.near("mean pressure", normal[job.frame(1.0)] / area, p, 0.005, why="six elements through each ring", time="1", place="all slave nodes",
              order=f"{observed_order(errors):.1f}")  # fmt: skip
    pull = job.last("RF")[inner.node_sets["INNER_LEFT"], 1].sum()
    case.near("pull-out force over mu N", pull / (mu * normal[-1]), 1.0, 1e-5, why="all of it slides", time="2", place="all slave nodes")
    case.near("pull-out force", pull, mu * p * area, 0.01, why="the shear bends the walls a little", time="2", place="pulled end")
    case.done()


# ------------------------------------------------------------------------------------------ a slab is drawn over a plane

#: x, pressure and shear of the base by CalculiX 2.20 (node to surface, penalty 1e5), 20 x 10 C3D8 in plane strain. Its
#: surface-to-surface contact agrees within 1 % for 0.6 <= x <= 3.2; the ends are singular and are left out.
SLAB = np.array([[1.0, 173.8, -3.6], [2.0, 171.9, 25.0], [3.0, 186.1, 56.6]])


@pytest.mark.parametrize("kind", ["CPE4", "C3D8"])
def test_drawn_slab(proof: Proof, kind: str) -> None:
    """Oden and Pires: a slab on a rigid plane, pressed from above and drawn at one side."""
    case = proof(
        f"drawn-slab-{kind.lower()}",
        title=f"Elastic block with zones of stick and slip: Oden and Pires, {kind}",
        model="A slab 4 x 2 (E = 1000, nu = 0.3, plane strain, 20 x 10 " + kind + (", one layer held across the plane" if kind == "C3D8" else "")
        + ") on a rigid plane, mu = 0.5; 200 on its top, then 60 as a pull on its right side; 5 increments each, small displacements.",
        formula="All of the pull goes into friction: -120 and 800 on the base. It slips at the right end only, where the lifted edge is drawn; the "
        "friction changes its sign near x = 1.1, because Poisson's ratio drives the left end outwards.",
        source="Oden and Pires, J. Appl. Mech. 50 (1983) 67, for the problem; numbers: CalculiX 2.20 on the same mesh, by a penalty",
        proves="Stick and slip side by side below an elastic block, with friction in both directions.",
    )  # fmt: skip
    slab, plane = sheet("SLAB", between(0, 4, 20), between(0, 2, 10)), sheet("PLANE_BODY", between(-1, 6, 1), [-1.0, 0.0])
    y = 2 if kind == "CPE4" else 3
    still = fix(f"PLANE_BODY_TOP, 1, {y}", f"PLANE_BODY_BOTTOM, 1, {y}")
    steps = step(still + "*DSLOAD\nSLAB_TOP, P, 200.\n", 5) + step("*DSLOAD\nSLAB_RIGHT, P, -60.\n", 5)
    cards = pair("SLAB_BOTTOM", "PLANE_BODY_TOP", 0.5)
    materials = (1000.0, 0.3), (1e6, 0.3)
    if kind == "CPE4":
        parts = [(flatten(part), m) for part, m in zip((slab, plane), materials, strict=True)]
        slaves, share = parts[0][0].along("SLAB_BOTTOM"), 1.0
        job = case.run(flat_deck(parts, kind, cards + steps), requested=10)
    else:
        slaves, share = rows_of(slab, "SLAB_BOTTOM"), 0.5
        job = case.run(plane_deck(list(zip((slab, plane), materials, strict=True)), cards, steps), requested=10)
    x = job.points[slaves, 0]
    p, q = job.last("CPRESS")[slaves], job.last("CSHEARF")[slaves, 0] / np.abs(job.last("CNORMF")[slaves, y - 1])
    q *= p
    force = (job.last("CSHEARF") + job.last("CNORMF"))[slaves].sum(axis=0) / share
    case.near("force on the base", force[[0, y - 1]], [-120.0, 800.0], 1e-6, why="equilibrium", place="base", time="the end")
    case.near("pressure", np.interp(SLAB[:, 0], x, p), SLAB[:, 1], 0.02, why="the penalty sinks by 0.2 %; printed digits", place="x = 1, 2, 3",
              time="the end")  # fmt: skip
    why = "as the pressure, of which it is a part"
    case.near("shear", np.abs(np.interp(SLAB[:, 0], x, q) + SLAB[:, 2]).max() / SLAB[0, 1], 0.0, 0.02, why=why, place="x = 1, 2, 3", scale=1.0,
              time="the end")  # fmt: skip
    status = job.last("CSTATUS")[slaves]
    case.within("the least x that slips", float(x[status == 2].min(initial=4.0)), (3.7, 4.0), why="as there, to an element and a half",
                place="base", time="the end")  # fmt: skip
    inner = (x > 0.5) & (x < 2)
    case.near("where the friction turns", np.interp(0, -q[inner], x[inner]), 1.1, 0.1, why="half an element", scale=1.0, place="base", time="the end")
    case.figure(lambda: slab_figure(x, p, q), "Pressure and friction along the base; crosses: CalculiX.")
    case.done()


def slab_figure(x: Floats, p: Floats, q: Floats) -> object:
    """Along the base."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.4))
    axes = figure.subplots()
    axes.plot(x, p, "o-", ms=3, lw=0.8, label="pressure")
    axes.plot(x, -q, "s-", ms=3, lw=0.8, label="friction")
    axes.plot(SLAB[:, 0], SLAB[:, 1], "kx", SLAB[:, 0], SLAB[:, 2], "kx")
    axes.set(xlabel="x", ylim=(-150, 320))
    axes.legend()
    return figure


# ------------------------------------------------------------------------------------------ a punch with rounded edges

#: r, uz and ur of the foundation's surface [mm] with mu = 0.1 (Marc, quadratic elements), and ur with mu = 0.
PUNCH = np.array([[0, -0.1308, 0.0, 0.0], [10, -0.1310, 0.00025, -0.0020], [20, -0.1302, 0.0001, -0.0042],
                  [30, -0.1294, -0.0017, -0.0072], [50, -0.0813, -0.0108, -0.0134]])  # fmt: skip


def rounded_punch(mu: float) -> tuple[str, Floats]:
    """The punch with its fillet, slave, on the foundation; the nodes of the foundation's surface come back."""
    fine = np.concatenate([between(0, 36, 18), 36 + between(0, 6, 12)[1:]])

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        bottom = np.where(s > 40, 10 - np.sqrt(np.maximum(100 - (s - 40) ** 2, 0)), 0.0)
        return s, bottom * (1 - t) + 100 * t

    punch = flatten(sheet("PUNCH", np.concatenate([fine, [43, 44, 45.5, 47, 48.5, 50]]), graded(1.0, 0.01, 4, 12), place))
    outside = 42 + graded(58.0, 1.0, 8, 10)[1:]
    ground = flatten(sheet("GROUND", np.concatenate([fine, outside]), -graded(200.0, 1.0, 6, 14)[::-1]))
    load = "*DSLOAD\nPUNCH_TOP, P, 100.\n"
    cards = pair("PUNCH_BOTTOM", "GROUND_TOP", mu) + step(fix("GROUND_BOTTOM, 1, 2", "GROUND_LEFT, 1", "PUNCH_LEFT, 1") + load, 10)
    parts = [(punch, (210000.0, 0.3)), (ground, (70000.0, 0.3))]
    return flat_deck(parts, "CAX4", cards), join_planes([punch, ground]).along("GROUND_TOP")


def test_rounded_punch(proof: Proof) -> None:
    """NAFEMS R0094 benchmark 2: what friction does to the foundation below a punch."""
    case = proof(
        "nafems-r0094-2",
        title="Punch with rounded edges: NAFEMS R0094 benchmark 2",
        model="A steel punch (diameter and height 100 mm, edge rounded by 10 mm, E = 210 GPa) on an aluminium foundation (diameter and height 200 mm, E = 70 "
        "GPa, bottom held), nu = 0.3, CAX4 of 0.5 mm at the edge; 100 MPa on the punch in 10 increments, small displacements; mu = 0.1 and 0.",
        formula="Displacements of the foundation's surface by Marc, read from the published curves: quadratic elements for mu = 0.1; those for mu = 0 "
        "are of linear ones, as their uz shows. Pressure on the axis by code_aster: 88.7 and 91.1 MPa. (The published curves of pressure say 70 "
        "there, and their peak at the edge depends on the mesh: not judged.)",
        source="NAFEMS R0094 (Konter 2006), benchmark 2",
        proves="Friction below a press: it drags the surface outwards, and the sign of the radial displacement near the axis turns with it.",
    )
    jobs: dict[float, Job] = {}
    for mu in (0.1, 0.0):
        deck, surface = rounded_punch(mu)
        job = jobs[mu] = case.run(deck, f"mu = {mu:g}", requested=10)
        r, u = job.points[surface, 0], job.last("U")[surface]
        column, near = 2 if mu else 3, np.isin(PUNCH[:, 0], [10, 30, 50])
        allowed, why = (5e-4, "read from curves") if mu else (8e-4, "read from curves; linear and quadratic elements differ by 3e-4 at mu = 0.1")
        found = np.interp(PUNCH[near, 0], r, u[:, 0])
        case.near("ur", found, PUNCH[near, column], allowed, why=why, place="r = 10, 30, 50", time=f"mu = {mu:g}", scale=1.0)
    u = jobs[0.1].last("U")[surface]
    case.near("uz", np.interp(PUNCH[:4, 0], r, u[:, 1]), PUNCH[:4, 1], 0.015, why="read from curves", place="r = 0 to 30", time="mu = 0.1")
    case.true("ur is outward with friction", np.interp(10, r, u[:, 0]) > 0, why="friction drags the surface outwards", place="r = 10", time="the end")
    pole = np.flatnonzero((jobs[0.1].last("CPRESS") > 0) & (jobs[0.1].points[:, 0] < 1e-9))
    p = float(jobs[0.1].last("CPRESS")[pole][0])
    case.within("pressure", p, (88.0, 92.0), why="between the two of code_aster, and 1 % for reading", place="r = 0", time="mu = 0.1")
    case.figure(lambda: punch_figure(r, {mu: job.last("U")[surface, 0] for mu, job in jobs.items()}), "Radial displacement of the foundation.")
    case.done()


def punch_figure(r: Floats, u: dict[float, Floats]) -> object:
    """Radial displacement with and without friction, and the published points."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.4))
    axes = figure.subplots()
    for mu, values in u.items():
        axes.plot(r, values, "-", lw=1, label=f"mu = {mu:g}")
    axes.plot(PUNCH[:, 0], PUNCH[:, 2], "kx", PUNCH[:, 0], PUNCH[:, 3], "k+")
    axes.set(xlabel="r [mm]", ylabel="ur [mm]", xlim=(0, 60))
    axes.legend()
    return figure
