"""Gross sliding: blocks, reversal, capstan, shrink fit with pull-out, ironing, and a stuck block that turns.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks.make_decks import Mesh, block, join, material_cards, mesh_cards
from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import Floats, between, fix, pair, plane_deck, sheet, solid_deck, step
from verify.study.contact_table import cylinder, drag

Proof = Callable[..., Case]

# ------------------------------------------------------------------------------------------ block on a slope

SLOPE = np.radians(20.0)
DENSITY, GRAVITY, SOFT = 1.0, 9.81, 50.0


def slope_deck(mu: float, with_spring: bool, n_increments: int = 5) -> str:
    """A block 2 x 1 x 1 on a table, gravity leans by SLOPE; the spring is one soft element from its back to a wall."""
    table = block(between(-3, 4, 1), between(-2, 3, 1), [-1.0, 0.0], "TABLE")
    body = block(between(0, 2, 4), between(0, 1, 2), between(0, 1, 2), "BODY")
    back = np.flatnonzero(body.nodes[:, 0] < 1e-9)
    parts = [body, table]
    if with_spring:
        spring = block([-1.0, 0.0], between(0, 1, 2), between(0, 1, 2), "SPRING")
        parts.append(spring)
    mesh = join(parts)
    n_spring = len(mesh.nodes) - (len(spring.nodes) if with_spring else 0)
    if with_spring:  # the spring's front nodes are the block's back nodes
        place = {tuple(np.round(x, 9)): int(n) for x, n in zip(body.nodes[back], back, strict=True)}
        for n in range(n_spring, len(mesh.nodes)):
            same = place.get(tuple(np.round(mesh.nodes[n], 9)))
            if same is not None:
                mesh.elements[mesh.elements == n] = same
        mesh.node_sets["WALL"] = n_spring + np.flatnonzero(spring.nodes[:, 0] < -1 + 1e-9)
    materials = material_cards("BODY", (1e9, 0.0), "BODY") + material_cards("TABLE", (1e9, 0.0), "TABLE")
    materials = materials.replace("*SOLID SECTION", f"*DENSITY\n{DENSITY}\n*SOLID SECTION", 1)
    supports = ["TABLE_TOP, 1, 3", "TABLE_BOTTOM, 1, 3"]
    if with_spring:
        materials += material_cards("SPRING", (SOFT, 0.0), "SPRING")
        supports += ["WALL, 1, 3"]
    load = f"*DLOAD\nBODY, GRAV, {GRAVITY}, {np.sin(SLOPE):.15g}, 0., {-np.cos(SLOPE):.15g}\n"
    cards = mesh_cards(mesh) + materials + pair("BODY_BOTTOM", "TABLE_TOP", mu)
    return _without_unused(cards, mesh) + step(fix(*supports) + load, n_increments)


def _without_unused(cards: str, mesh: Mesh) -> str:
    """Nodes that no element uses are left out of *NODE."""
    unused = set(range(len(mesh.nodes))) - set(mesh.elements.ravel().tolist())
    lines = cards.split("\n")
    first = lines.index("*NODE") + 1
    keep = [line for i, line in enumerate(lines[first : first + len(mesh.nodes)]) if i not in unused]
    return "\n".join(lines[:first] + keep + lines[first + len(mesh.nodes) :])


@pytest.mark.slow
def test_block_on_a_slope(proof: Proof, run: Run, tmp_path: Path) -> None:
    """Below the critical angle it sticks; above it a spring lets it slip by what statics says, and without one it goes."""
    case = proof(
        "slope",
        title="Block on an inclined plane",
        model="A stiff block 2 x 1 x 1 (E = 1e9, density 1, 4 x 2 x 2 C3D8) on a fixed table; gravity 9.81 leans by 20 degrees, in 5 "
        "increments, small displacements. mu = 1.0001 tan 20: alone. mu = 0.8 tan 20: with a weightless element 1 x 1 x 1 of E = 50 "
        "between its back and a wall, in which it hangs with k = 50; and alone.",
        formula="Sticks if mu > tan 20. Else slip = W (sin 20 - mu cos 20)/k with the spring, and no equilibrium without it.",
        source="Coulomb (1785); Ansys VM29; code_aster SSNV503",
        proves="The limit of friction, exactly; and that an unsupported sliding body is reported, not computed.",
    )
    weight = 2 * DENSITY * GRAVITY
    stuck = case.run(slope_deck(1.0001 * np.tan(SLOPE), False), "sticks", requested=5)
    far = float(np.abs(stuck.last("U")).max())
    case.within("largest displacement", far, (0.0, 1e-6), why="only elastic: W/(G A) = 2e-8 (near its limit some nodes may slip so far)",
                place="all nodes", time="the end")  # fmt: skip
    total = stuck.last("CSHEARF").sum(axis=0) + stuck.last("CNORMF").sum(axis=0)
    expected = weight * np.array([-np.sin(SLOPE), 0, np.cos(SLOPE)])
    case.near("contact force", total, expected, 1e-6, why="equilibrium", place="all slave nodes", time="the end")
    mu = 0.8 * np.tan(SLOPE)
    hung = case.run(slope_deck(mu, True), "with a spring", requested=5)
    slip = weight * (np.sin(SLOPE) - mu * np.cos(SLOPE)) / SOFT
    body = np.abs(hung.last("CNORMF")[:, 2]) > 0
    case.near("slip", hung.last("U")[body, 0], slip, 1e-5, why="the block itself is 2e7 times as stiff as the spring",
              place="all nodes of the block", time="the end")  # fmt: skip
    case.near("friction", hung.last("CSHEARF")[:, 0].sum(), -mu * weight * np.cos(SLOPE), 1e-5, why="mu N", place="all slave nodes", time="the end")
    (tmp_path / "gone.inp").write_text(slope_deck(mu, False))
    done = run(["gone"], cwd=tmp_path)
    case.true("exit code 5 alone", done.returncode == 5, why="the block has no support", place="the job without a spring", time="the end")
    case.true("and it says FREE BODY", "FREE BODY" in done.stdout, why="a clear reason", place="the job without a spring", time="the end")
    case.done()


# -------------------------------------------------------------------------------------- sliding with reversal


def test_reversal(proof: Proof) -> None:
    """A block pressed and dragged to and fro."""
    mu, press, drag = 0.3, 0.002, 0.004
    case = proof(
        "reversal",
        title="A block dragged to and fro",
        model="A block 1 x 1 x 0.5 (E = 1000, nu = 0, 4 x 4 x 2 C3D8) on a fixed table, its top pressed by 0.002 (2 increments), dragged by "
        "+0.004, back to -0.004 and to +0.004 again (10 increments each), small displacements, mu = 0.3, one facet of the table.",
        formula="N = E A press/height. While it slides all the friction is used: |T| = mu N, along -x or +x.",
        source="Coulomb (1785)",
        proves="Gross sliding with two reversals: the limit holds to the tolerance of Newton's method, the sign turns.",
    )
    table = block(between(-1, 2, 1), between(-1, 2, 1), [-1.0, 0.0], "TABLE")
    body = block(between(0, 1, 4), between(0, 1, 4), between(0, 0.5, 2), "BODY")
    supports = fix("TABLE_TOP, 1, 3", "TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2", f"BODY_TOP, 3, 3, {-press}")
    steps = step(supports, 2) + "".join(step(fix(f"BODY_TOP, 1, 1, {u}"), 10) for u in (drag, -drag, drag))
    deck = solid_deck([(body, (1000.0, 0.0)), (table, (1000.0, 0.0))], pair("BODY_BOTTOM", "TABLE_TOP", mu), steps)
    job = case.run(deck, requested=32)
    normal, shear = job.field("CNORMF")[:, :, 2].sum(axis=1), job.field("CSHEARF")[:, :, 0].sum(axis=1)
    case.near("N", normal[job.frame(1.0)], 1000 * press / 0.5, 1e-9, why="uniform pressure, nu = 0", time="1", place="all slave nodes")
    for time, sign in ((2.0, -1), (3.0, 1), (4.0, -1)):
        frame = job.frame(time)
        case.near("T/(mu N)", shear[frame] / (mu * normal[frame]), sign, 5e-6, why="default controls: 1e-6 of the largest force", time=f"{time:g}",
                  place="all slave nodes")  # fmt: skip
        case.true("all slide", bool((job.field("CSTATUS")[frame][:25] == 2).all()), why="gross sliding", time=f"{time:g}", place="all slave nodes")
    case.figure(lambda: loop_figure(job.field("U")[:, -60:, 0], shear, normal, job.times), "Friction over time.")
    case.done()


def loop_figure(_: Floats, shear: Floats, normal: Floats, times: Floats) -> object:
    """T/N over time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3))
    axes = figure.subplots()
    axes.plot(times[1:], shear[1:] / normal[1:], "o-", ms=3)
    axes.set(xlabel="time", ylabel="T/N")
    return figure


