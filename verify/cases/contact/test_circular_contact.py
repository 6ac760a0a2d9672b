"""Contact over a circle: a flat punch without and with friction (Spence), and two balls sheared to and fro (Mindlin).

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from verify.cases.proof import Case, Job, observed_order
from verify.decks.make_decks import Mesh, block, graded
from verify.decks.planes import flat_deck, flatten
from verify.decks.circular_meshes import quarter_disk
from verify.decks.sheets import Floats, between, fix, pair, sheet, solid_deck, step
from verify.independent.half_space import Punch, solve_punch

Proof = Callable[..., Case]
reference = cache(solve_punch)

# ------------------------------------------------------------------------------------------ flat punch

FAR, YOUNG, DEPTH = 150.0, 1000.0, 0.001  #: size of the half space and depth of the punch, over its radius


def punch_in_space(n: int, nu: float, mu: float) -> tuple[str, Floats]:
    """A quarter of the ground, its nodes within the circle on a rigid plate; 2 n elements over the radius. The nodes come back."""
    rings = np.concatenate([between(0, 1, n), 1 + graded(FAR - 1, 0.5 / n, 1, 18)[1:]])
    ground = quarter_disk(between(0, 1, n), rings, -graded(FAR, 0.5 / n, 2, 18)[::-1], "GROUND")
    plate = block(between(-0.5, 2, 1), between(-0.5, 2, 1), [0.0, 1.0], "PLATE")
    supports = fix("GROUND_BOTTOM, 3", "GROUND_X, 1", "GROUND_Y, 2", "ALL_PLATE, 1, 2", f"ALL_PLATE, 3, 3, {-DEPTH}")
    sets = {"ALL_PLATE": np.arange(len(plate.nodes)) + len(ground.nodes)}
    parts = [(ground, (YOUNG, nu)), (plate, (YOUNG, nu))]
    return solid_deck(parts, pair("GROUND_DISK", "PLATE_BOTTOM", mu), step(supports, 5), sets), np.unique(ground.elements[ground.element_sets["GROUND_D"]][:, 4:])


def punch_revolved(n: int, nu: float, mu: float) -> tuple[str, Floats]:
    """The same by CAX4, n elements over the radius; the nodes of the surface come back."""
    ground = flatten(sheet("GROUND", graded(FAR, 1 / n, n + 4, 30), -graded(FAR, 1 / n, 4, 30)[::-1]))
    tool = flatten(sheet("TOOL", np.linspace(0, 1, n + 1), [0.0, 1.0]))
    tool.node_sets["ALL_TOOL"] = np.arange(len(tool.nodes))
    cards = fix("GROUND_BOTTOM, 2", "GROUND_LEFT, 1", "ALL_TOOL, 1", f"ALL_TOOL, 2, 2, {-DEPTH}")
    parts = [(ground, (YOUNG, nu)), (tool, (YOUNG, nu))]
    return flat_deck(parts, "CAX4", pair("GROUND_TOP", "TOOL_BOTTOM", mu) + step(cards, 5)), ground.along("GROUND_TOP")


def judge_punch(case: Case, job: Job, slaves: Floats, nu: float, mu: float, n: int) -> tuple[Floats, Floats, float]:
    """Radii, pressures over the mean one, and the force; checks the edge of stick at three loads."""
    axis, share = (2, 0.25) if np.abs(job.points[:, 2]).max() > 0 else (1, 1.0)
    r = np.hypot(job.points[slaves, 0], job.points[slaves, 3 - axis])
    force = float(np.abs(job.last("CNORMF")[slaves, axis]).sum() / share)
    if mu > 0:
        for frame in (1, 3, 5):
            status = job.field("CSTATUS")[frame, slaves]
            edge = 0.5 * (r[status == 1].max() + r[(status == 2) & (r > 0)].min())
            when = f"{job.times[frame]:g}, {n} elements"
            case.near("c/a", edge, reference(nu, mu).stick_radius, 1 / n, why="one element", time=when, scale=1.0, place="edge of the stick zone")
    return r, job.last("CPRESS")[slaves] / (force / np.pi), force


PUNCHES = [(0.3, 0.0), (0.2, 0.3), (0.3, 0.2), (0.4, 0.1)]


@pytest.mark.parametrize("kind", [pytest.param("C3D8", marks=pytest.mark.slow), "CAX4"])
@pytest.mark.parametrize(("nu", "mu"), [PUNCHES[0], *(pytest.param(*row, marks=pytest.mark.slow) for row in PUNCHES[1:])])
def test_flat_punch(proof: Proof, nu: float, mu: float, kind: str) -> None:
    """A rigid circular punch: without friction in closed form, with it against boundary elements; two meshes."""
    wanted = reference(nu, mu)
    of_what = "without friction" if mu == 0 else f"with friction: Spence, nu = {nu:g}, mu = {mu:g}"
    size = "a quarter of it in space, C3D8" if kind == "C3D8" else "CAX4"
    case = proof(
        f"circular-punch-nu{nu:g}-mu{mu:g}-{kind.lower()}".replace(".", ""),
        title=f"Circular flat punch {of_what}, {kind}",
        model=f"A rigid flat punch of radius a = 1 is pressed by {DEPTH:g} in 5 increments into an elastic half space (E = {YOUNG:g}, nu = {nu:g}; "
        f"{FAR:g} a wide and deep), mu = {mu:g}, {size}, 10 and 20 elements over the radius, small displacements. Slave: the half space.",
        formula="P = 2 E a d/(1 - nu^2), p = P/(2 pi a sqrt(a^2 - r^2))." if mu == 0 else
        f"Stick in r < c = {wanted.stick_radius:.3f} a at every load, P = {wanted.force * (1 - nu) / 4:.4f} times that without friction, by boundary "
        "elements of 200 rings (`verify/independent/half_space.py`); they give P = 4 G a d ln(3 - 4 nu)/(1 - 2 nu) where nothing slips.",
        source="Johnson, Contact Mechanics (1985) ch. 3" if mu == 0 else "Spence, J. Elasticity 5 (1975) 297; Johnson (1985) ch. 5",
        proves="Pressing with friction over a circle: stick inside, slip outside, from the first increment on, the same at all loads.",
    )  # fmt: skip
    forces = []
    for n in (10, 20):
        deck, slaves = punch_in_space(n // 2, nu, mu) if kind == "C3D8" else punch_revolved(n, nu, mu)
        r, p, force = judge_punch(case, case.run(deck, f"{n} elements", requested=5), slaves, nu, mu, n)
        forces.append(force / (wanted.force * YOUNG / (2 * (1 + nu)) * DEPTH))
    case.near("force", forces[1], 1.0, 0.03, why=f"an edge in steps of a/20, a half space of {FAR:g} a", time="20 elements", scale=1.0,
              place="all slave nodes", order=f"{observed_order([abs(f - 1) for f in forces]):.1f}")  # fmt: skip
    case.within("finer over coarser error of the force", (forces[1] - 1) / (forces[0] - 1), (0.0, 1.0), why="convergence",
                place="all slave nodes", time="the end")  # fmt: skip
    within = (r > 0.1) & (r < 0.7)
    expected = np.interp(r[within], wanted.r, wanted.p) * np.pi / wanted.force
    case.near("pressure over its mean", p[within], expected, 0.04, why="an edge node stands for half an element outside; as the force", place="0.1 a < r < 0.7 a",
              time="the end")  # fmt: skip
    inner = r <= 1 + 1e-9
    case.figure(lambda: punch_figure(r[inner], p[inner], wanted), "Pressure over the mean pressure; line: the reference.")
    case.done()


def punch_figure(r: Floats, p: Floats, wanted: Punch) -> object:
    """Pressure over the mean one."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.4))
    axes = figure.subplots()
    axes.plot(wanted.r, wanted.p * np.pi / wanted.force, "k-", lw=1)
    axes.plot(r, p, "o", ms=3)
    axes.axvline(wanted.stick_radius, color="k", lw=0.7, ls=":")
    axes.set(xlabel="r/a", ylabel="pressure / mean pressure", ylim=(0, 3))
    return figure


