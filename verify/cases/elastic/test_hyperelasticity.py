"""Rubber and foam against closed forms: every family of energies under three motions, and Rivlin's torsion.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, newton

from verify.cases.elastic.test_plane_and_discrete_elements import sheet, supports
from verify.cases.proof import Case, observed_order
from verify.decks import make_decks
from verify.decks.make_decks import Mesh, grid_elements
from verify.decks.sheets import Floats, between, step
from verify.decks.solids import as_kind, node_set, prescribed, unit_cube

Proof = Callable[..., Case]
Energy = Callable[[np.ndarray], complex]


def invariants(stretch: np.ndarray) -> tuple[complex, complex, complex]:
    """I1 - 3 and I2 - 3 of the stretches without their change of volume, and J."""
    j = stretch[0] * stretch[1] * stretch[2]
    square = stretch**2 * j ** (-2 / 3)
    return square.sum() - 3, (1 / square).sum() - 3, j


def polynomial(c: dict[tuple[int, int], float], d: list[float]) -> Energy:
    """sum C_ij (I1 - 3)^i (I2 - 3)^j + sum (J - 1)^(2 i)/D_i."""

    def energy(stretch: np.ndarray) -> complex:
        i1, i2, j = invariants(stretch)
        return sum(v * i1**a * i2**b for (a, b), v in c.items()) + sum((j - 1) ** (2 * (k + 1)) / v for k, v in enumerate(d) if v)

    return energy


def ogden(terms: list[tuple[float, float]], d: float) -> Energy:
    """sum 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3) + (J - 1)^2/D."""

    def energy(stretch: np.ndarray) -> complex:
        j = stretch[0] * stretch[1] * stretch[2]
        own = stretch * j ** (-1 / 3)
        return sum(2 * mu / a**2 * ((own**a).sum() - 3) for mu, a in terms) + (j - 1) ** 2 / d

    return energy


def arruda_boyce(mu: float, lock: float, d: float) -> Energy:
    """mu sum c_i/lambda_m^(2 i - 2) (I1^i - 3^i) + ((J^2 - 1)/2 - ln J)/D."""
    c = [1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750]

    def energy(stretch: np.ndarray) -> complex:
        i1, _, j = invariants(stretch)
        own = mu * sum(v / lock ** (2 * k) * ((i1 + 3) ** (k + 1) - 3 ** (k + 1)) for k, v in enumerate(c))
        return own + ((j**2 - 1) / 2 - np.log(j)) / d

    return energy


def foam(terms: list[tuple[float, float, float]]) -> Energy:
    """sum 2 mu/alpha^2 (L1^alpha + L2^alpha + L3^alpha - 3 + (J^(-alpha beta) - 1)/beta), beta = nu/(1 - 2 nu)."""

    def energy(stretch: np.ndarray) -> complex:
        j, total = stretch[0] * stretch[1] * stretch[2], 0j
        for mu, a, nu in terms:
            beta = nu / (1 - 2 * nu)
            total = total + 2 * mu / a**2 * ((stretch**a).sum() - 3 + (j ** (-a * beta) - 1) / beta)
        return total

    return energy


FAMILIES: dict[str, tuple[str, Energy]] = {
    "neo-Hooke": ("*HYPERELASTIC, NEO HOOKE\n0.5, 0.02\n", polynomial({(1, 0): 0.5}, [0.02])),
    "Mooney-Rivlin": ("*HYPERELASTIC, MOONEY-RIVLIN\n0.4, 0.1, 0.02\n", polynomial({(1, 0): 0.4, (0, 1): 0.1}, [0.02])),
    "Yeoh": ("*HYPERELASTIC, YEOH\n0.5, -0.02, 0.004, 0.02, 0.05, 0.1\n",
             polynomial({(1, 0): 0.5, (2, 0): -0.02, (3, 0): 0.004}, [0.02, 0.05, 0.1])),
    "polynomial of order 2": ("*HYPERELASTIC, POLYNOMIAL, N=2\n0.4, 0.1, 0.02, 0.01, 0.005, 0.02, 0.05\n",
                              polynomial({(1, 0): 0.4, (0, 1): 0.1, (2, 0): 0.02, (1, 1): 0.01, (0, 2): 0.005}, [0.02, 0.05])),
    "reduced polynomial of order 2": ("*HYPERELASTIC, REDUCED POLYNOMIAL, N=2\n0.5, 0.03, 0.02, 0.05\n",
                                      polynomial({(1, 0): 0.5, (2, 0): 0.03}, [0.02, 0.05])),
    "Ogden": ("*HYPERELASTIC, OGDEN, N=2\n0.8, 1.8, 0.1, -2.2, 0.02, 0.\n", ogden([(0.8, 1.8), (0.1, -2.2)], 0.02)),
    "Arruda-Boyce": ("*HYPERELASTIC, ARRUDA-BOYCE\n1., 2.8, 0.02\n", arruda_boyce(1.0, 2.8, 0.02)),
    "foam": ("*HYPERFOAM, N=2\n0.6, 4., 0.3, -2., 0.2, 0.1\n", foam([(0.6, 4.0, 0.2), (0.3, -2.0, 0.1)])),
}  # fmt: skip


def stress_of(energy: Energy, stretch: Floats) -> Floats:
    """Principal Cauchy stresses l_i dW/dl_i/J, derivatives by a complex step."""
    slopes = np.zeros(3)
    for i in range(3):
        at = stretch.astype(complex)
        at[i] += 1e-30j
        slopes[i] = energy(at).imag / 1e-30
    return stretch * slopes / np.prod(stretch)


def free_sides(energy: Energy, make: Callable[[float], Floats], which: int) -> Floats:
    """Stretches with the free one found so that its stress is zero."""
    return make(brentq(lambda s: stress_of(energy, make(s))[which], 0.3, 2.0, xtol=1e-15))


def cube(offset: float, first: int) -> tuple[str, Floats]:
    """The cards of a unit cube of one C3D8 whose nodes and element start at `first`."""
    place = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)
    rows = "".join(f"{first + i}, {x + offset}, {y}, {z}\n" for i, (x, y, z) in enumerate(place))
    return "*NODE\n" + rows + f"*ELEMENT, TYPE=C3D8, ELSET=ALL\n{first}, " + ", ".join(str(first + i) for i in range(8)) + "\n", place


@pytest.mark.parametrize("family", FAMILIES)
def test_families(proof: Proof, family: str) -> None:
    """A bar, a sheet pulled in both directions, and simple shear."""
    card, energy = FAMILIES[family]
    name = family.lower().replace(" ", "-")
    case = proof(
        f"rubber-{name}",
        title=f"{'Foam' if family == 'foam' else 'Rubber: ' + family} under three motions",
        model="Three cubes of one C3D8, NLGEOM, 10 increments: stretched to 1.6 with free sides; stretched to 1.3 in both directions with a free side; "
        "all faces moved as in simple shear by 0.8. Constants: " + card.strip().replace("\n", ": ") + ".",
        formula="sigma_i = l_i dW/dl_i / J with the derivatives of W by a complex step in the test; free stretches by a root; shear: principal "
        "axes of F F'.",
        source="the energies of doc/theory/materials.md; R. W. Ogden, Non-Linear Elastic Deformations (1984)",
        proves="Stress and consistent tangent of the family at large strain.",
    )
    cards, loads = "", ""
    wanted = [free_sides(energy, lambda s: np.array([1.6, s, s]), 1), free_sides(energy, lambda s: np.array([1.3, 1.3, s]), 2)]
    for k, pulled in enumerate(((0,), (0, 1))):
        text, place = cube(3.0 * k, 8 * k + 1)
        cards += text
        for i, p in enumerate(place):
            node = 8 * k + 1 + i
            for axis in range(3):
                if p[axis] == 0:
                    loads += f"{node}, {axis + 1}\n"
                elif axis in pulled:
                    loads += f"{node}, {axis + 1}, {axis + 1}, {wanted[k][axis] - 1:.15g}\n"
    text, place = cube(6.0, 17)
    cards += text
    shear = 0.8
    for i, p in enumerate(place):
        loads += f"{17 + i}, 1, 1, {shear * p[2]:.15g}\n{17 + i}, 2, 3\n"
    deck = cards + "*MATERIAL, NAME=M\n" + card + "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
    job = case.run(deck + step("*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-8\n*BOUNDARY\n" + loads, 10, True), requested=10)
    stress, u = job.last("S"), job.last("U")
    scale = float(np.abs(stress_of(energy, wanted[0])).max())
    for k, what in enumerate(("bar", "sheet")):
        principal = stress_of(energy, wanted[k])
        case.near("stress", stress[8 * k, :3], principal, 1e-7, why="uniform strain", place=what, scale=scale, time="the end")
        case.near("free side", u[8 * k + 6, 2], wanted[k][2] - 1, 1e-7, why="uniform strain", place=what, time="the end")
    squares, axes = np.linalg.eigh(np.array([[1 + shear**2, 0, shear], [0, 1, 0], [shear, 0, 1.0]]))
    tensor = (axes * stress_of(energy, np.sqrt(squares))) @ axes.T
    voigt = tensor[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    case.near("stress", stress[16], voigt, 1e-7, why="uniform strain", place="shear", scale=scale, time="the end")
    case.done()


def disc(n: int) -> Mesh:
    """A slice of a cylinder of radius 1, 0.2 high: a square core and four patches around it."""
    line, ring = between(-1, 1, 2 * n), between(0, 1, n)
    parts = []
    s, t, w = (v.ravel(order="F") for v in np.meshgrid(line, line, [0.0, 0.2], indexing="ij"))
    parts.append(Mesh(np.stack([0.5 * s * (1 - 0.15 * t**2), 0.5 * t * (1 - 0.15 * s**2), w], axis=1), grid_elements(2 * n, 2 * n, 1)))
    s, r, w = (v.ravel(order="F") for v in np.meshgrid(line, ring, [0.0, 0.2], indexing="ij"))
    inner = np.stack([0.5 * s * (1 - 0.15), 0.5 * (1 - 0.15 * s**2)], axis=1)
    outer = np.stack([np.sin(s * np.pi / 4), np.cos(s * np.pi / 4)], axis=1)
    for k in range(4):
        c, q = np.cos(k * np.pi / 2), np.sin(k * np.pi / 2)
        flat = (inner * (1 - r)[:, None] + outer * r[:, None]) @ np.array([[c, -q], [q, c]]).T
        parts.append(Mesh(np.column_stack([flat, w]), grid_elements(2 * n, n, 1)))
    return make_decks.weld(parts, 1e-7)


@pytest.mark.parametrize("family", ["neo-Hooke", "Mooney-Rivlin"])
def test_torsion(proof: Proof, family: str) -> None:
    """A rubber cylinder twisted far at constant length: it tends to elongate (Poynting)."""
    c10, c01 = (0.5, 0.0) if family == "neo-Hooke" else (0.4, 0.1)
    case = proof(
        f"rubber-torsion-{family.lower()}",
        title=f"Rubber cylinder under large torsion, {family}",
        model=f"A slice 0.2 high of a cylinder of radius 1 (C3D20R; 2 and 4 cells from the core's centre to its side), C10 = {c10}, C01 = {c01}, "
        "D1 = 2e-4 (Poisson's ratio 0.49995), NLGEOM; the ends are turned against each other by 0.2, that is a shear of 1 at the rim, in 5 increments.",
        formula="Torque pi a^4 (C10 + C01) psi, axial force -pi a^4 psi^2 (C10/2 + C01), psi the twist per length.",
        source="R. S. Rivlin, Phil. Trans. R. Soc. Lond. A 242 (1949) 173-195",
        proves="Nearly incompressible rubber in a state that is not uniform; normal stresses of second order; no locking.",
    )
    card = f"*HYPERELASTIC, MOONEY-RIVLIN\n{c10}, {c01}, 2e-4\n"
    errors = []
    for n in (1, 2):
        body = as_kind(disc(2 * n), "C3D20R")
        r = np.hypot(body.nodes[:, 0], body.nodes[:, 1])
        rim = r > np.cos(np.pi / 8 / (2 * n)) - 1e-9      # mid-sides of the rim stand on chords: put them onto the circle
        body.nodes[rim, :2] /= r[rim, None]
        low, high = body.where(2, 0.0), body.where(2, 0.2)
        steps = ""
        for k in range(1, 6):
            angle = 0.2 * k / 5
            turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
            steps += step(prescribed(high, (body.nodes @ turn.T - body.nodes)[high]) + prescribed(low, np.zeros((len(low), 3))), 1, True)
        deck = body.cards() + node_set("LOW", low) + "*MATERIAL, NAME=M\n" + card + "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n" + steps
        job = case.run(deck, f"{2 * n} cells", requested=5)
        x, force = body.nodes + job.last("U"), job.last("RF")
        torque = float((x[high, 0] * force[high, 1] - x[high, 1] * force[high, 0]).sum())
        axial = float(force[high, 2].sum())
        errors.append((torque / (np.pi * (c10 + c01)) - 1, axial / (-np.pi * (c10 / 2 + c01)) - 1))
        if n == 2:
            order = f"{observed_order([abs(e[0]) for e in errors]):.1f}"
            case.near("torque", torque, np.pi * (c10 + c01), 0.005, why="a polygon of 32 sides with curved edges", order=order, place="turned end", time="the end")
            case.near("axial force", axial, -np.pi * (c10 / 2 + c01), 0.01, why="the pressure is found from a bulk modulus of 10000 C10",
                      place="turned end", time="the end")  # fmt: skip
    case.within("error of the torque, 4 over 2 cells", abs(errors[1][0]) / max(abs(errors[0][0]), 1e-9), (0.0, 1.0), why="it falls",
                place="turned end", time="the end")  # fmt: skip
    case.done()


# ------------------------------------------------------------------------------------------------------ inflation


def slope_of(energy: Energy, stretch: tuple[float, float, float], which: int) -> float:
    """dW/dl_i: nominal stress."""
    at = np.array(stretch, dtype=complex)
    at[which] += 1e-30j
    return energy(at).imag / 1e-30


def inflated(energy: Energy, radii: tuple[float, float], bore: float) -> tuple[Callable[[Floats], Floats], float]:
    """Places of a tube of reference radii that is held along its axis and blown up until its bore has the radius `bore`; and the pressure.

    d(P_r)/dR = (P_theta - P_r)/R with P_i = dW/dl_i(r', r/R, 1), P_r = 0 outside, by shooting for the place of the outside.
    """
    inner, outer = radii
    guess = [1.0]

    def change(big: float, y: Floats) -> list[float]:
        hoop = y[0] / big
        radial = float(newton(lambda s: slope_of(energy, (s, hoop, 1.0), 0) - y[1], guess[0], tol=1e-13))
        guess[0] = radial
        return [radial, (slope_of(energy, (radial, hoop, 1.0), 1) - y[1]) / big]

    def inward(outside: float) -> object:
        guess[0] = outer / outside
        return solve_ivp(change, (outer, inner), [outside, 0.0], rtol=1e-9, atol=1e-11, dense_output=True)

    kept = np.sqrt(bore**2 + outer**2 - inner**2)  # where it would be if the volume stayed
    outside = float(newton(lambda b: inward(b).y[0, -1] - bore, kept, tol=1e-11))
    path = inward(outside)
    return lambda big: path.sol(big)[0], float(-path.y[1, -1] * inner / bore)


def tube_deck(card: str, radii: tuple[float, float], pressure: float, cells: int, n_increments: int) -> tuple[object, str]:
    """A slice of a tube of CAX8R under the pressure, held along its axis: the mesh and the deck."""
    inner, outer = radii
    body = sheet("CAX", "8R", (cells, 1), lambda u, v: (inner + (outer - inner) * u, 0.1 * outer * v))
    load = "*DLOAD\n" + "".join(f"{e + 1}, P{side}, {pressure:.15g}\n" for e, side in body.edges(0, 0.0))
    deck = body.cards() + "*MATERIAL, NAME=M\n" + card + "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n" + supports(range(len(body.nodes)), 2)
    return body, deck + step("*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-8\n" + load, n_increments, True)


@pytest.mark.parametrize("family", FAMILIES)
def test_inflation(proof: Proof, family: str) -> None:
    """A thick tube blown up to one and a half times its bore."""
    card, energy = FAMILIES[family]
    case = proof(
        f"rubber-inflation-{family.lower().replace(' ', '-')}",
        title=f"Inflation of a thick tube, {family}",
        model="A slice of a tube of radii 1 and 2, held along its axis (CAX8R, 3 and 6 cells through the wall), NLGEOM; a pressure that stays normal to the "
        "bore grows in 10 increments to the value at which the bore has the radius 1.5. Constants: " + card.strip().replace("\n", ": ") + ".",
        formula="d P_r/dR = (P_theta - P_r)/R, P_i = dW/dl_i at the stretches r', r/R, 1; P_r = 0 outside, -p r/R at the bore: integrated numerically in the "
        "test, with the derivatives of W by a complex step.",
        source="the energies of doc/theory/materials.md; R. W. Ogden, Non-Linear Elastic Deformations (1984), ch. 5",
        proves="The family in a state that is not uniform, under a pressure that follows the surface.",
    )
    radii = (1.0, 2.0)
    exact, pressure = inflated(energy, radii, 1.5)
    errors = []
    for cells in (3, 6):
        body, deck = tube_deck(card, radii, pressure, cells, 10)
        job = case.run(deck, f"{cells} cells", requested=10)
        found = body.nodes[:, 0] + job.last("U")[:, 0]
        errors.append(float(np.abs(found / exact(body.nodes[:, 0]) - 1).max()))
    order = observed_order(errors)
    case.near("radius", 1 + errors[1], 1.0, 1e-3, why="six quadratic cells through the wall", place="all nodes", time="the end", order=f"{order:.1f}")
    case.within("observed order", order, (2.5, 9.0), why="quadratic elements: 3 or more", place="all nodes", time="the end")
    case.done()


def test_oden(proof: Proof) -> None:
    """Oden's cylinder: Mooney-Rivlin, 150 psi inside."""
    radii, pressure = (7.0, 18.625), 150.0
    bulk = 2 * 200 * (1 + 0.4999) / (3 * (1 - 2 * 0.4999))
    case = proof(
        "rubber-cylinder-oden",
        title="Thick rubber cylinder under 150 psi (Oden)",
        model="A slice of a cylinder of radii 7 and 18.625 in, held along its axis, C10 = 80 psi, C01 = 20 psi, Poisson's ratio 0.4999 (CAX8R, 5 and 10 cells "
        "through the wall), NLGEOM; pressure 150 psi on the bore, which follows it, in 10 increments.",
        formula="The bore moves by 7.18 in; the incompressible closed form p = int 2 (C10 + C01) (l^2 - l^-2)/r dr, l = r/R, is solved in the test.",
        source="J. T. Oden, Finite Elements of Nonlinear Continua (1972), p. 325; Ansys VM56",
        proves="Nearly incompressible rubber doubling its bore: no locking, and a pressure that follows the surface.",
    )
    grown = brentq(lambda bore: incompressible_pressure(radii, bore) - pressure, 7.5, 20.0) - 7.0
    found = []
    for cells in (5, 10):
        _, deck = tube_deck(f"*HYPERELASTIC, MOONEY-RIVLIN\n80., 20., {2 / bulk:.15g}\n", radii, pressure, cells, 10)
        job = case.run(deck, f"{cells} cells", requested=10)
        found.append(float(job.last("U")[0, 0]))
    case.near("displacement of the bore", found[1], 7.18, 0.005, why="as printed, three digits", place="r = 7 in", time="the end")
    case.near("displacement of the bore", found[1], grown, 0.002, why="compressibility: p/K is 1e-4, times (b/a)^2", place="r = 7 in", time="the end")
    case.within("change from 5 to 10 cells", abs(found[1] / found[0] - 1), (0.0, 1e-3), why="quadratic elements", place="r = 7 in", time="the end")
    case.done()


def incompressible_pressure(radii: tuple[float, float], bore: float) -> float:
    """Of Oden's cylinder when its bore has that radius."""
    r = np.linspace(bore, np.sqrt(radii[1] ** 2 - radii[0] ** 2 + bore**2), 20001)
    square = r**2 / (r**2 - bore**2 + radii[0] ** 2)
    return float(np.trapezoid(200 * (square - 1 / square) / r, r))


@pytest.mark.parametrize("kind", ["NEO HOOKE", "MOONEY-RIVLIN", "YEOH", "POLYNOMIAL, N=2"])
def test_constants_from_tests(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, kind: str) -> None:
    """Points of a law in all three tests give a stretched cube the stress of the law: slopes of the energy, by complex steps."""
    c = {"NEO HOOKE": {(1, 0): 0.5}, "MOONEY-RIVLIN": {(1, 0): 0.4, (0, 1): 0.1}, "YEOH": {(1, 0): 0.5, (2, 0): -0.02, (3, 0): 0.004},
         "POLYNOMIAL, N=2": {(1, 0): 0.4, (0, 1): 0.1, (2, 0): 0.02, (1, 1): -0.003, (0, 2): 0.001}}[kind]
    d = 3 * (1 - 2 * 0.48) / (2 * (c[1, 0] + c.get((0, 1), 0.0)) * 1.48)
    ways = {"UNIAXIAL": lambda x: [x, x**-0.5, x**-0.5], "BIAXIAL": lambda x: [x, x, x**-2], "PLANAR": lambda x: [x, 1, 1 / x]}
    cards = f"*HYPERELASTIC, {kind}, TEST DATA INPUT, POISSON=0.48\n"
    for name, way in ways.items():
        cards += f"*{name} TEST DATA\n"
        for x in (0.7, 0.9, 1.2, 1.6, 2.1):
            slope = polynomial(c, [])(np.array(way(x + 1e-30j))).imag / 1e-30
            cards += f"{slope / (2 if name == 'BIAXIAL' else 1):.15g}, {x - 1:.15g}\n"
    order = {"NEO HOOKE": 1, "MOONEY-RIVLIN": 1, "YEOH": 3, "POLYNOMIAL, N=2": 2}[kind]
    named = {"NEO HOOKE": [(1, 0)], "YEOH": [(1, 0), (2, 0), (3, 0)]}.get(kind, [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)][: 2 if order == 1 else 5])
    given = f"*HYPERELASTIC, {kind}\n" + ", ".join(f"{v:.15g}" for v in [*(c[key] for key in named), d, *[0.0] * (order - 1)]) + "\n"
    model = f"{unit_cube()}*SOLID SECTION, ELSET=E, MATERIAL=M\n*MATERIAL, NAME=M\n"
    load = "*BOUNDARY\nLOW, 3\n1, 1, 2\n2, 2\n4, 1\n*STEP, NLGEOM\n*STATIC\n0.25, 1.\n*BOUNDARY\nHIGH, 3, 3, 0.8\n*NODE PRINT, NSET=HIGH\nU, RF\n*END STEP\n"
    printed = []
    for law in (cards, given):
        done = run_deck(model + law + load)
        assert done.returncode == 0, done.stdout
        assert ("with 0 % as the largest error" in " ".join(done.stdout.split())) == (law == cards)
        printed.append([[float(v) for v in row.split()] for row in (tmp_path / "job.dat").read_text().splitlines() if row.split()[:1] and row.split()[0] in "5678"])
    assert np.abs(np.array(printed[0]) - np.array(printed[1])).max() < 2e-6