# --------------------------------------------------------------------------------------------------- capstan


def ring_sector(name: str, inner: float, outer: float, degrees: float, n: int, m: int) -> Mesh:
    """A sheet of a ring: s along the angle from the x axis, backwards, so that t = radius is to the outside."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle = np.radians(degrees) * (1 - s)
        return t * np.cos(angle), t * np.sin(angle)

    return sheet(name, between(0, 1, n), between(inner, outer, m), place)


def capstan_deck(n: int, ends: dict[str, Floats]) -> str:
    """The strap shrunk on the drum, then drawn over it."""
    strap, drum = strap_and_drum(n)
    supports = fix("DRUM_BOTTOM, 1, 3", "DRUM_TOP, 1, 3", "PULLED, 1", "GIVEN, 3")
    steps = step(supports, 1) + step(fix("PULLED, 1, 1, -1.", "GIVEN, 3, 3, 0.9"), 60)
    parts = [(strap, (1000.0, 0.0)), (drum, (1e5, 0.0))]
    return plane_deck(parts, pair("STRAP_BOTTOM", "DRUM_TOP", 0.3), steps, ends)


def strap_and_drum(n: int) -> tuple[Mesh, Mesh]:
    """The strap is made 0.05 too small."""
    return ring_sector("STRAP", 99.95, 100.45, 90, n, 2), ring_sector("DRUM", 95.0, 100.0, 90, n, 2)


@pytest.mark.slow
def test_capstan(proof: Proof) -> None:
    """A strap around a quarter of a drum; two meshes."""
    case = proof(
        "capstan",
        title="Capstan",
        model="A strap (t = 0.5, E = 1000, nu = 0) is shrunk by 0.05 on a quarter of a fixed drum of radius 100, 120 and 240 elements along "
        "it, plane strain, C3D8, small displacements, mu = 0.3. Its ends are held along it (not at the nodes that touch) while contact is established (1 "
        "increment), then one is drawn by 1 (60 increments) while the other yields by 0.9, so that all of it slides.",
        formula="T2/T1 = exp(mu theta'), theta' = theta/(1 + t/(2 R)) because friction acts at the drum and tension in the middle of the strap.",
        source="Euler (1769), Eytelwein (1808)",
        proves="Friction along a curved master, where the pressure at each node depends on the friction of all nodes before it.",
    )
    expected = np.exp(0.3 * np.pi / 2 / (1 + 0.5 / 200))
    errors = []
    for n in (120, 240):
        strap = strap_and_drum(n)[0]
        ends = {
            name: np.setdiff1d(strap.node_sets[f"STRAP_{side}"], strap.node_sets["STRAP_BOTTOM"])
            for name, side in (("PULLED", "LEFT"), ("GIVEN", "RIGHT"))
        }
        job = case.run(capstan_deck(n, ends), f"{n} elements", requested=61)
        force = job.last("RF")
        found = force[ends["PULLED"], 0].sum() / force[ends["GIVEN"], 2].sum()
        errors.append(abs(found / expected - 1))
        stuck = job.last("CSTATUS")[strap.node_sets["STRAP_BOTTOM"]] == 1
        case.true("no node sticks", not stuck.any(), why="drawn far enough", time=f"the end, {n} elements", place="all slave nodes")
    order = f"{np.log2(errors[0] / errors[1]):.1f}"
    case.near("T2/T1", found, expected, 0.005, why="linear elements bend too stiffly: first order", order=order,
              place="ends of the band", time="the end")  # fmt: skip
    case.within("finer over coarser error", errors[1] / errors[0], (0.0, 0.9), why="convergence", place="ends of the band", time="the end")
    case.done()


# ------------------------------------------------------------------------------------------------ shrink fit


def ring(name: str, inner: float, outer: float, length: float, cells: tuple[int, int, int]) -> Mesh:
    """A closed ring about y: cells around, along, through; surfaces NAME_IN and NAME_OUT, node sets NAME_A (y = 0) and
    NAME_B, NAME_X and NAME_Z: the lines of the face away from the fit that lie in x = 0 and in z = 0.
    """
    n, k, m = cells
    a, y, t = np.meshgrid(np.arange(n), between(0, length, k), between(inner, outer, m), indexing="ij")
    angle = -2 * np.pi * a / n
    nodes = np.stack([v.ravel(order="F") for v in (t * np.cos(angle), y, t * np.sin(angle))], axis=1)
    i, b, c = (v.ravel(order="F") for v in np.meshgrid(range(n), range(k), range(m), indexing="ij"))
    along = np.stack([i, (i + 1) % n, (i + 1) % n, i], axis=1)
    lower = along + n * np.stack([b, b, b + 1, b + 1], axis=1) + n * (k + 1) * c[:, None]
    mesh = Mesh(nodes, np.concatenate([lower, lower + n * (k + 1)], axis=1))
    mesh.element_sets = {name: np.arange(n * k * m), f"{name}_E1": np.arange(n * k), f"{name}_E2": np.arange(n * k) + n * k * (m - 1)}
    mesh.surfaces = {f"{name}_IN": [(f"{name}_E1", 1)], f"{name}_OUT": [(f"{name}_E2", 2)]}
    layers = {"IN": np.arange(n * (k + 1)), "OUT": np.arange(n * (k + 1)) + n * (k + 1) * m}
    mesh.node_sets = {f"{name}_{side}": members for side, members in layers.items()}
    for end, value in (("A", 0.0), ("B", length)):
        mesh.node_sets[f"{name}_{end}"] = np.flatnonzero(np.abs(nodes[:, 1] - value) < 1e-9)
    free = layers["IN" if name == "INNER" else "OUT"]
    for side, axis in (("X", 0), ("Z", 2)):
        mesh.node_sets[f"{name}_{side}"] = free[np.abs(nodes[free, axis]) < 1e-9]
    return mesh


def test_shrink_fit(proof: Proof) -> None:
    """Two rings with interference, then the inner one is pulled out of the outer one."""
    young, d, mu, length = 206e9, 0.02, 0.1, 0.5
    ri, rm, ro = 1.25, 1.516, 1.75
    ru = rm + d  # outer radius of the inner ring as it is made
    soft = rm * (ro**2 + rm**2) / (ro**2 - rm**2) + rm * (ru**2 + ri**2) / (ru**2 - ri**2)
    p = young * d / soft
    nominal = young * d / (2 * rm**3) * (ro**2 - rm**2) * (rm**2 - ri**2) / (ro**2 - ri**2)
    case = proof(
        "shrink-fit",
        title="Shrink fit with pull-out: Lame",
        model="Two whole rings, radii 1.25, 1.516 and 1.75 m, 0.5 m long, E = 206 GPa, nu = 0, mu = 0.1, C3D8, 64 around, 2 along, 4 through "
        "each; the inner ring is 0.02 m too large. Step 1 establishes contact (1 increment), step 2 pulls the inner face of one end of the inner "
        "ring by 20 mm along the axis (10 increments), small displacements.",
        formula="Lame for each ring with its own radii: p = E d/[R (Ro^2 + R^2)/(Ro^2 - R^2) + R (Ru^2 + Ri^2)/(Ru^2 - Ri^2)], Ru = R + d, p "
        f"on the outer ring; {p:.5g} Pa. (Both with the radius R: {nominal:.5g} Pa, the number of VM292.) Pull-out force mu p 2 pi R L.",
        source="Lame (1852); Ansys VM292",
        proves="Interference that the first increment resolves, and axial sliding of a curved fit.",
    )
    inner, outer = ring("INNER", ri, rm + d, length, (64, 2, 4)), ring("OUTER", rm, ro, length, (64, 2, 4))
    handle = np.intersect1d(inner.node_sets["INNER_IN"], inner.node_sets["INNER_B"])
    grip = np.intersect1d(outer.node_sets["OUTER_OUT"], outer.node_sets["OUTER_A"]) + len(inner.nodes)
    supports = fix("INNER_X, 1", "INNER_Z, 3", "OUTER_X, 1", "OUTER_Z, 3", "GRIP, 2", "HANDLE, 2")
    steps = step(supports, 1) + step(fix("HANDLE, 2, 2, 0.02"), 10)
    parts = [(inner, (young, 0.0)), (outer, (young, 0.0))]
    deck = solid_deck(parts, pair("INNER_OUT", "OUTER_IN", mu), steps, {"HANDLE": handle, "GRIP": grip})
    job = case.run(deck, requested=11)
    slaves = inner.node_sets["INNER_OUT"]
    middle = slaves[np.abs(inner.nodes[slaves, 1] - length / 2) < 1e-9]
    normal = np.linalg.norm(job.field("CNORMF")[:, slaves], axis=2).sum(axis=1)
    area = 2 * np.pi * rm * length
    case.near("mean pressure", normal[job.frame(1.0)] / area, p, 0.005, why="four elements through each ring", time="1", place="all slave nodes")
    pressure = job.field("CPRESS")[job.frame(1.0), middle]
    case.near("pressure is the same all around", pressure, pressure.mean(), 1e-6, why="symmetry of the mesh", time="1", place="all slave nodes")
    pull = job.last("RF")[handle, 1].sum()
    case.near("pull-out force over mu N", pull / (mu * normal[-1]), 1.0, 1e-5, why="all of it slides", time="2", place="all slave nodes")
    case.near("pull-out force", pull, mu * p * area, 0.01, why="the pulled end is bent", time="2", place="pulled end")
    case.done()


# --------------------------------------------------------------------------------------------------- ironing


@pytest.mark.slow
def test_shallow_ironing(proof: Proof) -> None:
    """Fischer and Wriggers."""
    case = proof(
        "shallow-ironing",
        title="Shallow ironing: Fischer and Wriggers",
        model="A block (x 0.2 to 1.4, flat top at z = 5.4, bottom an arc of radius 0.75 with its pole at 4.2, E = 6896) is pressed by 1 into "
        "a foundation 12 x 4 (E = 689.6), nu = 0.32, mu = 0.3, plane strain, 60 x 15 and 12 x 6 C3D8, then drawn along by 10; NLGEOM. 20 "
        "increments are requested for the press, 200 for the drag. Neo-Hooke's law as published, C10 = G/2 and D1 = 2/K.",
        formula="Six published codes disagree: V(1) 268 to 332, V(1.5) 337 to 421, H/V(1.5) 0.30 to 0.53; the curves are smooth.",
        source="Fischer and Wriggers, Comput. Methods Appl. Mech. Engrg. 195 (2006) 5020, and five later authors",
        proves="Finite sliding over fifty facets with friction.",
    )
    ground = sheet("GROUND", between(0, 12, 60), between(0, 4, 15))
    radius = 0.75

    def arc(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        x = 0.6 * s
        return 0.8 + x, (4.2 + radius - np.sqrt(radius**2 - x**2)) * (1 - t) + 5.4 * t

    iron = sheet("IRON", between(-1, 1, 12), between(0, 1, 6), arc)
    press = fix("GROUND_BOTTOM, 1, 3", "IRON_TOP, 1", "IRON_TOP, 3, 3, -1.")
    steps = step(press, 20, True) + step(fix("IRON_TOP, 1, 1, 10."), 200, True)
    deck = plane_deck([(iron, (6896.0, 0.32)), (ground, (689.6, 0.32))], pair("IRON_BOTTOM", "GROUND_TOP", 0.3), steps)
    job = case.run(re.sub(r"\*ELASTIC\n(.*), (.*)\n", neo_hooke, deck), requested=220)
    force = job.field("RF")[:, join([iron, ground]).node_sets["IRON_TOP"]].sum(axis=1)
    v, h = -force[:, 2], force[:, 0]
    at = [int(np.argmin(np.abs(job.times - t))) for t in (1.0, 1.5)]
    case.within("V", v[at[0]], (268, 332), why="band of the published codes", time="1", place="top of the block")
    case.within("V", v[at[1]], (337, 421), why="band of the published codes", time="1.5", place="top of the block")
    case.within("H/V", abs(h[at[1]]) / v[at[1]], (0.30, 0.53), why="band of the published codes", time="1.5", place="top of the block")
    steady = (job.times > 1.3) & (job.times < 1.8)
    trend = np.polyval(np.polyfit(job.times[steady], v[steady], 2), job.times[steady])
    case.within("ripple of V", float(np.abs(v[steady] / trend - 1).max()), (0.0, 0.03), why="one facet after the other", time="1.3 to 1.8",
                place="top of the block")  # fmt: skip
    case.true("the stroke is done", bool(abs(job.times[-1] - 2.0) < 1e-9), why="in 220 increments", time="2", place="top of the block")
    case.figure(lambda: ironing_figure(job.times, v, h), "Vertical and horizontal force on the block.")
    case.done()


def neo_hooke(elastic: re.Match[str]) -> str:
    """The card of the compressible neo-Hookean law with the moduli of *ELASTIC at rest."""
    young, nu = float(elastic[1]), float(elastic[2])
    return f"*HYPERELASTIC, NEO HOOKE\n{young / (4 * (1 + nu)):.12g}, {6 * (1 - 2 * nu) / young:.12g}\n"


def ironing_figure(times: Floats, v: Floats, h: Floats) -> object:
    """Forces over time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.5, 3.5))
    axes = figure.subplots()
    axes.plot(times, v, label="vertical")
    axes.plot(times, np.abs(h), label="horizontal")
    axes.set(xlabel="time", ylabel="force")
    axes.legend()
    return figure