# ------------------------------------------------------------------------------------------ two balls

RADIUS, SHEAR, NU, MU = 100.0, 200.0, 0.42, 0.4
PRESS, SIDE = 0.0186, 0.0084  #: of the upper plane, so that a = 1 and Q = 7/8 mu P
HIGH = 8.0  #: of each body; it is as wide to each side
FINE = 0.1  #: elements at the contact


def ball_part(name: str, fine: float, is_above: bool) -> Mesh:
    """Half a block, y > 0, whose lower (upper) side is a paraboloid; elements of `fine` within 1.2 of the pole."""
    n = round(1.2 / fine)
    x, t = graded(HIGH, fine, n, 6), graded(1.0, fine / HIGH, 2, 7)
    line = np.concatenate([-x[:0:-1], x])
    mesh = block(line, x, t if is_above else -t[::-1], name)
    bulge = (mesh.nodes[:, 0] ** 2 + mesh.nodes[:, 1] ** 2) / (2 * RADIUS)
    w = mesh.nodes[:, 2]
    mesh.nodes[:, 2] = np.sign(w + (0.5 if is_above else -0.5)) * bulge * (1 - np.abs(w)) + w * HIGH
    middle = mesh.nodes[mesh.elements].mean(axis=1)
    side = "BOTTOM" if is_above else "TOP"
    facets = mesh.element_sets[f"{name}_E1" if is_above else f"{name}_E2"]
    near = facets[(np.abs(middle[facets, 0]) < 1.2) & (middle[facets, 1] < 1.2)]
    mesh.element_sets[f"{name}_NEAR"] = near
    mesh.surfaces = {f"{name}_{side}": [(f"{name}_NEAR", 1 if is_above else 2)]}
    mesh.node_sets[f"{name}_MIDDLE"] = np.flatnonzero(np.abs(mesh.nodes[:, 1]) < 1e-9)
    return mesh


