"""CPS4I, CPE4I and CAX4I: bending of rectangles, tubes, Cook's membrane, plastic bending and what stays after it, warmth, rubber,
restart.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.elastic.test_plane_and_discrete_elements import Sheet, material, sheet, square, supports
from verify.cases.proof import Case, observed_order
from verify.conftest import Run
from verify.independent.results import read_field

Proof = Callable[..., Case]
YOUNG, LENGTH, DEPTH, WIDTH = 1000.0, 10.0, 1.0, 0.5
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-10, , , 1e-10\n"


def bar(kind: str, cells: int, rows: int = 1) -> Sheet:
    """A bar 10 x 1 about its axis, `rows` elements over the depth."""
    return sheet(kind[:3], kind[3:], (cells, rows), lambda u, v: (LENGTH * u, DEPTH * (v - 0.5)))


def held(body: Sheet) -> str:
    """The root: no displacement along the bar, its lowest node none across."""
    root = body.where(0, 0.0)
    return supports(root, 1) + supports([n for n in root if body.nodes[n, 1] < 0.01 - DEPTH / 2], 2)


def moment(body: Sheet, force: float) -> str:
    """A couple of two forces at the end; the upper one pushes."""
    end = [n for n in body.where(0, 1.0) if abs(body.nodes[n, 1]) > 0.49 * DEPTH]
    return "*CLOAD\n" + "".join(f"{n + 1}, 1, {-force * np.sign(body.nodes[n, 1]):.17g}\n" for n in end)


def steps(*loads: str, is_nlgeom: bool = False, increment: float = 1.0) -> str:
    """A step for each set of loads."""
    return "".join(f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC, DIRECT\n{increment}, 1.\n{TIGHT}{load}*END STEP\n" for load in loads)


@pytest.mark.parametrize(("kind", "nu"), [("CPS4I", 0.3), ("CPE4I", 0.3), ("CPE4I", 0.4999), ("CPS4", 0.3), ("CPE4", 0.4999)])
def test_bending_in_the_plane(proof: Proof, kind: str, nu: float) -> None:
    """One element over the depth under a constant moment: exact with modes; without them too stiff, and said to be so."""
    has_modes = kind.endswith("I")
    case = proof(
        f"plane-modes-bending-{kind.lower()}-{nu:g}",
        title=f"Bending in the plane with one element over the depth: {kind}",
        model=f"A bar {LENGTH:g} x {DEPTH:g} of thickness {WIDTH:g}, E = {YOUNG:g}, nu = {nu:g}, of one and of five {kind} along it, one over the depth. "
        "Its root is held along the bar and may contract; a couple of forces of 0.1 acts at the end. Small displacements.",
        formula="Constant moment M = 0.1: deflection M l^2/(2 E' I), E' = E in plane stress, E/(1 - nu^2) in plane strain; stress M y/I, the "
        "same along the bar; no stress across it.",
        source="S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed., section 22",
        proves="Rectangles with incompatible modes bend as beams, nearly incompressible ones too. Without modes the same mesh is too stiff."
        if has_modes else "Without modes the bar is too stiff: the test can fail.",
    )  # fmt: skip
    modulus = YOUNG / (1 - nu**2) if kind.startswith("CPE") else YOUNG
    inertia = WIDTH * DEPTH**3 / 12
    for cells in (1, 5):
        body = bar(kind, cells)
        job = case.run(body.cards() + material(YOUNG, nu, WIDTH) + held(body) + steps(moment(body, 0.1)), f"{cells} along", requested=1)
        end = [n for n in body.where(0, 1.0) if body.nodes[n, 1] < 0]
        ratio = job.last("U")[end[0], 1] / (0.1 * LENGTH**2 / (2 * modulus * inertia))
        if not has_modes:
            case.within("deflection over that of the beam", ratio, (0.001, 0.9), why="a bilinear rectangle shears where it should bend", place="end", time="the end")
            continue
        case.near("deflection over that of the beam", ratio, 1.0, 1e-7, why="exact but for the conditioning at nu = 0.4999", place="end", time="the end")
        stress = job.last("S")
        case.near("stress along the bar", stress[:, 0], -0.1 * body.nodes[:, 1] / inertia, 1e-7, why="exact", place="all nodes", time="the end")
        case.near("stress across the bar", stress[:, 1], 0.0, 1e-7, scale=1.2, why="exact", place="all nodes", time="the end")
    case.done()


@pytest.mark.parametrize(("kind", "expected"), [("CPS4I", (21.05, 23.02)), ("CPS4", None)])
def test_cooks_membrane(proof: Proof, kind: str, expected: tuple[float, float] | None) -> None:
    """Cook's membrane: published displacements of this element on coarse meshes, and convergence."""
    case = proof(
        f"plane-modes-cook-{kind.lower()}",
        title=f"Cook's membrane: {kind}",
        model="A panel with corners (0, 0), (48, 44), (48, 60), (0, 44), E = 1, nu = 1/3, plane stress, held at its left side, a shear force of 1 "
        f"spread evenly over its right side; 2 x 2 to 16 x 16 {kind}. Small displacements.",
        formula="The middle of the right side rises by 21.05 with 2 x 2 and by 23.02 with 4 x 4 elements with these modes; 23.96 is the limit.",
        source="R. D. Cook, D. S. Malkus, M. E. Plesha, R. J. Witt, Concepts and Applications of Finite Element Analysis, 4th ed. (limit); the element "
        "QM6 of Taylor, Beresford and Wilson (1976) in the comparisons of later papers (2 x 2, 4 x 4)",
        proves="The modes are those of the literature, on distorted elements too.",
    )
    found = {}
    for n in (2, 4, 8, 16):
        body = sheet(kind[:3], kind[3:], (n, n), lambda u, v: (48 * u, 44 * u * (1 - v) + v * (44 + 16 * u)))
        weights = np.zeros(len(body.nodes))
        for element, edge in body.edges(0, 1.0):
            nodes = body.elements[element]
            weights[[nodes[edge - 1], nodes[edge % 4]]] += 0.5 / n
        load = "*CLOAD\n" + "".join(f"{k + 1}, 2, {w:.17g}\n" for k, w in enumerate(weights) if w > 0)
        deck = body.cards() + material(1.0, 1 / 3) + supports(body.where(0, 0.0), 1, 2) + steps(load)
        middle = int(np.argmin(np.abs(body.uv - [1, 0.5]).sum(axis=1)))
        found[n] = case.run(deck, f"{n} x {n}", requested=1).last("U")[middle, 1]
    if expected is None:
        case.within("rise with 2 x 2", found[2], (10.0, 13.0), why="about 11.8 is published for the bilinear element", place="middle", time="the end")
    else:
        for n, value in zip((2, 4), expected, strict=True):
            case.near(f"rise with {n} x {n}", found[n], value, 3e-4, why="four digits are published", place="middle", time="the end")
        case.near("rise with 16 x 16", found[16], 23.96, 4e-3, why="the mesh", place="middle", time="the end")
        order = observed_order([23.96 - found[4], 23.96 - found[8]])
        case.within("order of convergence", order, (1.5, 2.5), why="second order, but for the corners", place="middle", time="the end")
    case.done()