# ------------------------------------------------------------------------------- a stuck block turns with all


@pytest.mark.parametrize("degrees", [10.0, 30.0])
def test_stuck_block_turns(proof: Proof, degrees: float) -> None:
    """Two pressed blocks turned together by half a turn: nothing but the directions changes."""
    n_steps = round(180 / degrees)
    case = proof(
        f"turning-{degrees:g}",
        title=f"A stuck block in a large rotation, {degrees:g} degrees per increment",
        model="A block 1 x 1 (3 x 3 cells) on a block 2 x 1 (5 x 2 cells), E = 1000, nu = 0.3, mu = 0.5, plane strain, NLGEOM. The top is pressed "
        f"by 0.01 and moved sideways by 0.001 (2 increments), then top and bottom turn about the origin by 180 degrees, {n_steps} steps of one "
        "increment.",
        formula="Contact forces in axes that turn along are what they were; no node slips.",
        source="objectivity; CalculiX (node to surface) stops at some 72 degrees",
        proves="Stick is a tie to a material point of the master: it turns with it, for any angle per increment.",
    )
    lower = sheet("LOWER", between(-1, 1, 5), between(-1, 0, 2))
    upper = sheet("UPPER", between(-0.5, 0.5, 3), between(0, 1, 3))
    mesh = join([upper, lower])
    steps = step(fix("LOWER_BOTTOM, 1, 3", "UPPER_TOP, 1, 1, 0.001", "UPPER_TOP, 3, 3, -0.01"), 2, True)
    held = np.concatenate([mesh.node_sets["UPPER_TOP"], mesh.node_sets["LOWER_BOTTOM"]])
    start = mesh.nodes[held].copy()
    start[: len(mesh.node_sets["UPPER_TOP"])] += [0.001, 0, -0.01]
    for k in range(1, n_steps + 1):
        angle = np.radians(degrees * k)
        turned = start @ turn(angle).T - mesh.nodes[held]
        rows = [f"{i + 1}, {d}, {d}, {u[d - 1]:.15g}" for i, u in zip(held, turned, strict=True) for d in (1, 3)]
        steps += step(fix(*rows), 1, True)
    deck = plane_deck([(upper, (1000.0, 0.3)), (lower, (1000.0, 0.3))], pair("UPPER_BOTTOM", "LOWER_TOP", 0.5), steps)
    job = case.run(deck, requested=2 + n_steps)
    first = job.frame(1.0)
    forces = job.field("CNORMF") + job.field("CSHEARF")
    scale = float(np.abs(forces[first]).max())
    stuck = job.field("CSTATUS")[first] == 1
    worst = max(
        float(np.abs(forces[first + k] @ turn(np.radians(degrees * k)) - forces[first]).max()) for k in range(1, n_steps + 1)
    )
    case.near("contact force, turned back", worst / scale, 0.0, 1e-6, why="the default controls", scale=1.0, time="all increments",
              place="all slave nodes")  # fmt: skip
    still = (job.field("CSTATUS")[first:] == job.field("CSTATUS")[first]).all()
    case.true("every status stays", bool(still), why="a rigid rotation", time="all increments", place="all slave nodes")
    case.true("some nodes stick", bool(stuck.any()), why="else nothing is shown", place="all slave nodes", time="the end")
    case.done()