def mindlin_shear(r: Floats, a: float, turns: list[float]) -> Floats:
    """Shear over mu p0 after a history of f = Q/(mu P): loading by Cattaneo, each turn adds twice that of half the change."""

    def ball(c: float) -> Floats:
        return (c / a) * np.sqrt(np.maximum(0, 1 - (r / c) ** 2))

    q = np.sign(turns[0]) * (ball(a) - ball(a * np.cbrt(1 - abs(turns[0]))))
    for old, new in zip(turns[:-1], turns[1:], strict=True):
        q = q + np.sign(new - old) * 2 * (ball(a) - ball(a * np.cbrt(1 - abs(new - old) / 2)))
    return q


@pytest.mark.slow
def test_cattaneo_mindlin_balls(proof: Proof) -> None:
    """Two balls pressed, then sheared to, fro and to."""
    fine = FINE
    case = proof(
        "cattaneo-mindlin-balls",
        title="Partial slip of two balls: Cattaneo and Mindlin, a whole cycle",
        model=f"Two equal balls R = 100 (paraboloids; blocks {HIGH:g} a high and as wide to each side), G = 200, nu = 0.42, mu = {MU:g}; by symmetry "
        f"their halves y > 0; C3D8 of {fine:g} at the contact (a/10), small displacements. Step 1 presses the upper plane by {PRESS:g} (3 increments) "
        f"so that a = 1; step 2 shifts it by {SIDE:g} (5), so that Q = 7/8 mu P and c = a/2; step 3 to {-SIDE:g} (10), step 4 to {SIDE:g} again (10).",
        formula="From the forces P and Q found, f = Q/(mu P): a = (3 P R/(8 E\\*))^(1/3), E\\* = E/(2 (1 - nu^2)), stick in r < c = a (1 - f)^(1/3), "
        "q = mu p0 [sqrt(1 - r^2/a^2) - (c/a) sqrt(1 - r^2/c^2)]; each turn adds twice this for half the change of f. Energy lost in a "
        "cycle: 24/5 K mu P {1 - (1 - f)^(5/3) - (5 f/6) [1 + (1 - f)^(2/3)]}, K = 3 mu P (2 - nu)/(8 a G).",
        source="Cattaneo (1938); Mindlin and Deresiewicz, J. Appl. Mech. 20 (1953) 327; the set of numbers: Kalker (1990) sec. 5.2.1.1",
        proves="Partial slip in space, slips in all directions, with memory through two reversals, and the work of friction.",
    )
    upper, lower = ball_part("UPPER", fine, True), ball_part("LOWER", fine, False)
    still = fix("LOWER_BOTTOM, 1, 3", "LOWER_MIDDLE, 2", "UPPER_MIDDLE, 2", "UPPER_TOP, 1, 2", f"UPPER_TOP, 3, 3, {-PRESS}")
    steps = step(still, 3) + "".join(step(fix(f"UPPER_TOP, 1, 1, {u}"), n) for u, n in ((SIDE, 5), (-SIDE, 10), (SIDE, 10)))
    young = 2 * SHEAR * (1 + NU)
    deck = solid_deck([(upper, (young, NU)), (lower, (young, NU))], pair("UPPER_BOTTOM", "LOWER_TOP", MU), steps)
    job = case.run(deck, requested=28)
    slaves = np.unique(upper.elements[upper.element_sets["UPPER_NEAR"]][:, :4])
    force = 2 * job.field("RF")[:, upper.node_sets["UPPER_TOP"]].sum(axis=1)
    first = job.frame(1.0)
    load = -float(force[first, 2])
    a = (3 * load * RADIUS * (1 - NU**2) / (4 * young)) ** (1 / 3)
    p0 = 3 * load / (2 * np.pi * a**2)
    r, p = np.hypot(job.points[slaves, 0], job.points[slaves, 1]), job.field("CPRESS")[first, slaves]
    case.near("a", a, 1.0, 0.01, why="the press was chosen so", time="1", place="edge of contact")
    case.near("pressure", p[r < 0.8], p0 * np.sqrt(1 - (r[r < 0.8] / a) ** 2), 0.03, why="elements of a/10", place="r < 0.8 a", time="1", scale=p0)
    turns: list[float] = []
    for number, name in enumerate(("loaded", "reversed", "forth again")):
        frame = job.frame(2.0 + number)
        turns.append(float(force[frame, 0] / (-MU * force[frame, 2])))
        judge_shear(case, job, frame, slaves, a, p0, turns, fine, name)
    lost = 2 * (job.history["friction_work"][-1] - job.history["friction_work"][job.history["step"] == 2][-1])
    f, k = abs(turns[0]), 3 * MU * load * (2 - NU) / (8 * a * SHEAR)
    cycle = 24 / 5 * k * MU * load * (1 - (1 - f) ** (5 / 3) - 5 * f / 6 * (1 + (1 - f) ** (2 / 3)))
    case.near("work of friction over the cycle", lost, cycle, 0.1, why="goes with the cube of the slip zone's width, known to an element",
              place="whole contact", time="the cycle")  # fmt: skip
    case.near("Q/(mu P) when reversed", turns[1], -turns[0], 0.01, why="Masing: the loop is symmetric",
              place="whole contact", time="the end of the reversal")  # fmt: skip
    case.done()