@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_tube_under_pressure(proof: Proof, nu: float) -> None:
    """Lame's tube: displacements of the nodes are exact whatever the mesh, stresses converge with its square."""
    inner, outer, pressure = 1.0, 2.0, 10.0
    case = proof(
        f"plane-modes-tube-{nu:g}",
        title=f"Thick tube of CAX4I, nu = {nu:g}",
        model=f"A tube of radii {inner:g} and {outer:g}, E = {YOUNG:g}, nu = {nu:g}, held along its axis, under an inner pressure of {pressure:g}; 2, 4 and 8 CAX4I "
        "through the wall. Small displacements.",
        formula="Lame: A = p a^2/(b^2 - a^2); u = (1 + nu)/E (A (1 - 2 nu) r + A b^2/r); hoop stress A (1 + b^2/r^2), radial stress A (1 - b^2/r^2), "
        "axial stress 2 nu A.",
        source="S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed., section 28",
        proves="The radial mode with its hoop strain: nodes move exactly, nearly incompressible walls do not lock.",
    )  # fmt: skip
    a = pressure * inner**2 / (outer**2 - inner**2)
    errors = []
    for cells in (2, 4, 8):
        body = sheet("CAX", "4I", (cells, 1), lambda u, v: (1 + u, 0.2 * v))
        load = "*DLOAD\n" + "".join(f"{el + 1}, P{edge}, {pressure}\n" for el, edge in body.edges(0, 0.0))
        job = case.run(body.cards() + material(YOUNG, nu) + supports(range(len(body.nodes)), 2) + steps(load), f"{cells} cells", requested=1)
        r = body.nodes[:, 0]
        u = (1 + nu) / YOUNG * (a * (1 - 2 * nu) * r + a * outer**2 / r)
        case.near(f"radial displacement, {cells} cells", job.last("U")[:, 0], u, 1e-8, why="exact but for the conditioning", place="all nodes", time="the end")
        stress = job.last("S")
        case.near(f"axial stress, {cells} cells", stress[:, 1], 2 * nu * a, 1e-7, why="follows from the change of the area", place="all nodes", time="the end")
        bore = r < inner + 1e-9
        errors.append(float(np.abs(stress[bore, 0] + pressure).max()))
    case.near("radial stress at the bore", stress[bore, 0], -pressure, 0.01, why="8 cells", place="bore", time="the end")
    case.near("hoop stress at the bore", stress[bore, 2], a * (1 + (outer / inner) ** 2), 0.01, why="8 cells", place="bore", time="the end")
    order = observed_order(errors[1:])
    case.near("order of the stress", order, 2.0, 0.15, why="coarse meshes", place="bore", time="the end")
    case.done()


