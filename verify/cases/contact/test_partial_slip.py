"""Partial slip: Cattaneo and Mindlin, loading and reversal, and Spence.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.special import ellipk

from verify.cases.proof import Case, Job
from verify.decks.make_decks import Mesh, graded, join
from verify.decks.sheets import Floats, both_directions, fix, pair, plane_deck, rows_of, sheet, step

Proof = Callable[..., Case]

RADIUS, YOUNG, NU, MU = 8.0, 200.0, 0.3, 0.2
FAR = 1000.0  #: size of a half space, over the half width of the punch


def cylinders(fine: float) -> tuple[Mesh, Mesh]:
    """Two equal arcs, one above the other, touching in the origin; grid lines of both meet."""
    s, t = both_directions(graded(4.0, fine, round(0.8 / fine), 8)), graded(1.0, fine / 6, 5, 10)

    def above(x: Floats, w: Floats) -> tuple[Floats, Floats]:
        return x, (RADIUS - np.sqrt(RADIUS**2 - x**2)) * (1 - w) + 6.0 * w

    def below(x: Floats, w: Floats) -> tuple[Floats, Floats]:
        return x, -above(x, -w)[1]

    return sheet("UPPER", s, t, above), sheet("LOWER", s, -t[::-1], below)


def mindlin(x: Floats, a: float, peak: float, turns: list[float]) -> Floats:
    """Shear over the peak of mu p after a history of f = Q/(mu P): the load turns at turns[:-1] and is now turns[-1].

    Loading is Cattaneo's; each turn adds twice Cattaneo's solution of half the change, in the opposite direction (Mindlin and
    Deresiewicz 1953). Valid while each branch stays inside the one before.
    """

    def ellipse(c: float) -> Floats:
        return (c / a) * np.sqrt(np.maximum(0, 1 - (x / c) ** 2))

    q = ellipse(a) - ellipse(a * np.sqrt(1 - abs(turns[0])))
    sign = np.sign(turns[0])
    q = sign * q
    for old, new in zip(turns[:-1], turns[1:], strict=True):
        c = a * np.sqrt(1 - abs(new - old) / 2)
        q = q + np.sign(new - old) * 2 * (ellipse(a) - ellipse(c))
    return peak * q


@pytest.mark.slow
def test_cattaneo_mindlin(proof: Proof) -> None:
    """Cylinders pressed, then sheared, then sheared back and forth; two meshes."""
    case = proof(
        "cattaneo-mindlin",
        title="Partial slip of two cylinders: Cattaneo and Mindlin, with reversals",
        model="Two equal cylinders R = 8, E = 200, nu = 0.3, mu = 0.2 (each an arc with columns up to x = 4, 6 high), plane strain, "
        "C3D8 of 0.05 and 0.025 at the contact (a/13, a/26); NLGEOM. Step 1 presses by 0.15 (5 increments), step 2 shifts the top by "
        "0.023 (5), step 3 back to -0.010 (10), step 4 forth to 0.015 (10).",
        formula="From the forces P and Q found: a = sqrt(2 P R/(pi E\\*)), E\\* = E/(2 (1 - nu^2)), stick in |x| < c = a sqrt(1 - Q/(mu P)), "
        "q = mu p0 [sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2)]; each turn adds twice this solution for half the change of Q.",
        source="Cattaneo (1938); Mindlin (1949); Mindlin and Deresiewicz, J. Appl. Mech. 20 (1953) 327",
        proves="Stick and slip side by side, with memory of the slip: the shear after two reversals.",
    )
    errors = [shear_errors(case, fine) for fine in (0.05, 0.025)]
    for number, (name, _) in enumerate(TURNS):
        case.within(f"shear ({name}), finer over coarser error", errors[1][number] / errors[0][number], (0.0, 1.2), why="where it sticks",
                    place="stick zone", time="the end of the step")  # fmt: skip
    case.done()


#: What step 2, 3, 4 do: the top's displacement and the increments.
TURNS = [("loaded", (0.023, 5)), ("reversed", (-0.010, 10)), ("forth again", (0.015, 10))]


def shear_errors(case: Case, fine: float) -> list[float]:
    """L2 error of the shear where it sticks, after each step; checks edges, pressure, shear."""
    upper, lower = cylinders(fine)
    press = fix("LOWER_BOTTOM, 1, 3", "UPPER_TOP, 1", "UPPER_TOP, 3, 3, -0.15")
    steps = step(press, 5, True) + "".join(step(fix(f"UPPER_TOP, 1, 1, {u}"), n, True) for _, (u, n) in TURNS)
    parts = [(upper, (YOUNG, NU)), (lower, (YOUNG, NU))]
    job = case.run(plane_deck(parts, pair("UPPER_BOTTOM", "LOWER_TOP", MU), steps), f"elements of {fine:g}", requested=30)
    mesh = join([upper, lower])
    slaves = rows_of(mesh, "UPPER_BOTTOM")
    turns: list[float] = []
    curves, errors = [], []
    for number, (name, _) in enumerate(TURNS):
        frame = job.frame(2.0 + number)
        force = job.field("RF")[frame, mesh.node_sets["UPPER_TOP"]].sum(axis=0)
        turns.append(float(force[0] / (MU * force[2])))
        x, found, expected, error = compare(case, job, frame, slaves, -float(force[2]), turns, fine, name)
        curves.append((name, x, found, expected))
        errors.append(error)
    case.figure(lambda: shear_figure(curves), f"Shear over the contact, elements of {fine:g}; lines: Mindlin and Deresiewicz.")
    return errors


def compare(
    case: Case, job: Job, frame: int, slaves: Floats, force: float, turns: list[float], fine: float, name: str
) -> tuple[Floats, Floats, Floats, float]:
    """Shear and stick zone at one time."""
    x = job.points[slaves, 0]
    modulus = YOUNG / (1 - NU**2) / 2
    a = np.sqrt(2 * force * RADIUS / (np.pi * modulus))
    p0 = 2 * force / (np.pi * a)
    last = turns[-1] - turns[-2] if len(turns) > 1 else 2 * turns[0]
    c = a * np.sqrt(1 - abs(last) / 2)
    when = f"{name}, elements of {fine:g}"
    stuck = np.abs(x[job.field("CSTATUS")[frame, slaves] == 1])
    case.near("edge of stick", stuck.max(), c, fine / c, why="one element", time=when, place="edge of the stick zone")
    near = np.abs(x) < 1.2 * a
    q, expected = job.field("CSHEAR")[frame, slaves, 0][near], mindlin(x[near], a, MU * p0, turns)
    p, ellipse = job.field("CPRESS")[frame, slaves][near], p0 * np.sqrt(np.maximum(0, 1 - (x[near] / a) ** 2))
    case.near("pressure (L2)", l2(x[near], p, ellipse), 0.0, 0.03, why="a is an element off at most", time=when, scale=1.0, place="x < 1.2 a")
    smooth = np.abs(x[near]) < min(a * np.sqrt(1 - abs(f)) for f in [turns[0], last / 2]) - 1.5 * fine
    why = "the bodies are 6 a wide and 9 a high"
    case.near("shear over mu p0", q[smooth], expected[smooth], 0.03, why=why, place="where it sticks", time=when, scale=MU * p0)
    return x[near], q / (MU * p0), expected / (MU * p0), l2(x[near][smooth], q[smooth], expected[smooth])


def l2(x: Floats, found: Floats, expected: Floats) -> float:
    """Relative error in the mean square."""
    return float(np.sqrt(np.trapezoid((found - expected) ** 2, x) / np.trapezoid(expected**2, x)))


def shear_figure(curves: list[tuple[str, Floats, Floats, Floats]]) -> object:
    """Shear over mu p0."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.5, 3.8))
    axes = figure.subplots()
    for number, (name, x, found, expected) in enumerate(curves):
        axes.plot(x, expected, "-", color=f"C{number}", lw=1)
        axes.plot(x, found, "o", color=f"C{number}", ms=3, label=name)
    axes.set(xlabel="x", ylabel="shear / (mu p0)")
    axes.legend()
    return figure