def turn(angle: float) -> Floats:
    """Rotation about y, from x to z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


# ------------------------------------------------------------------------- supports at slave nodes of a curved fit


def test_shrink_fit_quarter(proof: Proof) -> None:
    """A quarter of a shrink fit in the plane, with symmetry supports at slave nodes too."""
    case = proof(
        "shrink-fit-quarter",
        title="A quarter of a shrink fit with planes of symmetry",
        model="A quarter of two rings in the plane, radii 1.25, 1.516 and 1.75, the inner one 0.02 too large, E = 206e9, nu = 0, mu = 0.1, 12 "
        "C3D8 around and 2 through each, small displacements, one increment. The nodes on both planes of symmetry are held "
        "perpendicular to them, slave and master nodes among them.",
        formula="What a whole ring of 48 such elements does: every node has the same radial displacement and the same pressure.",
        source="symmetry",
        proves="Normals at the border of a master lie in the plane of symmetry there.",
    )
    inner = ring_sector("INNER", 1.25, 1.536, 90, 12, 2)
    outer = ring_sector("OUTER", 1.516, 1.75, 90, 12, 2)
    supports = fix("INNER_LEFT, 1", "OUTER_LEFT, 1", "INNER_RIGHT, 3", "OUTER_RIGHT, 3")
    parts = [(inner, (206e9, 0.0)), (outer, (206e9, 0.0))]
    job = case.run(plane_deck(parts, pair("INNER_TOP", "OUTER_BOTTOM", 0.1), step(supports, 1)), requested=1)
    slaves = inner.node_sets["INNER_TOP"]
    radial = np.linalg.norm((inner.nodes + job.last("U")[: len(inner.nodes)])[slaves][:, [0, 2]], axis=1)
    case.near("radius of the fit", radial, radial.mean(), 1e-9, why="every sector is a mirror image of the next", place="all slave nodes",
              time="the end")  # fmt: skip
    pressure = job.last("CPRESS")[slaves]
    case.true("it presses", bool(pressure.min() > 0), why="an interference of 0.02", place="all slave nodes", time="the end")
    case.near("pressure", pressure, pressure.mean(), 1e-6, why="every sector is a mirror image of the next", place="all slave nodes", time="the end")
    case.done()


# ------------------------------------------------------------------------------- slave nodes that supports move along


def test_prescribed_motion_of_slaves(proof: Proof) -> None:
    """A block pressed sideways on a wall; supports draw the nodes that touch along it."""
    case = proof(
        "prescribed-motion-of-slaves",
        title="Slave nodes that supports draw along their master",
        model="A block 1 x 1 (E = 2000, nu = 0, plane strain, 4 x 4 C3D8) is pressed sideways by 0.01 on a fixed wall, flat and in facets of "
        "0.3 (1 increment), then all its nodes are drawn up by 1 (4 increments), the touching ones too; mu = 0.3, NLGEOM.",
        formula="Nothing is left for friction: the force on the wall stays what it was, and every node that touches slides.",
        source="equilibrium of one block",
        proves="A node is not held where it first touched if supports move it on: stick would require both.",
    )
    body = sheet("BODY", between(0, 1, 4), between(0, 1, 4))
    wall = sheet("WALL", between(-0.5, 0, 1), between(-0.5, 2.5, 10))
    parts = [(body, (2000.0, 0.0)), (wall, (2000.0, 0.0))]
    press = fix("WALL, 1, 3", "BODY, 3", "BODY_RIGHT, 1, 1, -0.01")
    steps = step(press, 1, True) + step(fix("BODY, 3, 3, 1."), 4, True)
    sets = {"WALL": np.arange(len(wall.nodes)) + len(body.nodes), "BODY": np.arange(len(body.nodes))}
    job = case.run(plane_deck(parts, pair("BODY_LEFT", "WALL_RIGHT", 0.3), steps, sets), requested=5)
    force = job.field("CNORMF")[:, :, 0].sum(axis=1)
    expected = 2000 * -np.log(0.99) / 0.99
    case.near("force on the wall", force[job.frame(1.0)], expected, 1e-6, why="uniaxial, Kirchhoff's stress by Hencky's strain", time="1",
              place="wall")  # fmt: skip
    case.near("force on the wall", force[-1] / force[job.frame(1.0)], 1.0, 1e-6, why="the wall is flat; Newton's tolerance", time="2", place="wall")
    slides = job.last("CSTATUS")[body.node_sets["BODY_LEFT"]] == 2
    case.true("all that touch slide", bool(slides.all()), why="supports move them", time="2", place="all slave nodes")
    case.done()


def test_slope_drawn_under_a_held_block(proof: Proof) -> None:
    """Supports hold the nodes that touch in one direction along a slope, friction in the other; the slope is drawn away below."""
    case = proof(
        "slope-drawn-under-a-held-block",
        title="A slope drawn under a block that supports hold across and friction along",
        model="A block (E = 2000, nu = 0, 2 x 1 x 2 C3D8 of 1 x 1 x 1) stands on a slope of tan = 0.4 in x, z, in facets of 0.3 and as wide in y; "
        "the nodes that touch are held in x. Forces of 1 press its upper nodes down (1 increment), then all nodes of the slope are drawn "
        "by -0.3 in x and 0.1 in y (2 increments); mu = 0.3, NLGEOM.",
        formula="Nothing pulls in y: friction sticks, and the block goes along by 0.1. In x the slope moves on below it and lifts it by 0.3 tan.",
        source="geometry",
        proves="A node that sticks while its master slides where a support holds it stays on its master's surface, not at the height where it first touched.",
    )
    slope = 0.4

    def lean(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return s, t + slope * s

    body = sheet("BODY", between(0, 1, 2), between(0, 1, 2), lean)
    table = sheet("TABLE", between(-1, 2, 10), between(-0.5, 0, 1), lean)
    supports = fix("BODY_BOTTOM, 1", "TABLE, 1, 3")
    load = "*CLOAD\nBODY_TOP, 3, -1.\n"
    steps = step(supports + load, 1, True) + step(fix("TABLE, 1, 1, -0.3", "TABLE, 2, 2, 0.1"), 2, True)
    sets = {"TABLE": np.arange(len(table.nodes)) + len(body.nodes)}
    job = case.run(solid_deck([(body, (2000.0, 0.0)), (table, (2000.0, 0.0))], pair("BODY_BOTTOM", "TABLE_TOP", 0.3), steps, sets), requested=3)
    moved = (job.last("U") - job.field("U")[job.frame(1.0)])[: len(body.nodes)]
    displacement = np.array([0.0, 0.1, 0.3 * slope])
    for i, name in enumerate("xyz"):
        case.near(f"displacement in {name}", moved[:, i], displacement[i], 1e-8, why="a rigid body; gaps are closed to 1e-9 of an edge", place="block", time="2",
                  scale=0.1)  # fmt: skip
    sticks = job.last("CSTATUS")[body.node_sets["BODY_BOTTOM"]] == 1
    case.true("all that touch stick", bool(sticks.all()), why="nothing pulls in y", time="2", place="all slave nodes")
    case.done()


# ------------------------------------------------------------------------------- the whole displacement in one increment


@pytest.mark.parametrize(("what", "make", "mu", "steps"), [("block", drag, 0.3, 2), ("cylinder", cylinder, 1.0, 3)], ids=["block", "cylinder"])
def test_dragged_at_once(proof: Proof, what: str, make: Callable[[float, str, int], str], mu: float, steps: int) -> None:
    """Contact is all stick or in another place where the increment begins, and all slip over many facets at its end."""
    case = proof(
        f"{what}-dragged-at-once",
        title=f"A {what} dragged over many facets in one increment",
        model=f"The {what} of the study over all contact cases (verify/study/contact_table.py), plane strain, CPE4, NLGEOM, mu = {mu}: pressed on its base, "
        + ("then dragged by 2, eight facets" if what == "block" else "drawn by 1 in one direction, then by 2 in the opposite direction")
        + ", each step in one increment.",
        formula="All that touches slides: the friction on the base is mu times the pressure on it, against the motion.",
        source="Coulomb's law",
        proves="Where the contact subproblem of a full Newton step has no solution, portions of the step solve it.",
    )
    job = case.run(make(mu, "AUTO", 1), requested=steps)
    case.true("increments made", job.last("CSTATUS").size > 0 and len(job.field("U")) == steps + 1, why="no attempt failed", place="the job", time="the end")
    touches = job.last("CSTATUS") > 0
    case.true("all that touch slide", bool((job.last("CSTATUS")[touches] == 2).all() and touches.any()), why="the displacement is many times the elastic stick displacement",
              place="all slave nodes", time="the end")  # fmt: skip
    pressing, shearing = (np.linalg.norm(job.last(name), axis=1).sum() for name in ("CNORMF", "CSHEARF"))
    case.near("friction over pressure", shearing / pressing, mu, 1e-6, why="Newton's tolerance", place="all slave nodes", time="the end")
    case.done()


@pytest.mark.parametrize("is_nlgeom", [False, True], ids=["linear", "nlgeom"])
def test_mortar_slides_in_any_step(proof: Proof, is_nlgeom: bool) -> None:
    """Rows and normals that stayed where the step began would have a round body climb its own shape."""
    name = "nlgeom" if is_nlgeom else "linear"
    case = proof(
        f"mortar-slides-{name}",
        title=f"A round body dragged over a table without friction, MORTAR, {name}",
        model="A disc of radius 2 (40 CPE4 round the rim, E = 210000, nu = 0.3) pressed by 0.02 on a plate 10 x 2 of the same steel (cells of 0.5), then dragged by 1.5 in 5 increments, "
        f"calculix dialect, TYPE=MORTAR, LINEAR with 50 E, mu = 0, {'NLGEOM' if is_nlgeom else 'without NLGEOM'}; the centre line of the disc is moved.",
        formula="A flat table without friction gives no force along itself, and the same force across it wherever the disc is, but for the place of its nodes.",
        source="Symmetry",
        proves="Under the calculix dialect MORTAR follows its master without NLGEOM too, as in CalculiX.",
    )
    disc, table = roller("DISC", 0.13), flatten(sheet("TABLE", between(-5, 5, 20), between(-2, 0, 4)))
    disc.node_sets["CORE"] = np.flatnonzero(np.linalg.norm(disc.nodes - [0.13, 2.0], axis=1) < 1.0)
    law = "*SURFACE INTERACTION, NAME=SMOOTH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.05e7, 0.\n*CONTACT PAIR, INTERACTION=SMOOTH, TYPE=MORTAR\nDISC_SKIN, TABLE_TOP\n"
    steps = step(fix("TABLE_BOTTOM, 1, 2", "CORE, 1", "CORE, 2, 2, -0.02"), 2, is_nlgeom) + step(fix("CORE, 1, 1, 1.5"), 5, is_nlgeom)
    job = case.run("** dialect: calculix\n" + flat_deck([(part, (210000.0, 0.3)) for part in (disc, table)], "CPE4", law + steps), requested=7)
    force = job.field("RF")[:, len(disc.nodes) + table.node_sets["TABLE_BOTTOM"]].sum(axis=1)
    pressed = force[2, 1]
    case.within("force along the table over force across", force[-1, 0] / pressed, (-1e-6, 1e-6), why="Newton's tolerance", place="the table", time="the end")
    case.near("force across the table", force[-1, 1] / pressed, 1.0, 0.05, why="faces of the rim of 0.3, cells of the table of 0.5", place="the table", time="the end")
    case.done()


# ------------------------------------------------------------------------------------------- rollers between plates


def roller(name: str, x: float) -> Plane:
    """A disc of radius 2 about (x, 2), ten cells to a side; NAME_SKIN is its rim."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return x + 2 * s * np.sqrt(1 - t * t / 2), 2 + 2 * t * np.sqrt(1 - s * s / 2)

    disc = flatten(sheet(name, between(-1, 1, 10), between(-1, 1, 10), place))
    disc.surfaces[f"{name}_SKIN"] = [face for side in ("BOTTOM", "RIGHT", "TOP", "LEFT") for face in disc.surfaces[f"{name}_{side}"]]
    return disc