@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_tube_with_a_moment_at_its_edge(proof: Proof, nu: float) -> None:
    """A thin tube bent at its edge, one CAX4I through the wall: the deflection of the shell theory."""
    radius, wall, length = 100.0, 1.0, 60.0
    case = proof(
        f"plane-modes-edge-moment-{nu:g}",
        title=f"Thin tube with a moment at its edge: CAX4I, nu = {nu:g}",
        model=f"A tube of radius {radius:g}, wall {wall:g} and length {length:g}, E = 1e5, nu = {nu:g}, one CAX4I through the wall, 60 and 120 along it; a couple of axial "
        "forces of 1 per length of the circle at its end. Small displacements.",
        formula="beta^4 = 3 (1 - nu^2)/(R t)^2, D = E t^3/(12 (1 - nu^2)): the edge moves by M/(2 beta^2 D) across the wall.",
        source="S. P. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, 2nd ed., section 115",
        proves="CAX4I bends with one element through the wall.",
    )  # fmt: skip
    beta2 = np.sqrt(3 * (1 - nu**2)) / (radius * wall)
    expected = 1.0 * wall / (2 * beta2 * 1e5 * wall**3 / (12 * (1 - nu**2)))
    for cells in (60, 120):
        body = sheet("CAX", "4I", (1, cells), lambda u, v: (radius - wall / 2 + wall * u, length * v))
        end = body.where(1, 1.0)
        force = "*CLOAD\n" + "".join(f"{n + 1}, 2, {2 * np.pi * radius * np.sign(body.nodes[n, 0] - radius):.17g}\n" for n in end)
        job = case.run(body.cards() + material(1e5, nu) + supports(body.where(1, 0.0), 1, 2) + steps(force), f"{cells} along", requested=1)
        ratio = abs(job.last("U")[end, 0].mean()) / expected
        tolerance = 0.02 if cells == 120 else 0.03
        case.near(f"deflection over that of the shell, {cells} along", ratio, 1.0, tolerance, why="terms of t/R and of shear, the mesh", place="end", time="the end")
    case.done()