def stick_of_goodman(nu: float, mu: float) -> float:
    """c/a of a rigid flat punch without the coupling of shear to pressure: K'(c/a)/K(c/a) = beta/mu."""
    beta = (1 - 2 * nu) / (2 * (1 - nu))
    low, high = 1e-9, 1 - 1e-12
    for _ in range(200):
        k = 0.5 * (low + high)
        low, high = (k, high) if ellipk(1 - k * k) / ellipk(k * k) > beta / mu else (low, k)
    return low


#: nu, mu, c/a with the coupling, from a boundary element solution of 400 to 1200 graded strips (+-0.003)
SPENCE = [(0.0, 0.5, 0.523), (0.2, 0.3, 0.435), (0.3, 0.3, 0.690), (0.3, 0.5, 0.941), (0.4, 0.1, 0.279)]


def punch(nu: float, mu: float, n: int, n_increments: int) -> str:
    """A rigid flat punch |x| < 1, n cells on its half width, on a block FAR x FAR (its right half by symmetry)."""
    ground = sheet("GROUND", graded(FAR, 1 / n, n + 4, 22), -graded(FAR, 1 / n, n // 4, 24)[::-1])
    tool = sheet("TOOL", np.linspace(0, 1, n + 1), [0.0, 1.0])
    cards = fix("GROUND_BOTTOM, 1, 3", "GROUND_LEFT, 1", "TOOL, 1", "TOOL, 3, 3, -0.001")
    parts = [(ground, (1000.0, nu)), (tool, (1000.0, nu))]
    sets = {"TOOL": np.arange(len(tool.nodes)) + len(ground.nodes)}
    return plane_deck(parts, pair("GROUND_TOP", "TOOL_BOTTOM", mu), step(cards, n_increments), sets)


@pytest.mark.parametrize(("nu", "mu", "expected"), [SPENCE[0], *(pytest.param(*row, marks=pytest.mark.slow) for row in SPENCE[1:])])
def test_spence(proof: Proof, nu: float, mu: float, expected: float) -> None:
    """A rigid flat punch with friction: the stick zone is the same at all loads."""
    n = 40
    case = proof(
        f"spence-nu{nu:g}-mu{mu:g}".replace(".", ""),
        title=f"Flat punch with friction: Spence, nu = {nu:g}, mu = {mu:g}",
        model=f"The right half of a rigid flat punch, half width a = 1, {n // 2} and {n} elements on it, pressed by 0.001 in 5 increments into an "
        f"elastic block of 1000 a x 1000 a (E = 1000, nu = {nu:g}), plane strain, C3D8, small displacements, mu = {mu:g}. Slave: the block.",
        formula=f"Stick in |x| < c, c/a = {expected:.3f} independent of the load, from a boundary element solution of the coupled "
        f"problem. Without the coupling K'(c/a)/K(c/a) = beta/mu, beta = (1 - 2 nu)/(2 (1 - nu)), gives {stick_of_goodman(nu, mu):.3f}.",
        source="Spence, Proc. R. Soc. A 305 (1968) 55; Johnson, Contact Mechanics (1985) ch. 5",
        proves="Friction under a pressing load: sticking and slipping side by side from the first increment on, self-similar.",
    )
    coarse = case.run(punch(nu, mu, n // 2, 5), f"{n // 2} elements", requested=5)
    case.near("c/a", stick_edge(coarse, n // 2, 5), expected, 2.0 / n, why="one element of the coarser mesh, first order", time="the end", scale=1.0,
              place="edge of the stick zone")  # fmt: skip
    job = case.run(punch(nu, mu, n, 5), requested=5)
    slaves = ground_top(n)
    x, status = job.points[slaves, 0], job.last("CSTATUS")[slaves]
    for frame in (1, 3, 5):
        case.near("c/a", stick_edge(job, n, frame), expected, 1.0 / n, why="one element", time=f"{job.times[frame]:g}", scale=1.0,
                  place="edge of the stick zone")  # fmt: skip
    force = -job.last("CNORMF")[slaves, 2]
    shear = np.abs(job.last("CSHEARF")[slaves, 0])
    slipping = status == 2
    case.near("friction over mu N", shear[slipping], mu * np.abs(force[slipping]), 1e-6, why="slip: equality", place="slip zone", time="the end")
    ratio = shear / np.maximum(np.abs(force), 1e-30) / mu
    case.figure(lambda: ratio_figure(x[x <= 1], ratio[x <= 1], expected), "Shear over mu times pressure; the line is c/a.")
    case.done()


def ground_top(n: int) -> Floats:
    """The nodes of the ground's top."""
    return rows_of(sheet("GROUND", graded(FAR, 1 / n, n + 4, 22), -graded(FAR, 1 / n, n // 4, 24)[::-1]), "GROUND_TOP")


def stick_edge(job: Job, n: int, frame: int) -> float:
    """The middle between the last node that sticks and the first that slips."""
    slaves = ground_top(n)
    x, status = job.points[slaves, 0], job.field("CSTATUS")[frame, slaves]
    return float(0.5 * (x[status == 1].max() + x[status == 2].min()))


def ratio_figure(x: Floats, ratio: Floats, edge: float) -> object:
    """How much of the friction is used."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.2))
    axes = figure.subplots()
    axes.plot(x, ratio, "o-", ms=3, lw=0.7)
    axes.axvline(edge, color="k", lw=1)
    axes.set(xlabel="x/a", ylabel="shear / (mu p)")
    return figure


def test_flat_punch(proof: Proof) -> None:
    """Without friction: the pressure of the half space below a rigid flat punch; two meshes."""
    case = proof(
        "flat-punch",
        title="Rigid flat punch without friction",
        model="As the case of Spence, nu = 0.3, mu = 0, with 20 and 40 elements on the half width a; pressed by 0.001 in 5 increments.",
        formula="p = P/(pi sqrt(a^2 - x^2)) with P the force found; singular at the edge, which is left out.",
        source="Johnson, Contact Mechanics (1985) sec. 2.8",
        proves="Pressure under a sharp edge, and its convergence.",
    )
    errors, curves = [], []
    for n in (20, 40):
        job = case.run(punch(0.3, 0.0, n, 5), f"{n} elements", requested=5)
        ground = sheet("GROUND", graded(FAR, 1 / n, n + 4, 22), -graded(FAR, 1 / n, n // 4, 24)[::-1])
        slaves = rows_of(ground, "GROUND_TOP")
        x, p = job.points[slaves, 0], job.last("CPRESS")[slaves]
        force = 4 * np.abs(job.last("CNORMF")[slaves, 2]).sum()
        inner = x < 0.8
        expected = force / (np.pi * np.sqrt(1 - x[inner] ** 2))
        errors.append(float(np.abs(p[inner] / expected - 1).max()))
        curves.append((n, x[inner], p[inner] / force))
        case.near("pressure", p[0], expected[0], 0.02, why="elements at the edge", place="x = 0", time=f"{n} elements")
    order = np.log2(errors[0] / errors[1])
    case.near("pressure", errors[1], 0.0, 0.02, why="first order at a singular edge", place="x < 0.8 a", scale=1.0, order=f"{order:.1f}",
              time="the end")  # fmt: skip
    case.within("observed order", float(order), (0.75, 2.5), why="first order at a singular edge, two meshes", place="x < 0.8 a", time="the end")
    case.done()