@pytest.mark.parametrize(("kind", "n"), [("NODE TO SURFACE", 30), ("SURFACE TO SURFACE", 10)], ids=["nodes", "surfaces"])
def test_rollers_between_plates(proof: Proof, kind: str, n: int) -> None:
    """Three bodies that only contact supports roll between two plates: nodes come and go at both sides."""
    displacement, mu = 1.47, 0.2
    case = proof(
        f"rollers-{kind.lower().replace(' ', '-')}",
        title=f"Rollers between two plates, {kind.lower()}",
        model="Three discs of radius 2 (40 CPE4 round the rim, E = 210000, nu = 0.3), 6 apart, between two plates 23 x 2 of the same steel: pressed together by 0.02 in 10 increments, then the upper "
        f"plate goes by {displacement:g} in {n}, NLGEOM, mu = {mu:g}; the rims are slaves of both plates.",
        formula="Each centre moves by half the displacement of the upper plate: turned by half a turn about it, and seen from it, the motion is the same.",
        source="Symmetry; rolling without slip at both plates",
        proves="Nodes that come into contact and leave it while bodies roll; bodies without any support.",
    )
    rollers = [roller(f"R{k}", 6.0 * k) for k in range(3)]
    low, up = (flatten(sheet(name, between(-5, 18, 46), between(y, y + 2, 3))) for name, y in (("LOW", -2), ("UP", 4)))
    pairs = f"*SURFACE INTERACTION, NAME=STEEL\n*FRICTION\n{mu}\n" + "".join(
        f"*CONTACT PAIR, INTERACTION=STEEL, TYPE={kind}\nR{k}_SKIN, {plate}\n" for k in range(3) for plate in ("LOW_TOP", "UP_BOTTOM")
    )
    parts = [*rollers, low, up]
    steps = step(fix("LOW_BOTTOM, 1, 2", "UP_TOP, 1", "UP_TOP, 2, 2, -0.02"), 10, True) + step(fix(f"UP_TOP, 1, 1, {displacement}"), n, True)
    job = case.run(flat_deck([(part, (210000.0, 0.3)) for part in parts], "CPE4", pairs + steps), requested=10 + n)
    for k, disc in enumerate(rollers):
        at = sum(len(other.nodes) for other in rollers[:k]) + int(np.argmin(np.linalg.norm(disc.nodes - [6.0 * k, 2.0], axis=1)))
        case.near(f"displacement of the centre of roller {k + 1}", job.last("U")[at][0], 0.5 * displacement, 0.01, why="the plates end, and rims are polygons that dig in by 0.01", place="centre", time="the end")
    case.done()