@pytest.mark.parametrize("is_nlgeom", [False, True], ids=["small", "nlgeom"])
@pytest.mark.parametrize("kind", ["CPS4I", "CPE4I"])
def test_what_stays_of_plastic_bending(proof: Proof, kind: str, is_nlgeom: bool) -> None:
    """Bent beyond yield and released, with one element over the depth: both layers of points keep their plastic strain, without a stress."""
    yield_stress, slope, force = 2.0, 250.0, 0.4
    case = proof(
        f"plane-modes-plastic-bending-{kind.lower()}-{'nlgeom' if is_nlgeom else 'small'}",
        title=f"Plastic bending and unloading with one {kind} over the depth" + (", NLGEOM" if is_nlgeom else ""),
        model=f"The bar {LENGTH:g} x {DEPTH:g} of five {kind}, thickness {WIDTH:g}, E = {YOUNG:g}, nu = 0.3, yield stress {yield_stress:g}, hardening {slope:g}: a couple of "
        f"{force:g} in ten increments, then none in ten.",
        formula="The points lie at y = +-h/(2 3^(1/2)), so that the moment is stress times b h^2/(2 3^(1/2)). The end is without load: no stress (plane strain: none "
        "along the bar); the strain across the bar is minus half the plastic strain along it in plane stress. Curvature and strain along the bar agree.",
        source="equilibrium; the flow rule of von Mises",
        proves="The amplitudes of the modes keep what has flowed; zero load does not bring them back.",
    )  # fmt: skip
    body = bar(kind, 5)
    law = f"*PLASTIC\n{yield_stress}, 0.\n{yield_stress + slope}, 1.\n*SOLID"
    deck = body.cards() + material(YOUNG, 0.3, WIDTH).replace("*SOLID", law) + held(body)
    loads = steps(moment(body, force), moment(body, 0.0), is_nlgeom=is_nlgeom, increment=0.1)
    job = case.run(deck + loads, requested=20)
    middle = job.frame(1.0)
    stress, strain = job.integration_points("S"), job.integration_points("E")
    lever = WIDTH * DEPTH**2 / (2 * np.sqrt(3))
    end = sorted(body.where(0, 1.0), key=lambda n: body.nodes[n, 1])
    arm = DEPTH + (np.diff(job.field("U")[middle][end, 1])[0] if is_nlgeom else 0.0)
    sizes = np.abs(stress[middle, :4, 0])
    case.near("stress under the moment", sizes.mean(), force * arm / lever, 3e-3 if is_nlgeom else 1e-6, why="statics; under NLGEOM the depth changes by 0.3 %",
              place="points of the root", time="1")  # fmt: skip
    if kind == "CPS4I" and not is_nlgeom:
        plastic = (force * DEPTH / lever - yield_stress) / slope
        case.near("plastic strain along the bar", np.abs(strain[-1, :, 0]), plastic, 1e-5, why="the curve of the material", place="all points", time="the end")
        case.near("strain across the bar", strain[-1, :, 1], -0.5 * strain[-1, :, 0], 1e-6, scale=plastic, why="plastic flow keeps the volume", place="all points",
                  time="the end")  # fmt: skip
    along = np.abs(stress[-1, :, 0])
    case.near("stress along the bar", along, 0.0, 2e-3 if is_nlgeom else 1e-7, scale=yield_stress, why="no load", place="all points", time="the end")
    curvature = np.abs(strain[-1, :, 0]).mean() * 2 * np.sqrt(3) / DEPTH
    angle = curvature * LENGTH
    deflection = (1 - np.cos(angle)) / curvature if is_nlgeom else curvature * LENGTH**2 / 2
    case.near("deflection of the end", abs(job.last("U")[end[0], 1]), deflection, 0.02 if is_nlgeom else 1e-6, why="an arc of this curvature", place="end", time="the end")
    case.done()