def judge_shear(
    case: Case, job: Job, frame: int, slaves: Floats, a: float, p0: float, turns: list[float], fine: float, name: str
) -> None:
    """The edge of stick and the shear along the sliding direction."""
    x, y = job.points[slaves, 0], job.points[slaves, 1]
    r = np.hypot(x, y)
    change = abs(turns[-1] - turns[-2]) / 2 if len(turns) > 1 else abs(turns[0])
    c = a * np.cbrt(1 - change)
    stuck = r[job.field("CSTATUS")[frame, slaves] == 1]
    case.near("edge of stick", stuck.max(), c, fine / c, why="one element", time=name, place="edge of the stick zone")
    q = job.field("CSHEAR")[frame, slaves, 0]
    expected = MU * p0 * mindlin_shear(r, a, turns)
    sign = np.sign((q * expected).sum())
    smooth = r < c - 1.5 * fine
    why = "cross slip is neglected by the theory (5 to 10 % of mu p0 across), bodies 8 a wide"
    case.near("shear over mu p0", sign * q[smooth], expected[smooth], 0.05, why=why, place="where it sticks", time=name, scale=MU * p0)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_boundary_elements(nu: float) -> None:
    """The reference itself: the two closed forms that there are, without friction and without slip."""
    assert solve_punch(nu, 0.0, 100).force == pytest.approx(4 / (1 - nu), rel=1e-4)
    assert solve_punch(nu, 1e9, 100).force == pytest.approx(4 * np.log(3 - 4 * nu) / (1 - 2 * nu), rel=1e-3)