# --------------------------------------------------------------------------------------- compliant laws, soft and stiff


@pytest.mark.parametrize(("slope", "stick"), [(2e6, 2e5), (1e8, 1e7), (1e10, 1e9)], ids=["10 E", "500 E", "50000 E"])
def test_cubes_under_a_law(proof: Proof, slope: float, stick: float) -> None:
    """Cubes pressed and sheared to and fro under LINEAR contact with a stick slope, as CalculiX's decks have it."""
    case = proof(
        f"cubes-under-a-law-{slope:.0e}".replace("+", ""),
        title=f"Cubes sheared to and fro, slope {slope:.0e}",
        model="A cube of 1 (4 x 4 x 4 C3D8, E = 210000, nu = 0.3) on a larger block, meshes that do not match, pressed by 0.01, sheared by 0.05 and then by "
        f"-0.05, NLGEOM, 5 increments each; LINEAR with {slope:.0e} per unit of length, mu = 0.3 with the stick slope {stick:.0e}, node to surface.",
        formula="All slide at the end of each stroke: the friction on the cube is mu times the pressure on it, and turns round with the motion.",
        source="Coulomb's law",
        proves="Compliant contact, soft and stiff, takes the iterations of exact contact.",
    )
    body = block(between(0, 1, 4), between(0, 1, 4), between(0, 1, 4), "BODY")
    table = block(between(-0.13, 1.2, 5), between(-0.13, 1.3, 5), between(-1, 0, 4), "TABLE")
    press = fix("TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2", "BODY_TOP, 3, 3, -0.01")
    loads = [press, fix("BODY_TOP, 1, 1, 0.05"), fix("BODY_TOP, 1, 1, -0.05")]
    law = pair("BODY_BOTTOM", "TABLE_TOP", 0.3).replace("*FRICTION\n0.3\n", f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{slope}\n*FRICTION\n0.3, {stick}\n")
    parts = [(body, (210000.0, 0.3)), (table, (210000.0, 0.3))]
    job = case.run("** dialect: calculix\n" + solid_deck(parts, law, "".join(step(load, 5, True) for load in loads)), requested=15)
    pressing, shearing = job.field("CNORMF")[:, :, 2].sum(axis=1), job.field("CSHEARF")[:, :, 0].sum(axis=1)
    reversal = job.frame(2.0)
    for time, frame, sign in (("2", reversal, -1.0), ("3", -1, 1.0)):
        case.near("friction over pressure", shearing[frame] / pressing[frame], sign * 0.3, 2e-3, why="faces that tilt by up to 0.05", place="cube", time=time)
    case.true("no attempt fails", bool((job.history["is_converged"] != 0).all()), why="the law is solved together with the compliance of the bodies", place="the job", time="the end")
    case.within("iterations", float(job.n_iterations), (15.0, 30.0), why="exact contact takes 28 on these meshes", place="the job", time="the end")
    case.done()