@pytest.mark.parametrize("kind", ["CPS4I", "CPE4I", "CAX4I"])
def test_warm_body(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Uniform warmth on a distorted mesh: a T of strain in all free directions, no stress but that of the held one."""
    body = sheet(kind[:3], "4I", (4, 3), square, 0.3)
    corner = int(np.argmin(np.abs(body.uv).sum(axis=1)))
    other = int(np.argmin(np.abs(body.uv - [1, 0]).sum(axis=1)))
    hold = supports([corner], 2) if kind == "CAX4I" else supports([corner], 1, 2) + supports([other], 2)
    if kind != "CAX4I":  # the lower side stays where it is, but for its length
        body.nodes[:, 1] -= 0.1 * body.uv[:, 0]
    deck = body.cards() + material(YOUNG, 0.3, WIDTH).replace("*SOLID", "*EXPANSION\n1e-4\n*SOLID") + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n"
    done = run_deck(deck + hold + steps("*TEMPERATURE\nNODES, 70.\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    warm = 1e-4 * 50
    stress, u = read_field(tmp_path / "job.vtkhdf", "S")[-1], read_field(tmp_path / "job.vtkhdf", "U")[-1]
    expected = np.zeros(6)
    free = warm
    if kind == "CPE4I":
        expected[2], free = -YOUNG * warm, warm * 1.3
    assert np.abs(stress - expected).max() <= 1e-8 * YOUNG * warm
    place = body.nodes[:, 0] if kind == "CAX4I" else body.nodes[:, 0] - body.nodes[corner, 0]
    assert u[:, 0] == pytest.approx(free * place, abs=1e-9 * warm)
    assert u[:, 1] == pytest.approx(free * (body.nodes[:, 1] - body.nodes[corner, 1]), abs=1e-9 * warm)


@pytest.mark.parametrize("kind", ["CPS4I", "CPE4I", "CAX4I"])
def test_rubber(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Neo-Hooke with nu = 0.495, pulled to twice its length on a distorted mesh: uniform; the stress of the closed form."""
    body = sheet(kind[:3], "4I", (4, 3), lambda u, v: (u, v))
    inner = (np.abs(body.uv - 0.5) < 0.49).all(axis=1)
    body.nodes[inner] += 0.3 * np.random.default_rng(5).uniform(-1, 1, (int(inner.sum()), 2)) / 4
    c10, d1, stretch = 0.5, 1e-2, 2.0
    law = f"*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n{c10}, {d1}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n1.\n"
    hold = supports(body.where(1, 0.0), 2) + supports(body.where(0, 0.0), 1)
    lid = "*BOUNDARY\n" + "".join(f"{n + 1}, 2, 2, {stretch - 1}\n" for n in body.where(1, 1.0))
    done = run_deck(body.cards() + law + hold + steps(lid, is_nlgeom=True, increment=0.1))
    assert done.returncode == 0, done.stdout + done.stderr
    stress = read_field(tmp_path / "job.vtkhdf", "S")[-1]
    assert np.abs(stress - stress[0]).max() <= 1e-6 * np.abs(stress[0]).max()
    u = read_field(tmp_path / "job.vtkhdf", "U")[-1]
    across = 1 + u[body.where(0, 1.0)[0], 0]
    assert u[:, 0] == pytest.approx((across - 1) * body.nodes[:, 0], abs=1e-8)
    third = {"CPS4I": across, "CPE4I": 1.0, "CAX4I": across}[kind]
    j = stretch * across * third
    b = np.array([across**2, stretch**2, third**2])
    expected = 2 * c10 * j ** (-5 / 3) * (b - b.mean()) + 2 / d1 * (j - 1)
    assert stress[0, :3] == pytest.approx(expected, abs=1e-6 * expected.max())
    assert expected[0] == pytest.approx(0.0, abs=1e-6)
    assert expected[1] == pytest.approx(2 * c10 * (stretch**2 - (0.25 if kind == "CPE4I" else 0.5)), rel=0.03)  # what is compressible


@pytest.mark.parametrize("kind", ["CPS4I", "CPE4I", "CAX4I"])
def test_dialects_agree(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """CalculiX has no such elements: both dialects compute them alike where the laws are alike (small displacements)."""
    found = []
    for dialect in ("abaqus", "calculix"):
        body = sheet(kind[:3], "4I", (3, 2), square, 0.3)
        load = "*BOUNDARY\n" + "".join(f"{n + 1}, 2, 2, 0.01\n" for n in body.where(1, 1.0))
        done = run_deck(body.cards() + material(YOUNG, 0.3) + supports(body.where(1, 0.0), 1, 2) + steps(load), f"--dialect={dialect}")
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(read_field(tmp_path / "job.vtkhdf", "S")[-1])
    assert found[1] == pytest.approx(found[0], abs=1e-12 * np.abs(found[0]).max())


@pytest.mark.parametrize("kind", ["CPS4I", "CPE4I", "CAX4I"])
def test_restart(run: Run, tmp_path: Path, kind: str) -> None:
    """Bent beyond yield, NLGEOM, and released by a second job: the same to the last digits as in one job."""
    body = sheet(kind[:3], "4I", (5, 1), lambda u, v: (5 + LENGTH * u, v))
    root = supports(body.where(0, 0.0), 1, 2)
    law = material(YOUNG, 0.3).replace("*SOLID", "*PLASTIC\n2., 0.\n252., 1.\n*SOLID")
    tip = "".join(f"{n + 1}, 2, 2, {{}}\n" for n in body.where(0, 1.0))
    loads = ["*BOUNDARY\n" + tip.replace("{}", value) for value in ("1.", "0.3")]
    whole = body.cards() + law + root + steps(loads[0], is_nlgeom=True, increment=0.2)
    second = steps(loads[1], is_nlgeom=True, increment=0.25)
    for folder, text in (("one", whole + second), ("two", whole.replace("*STATIC", "*RESTART, WRITE\n*STATIC"))):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "job.inp").write_text(text)
        done = run(["job"], cwd=tmp_path / folder)
        assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "two" / "next.inp").write_text("*RESTART, READ, STEP=1, INC=5\n" + second)
    done = run(["next", "oldjob=job"], cwd=tmp_path / "two")
    assert done.returncode == 0, done.stdout + done.stderr
    for name in ("U", "S"):
        ours, theirs = (read_field(tmp_path / path, name)[-1] for path in ("two/next.vtkhdf", "one/job.vtkhdf"))
        assert ours == pytest.approx(theirs, abs=1e-9 * np.abs(theirs).max())
