"""Rubber and foam against closed forms: every family of energies under three motions, and Rivlin's torsion.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "decks"))

import make_decks  # noqa: E402
from make_decks import Mesh, grid_elements  # noqa: E402
from proof import Case  # noqa: E402
from sheets import Floats, between, step  # noqa: E402
from solids import as_kind, node_set, prescribed  # noqa: E402

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
    """A bar, a sheet pulled both ways, and simple shear."""
    card, energy = FAMILIES[family]
    name = family.lower().replace(" ", "-")
    case = proof(
        f"rubber-{name}",
        title=f"{'Foam' if family == 'foam' else 'Rubber: ' + family} under three motions",
        model="Three cubes of one C3D8, NLGEOM, 10 increments: stretched to 1.6 with free sides; stretched to 1.3 both ways with a free side; "
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
    job = case.run(deck + step("*CONTROLS, PARAMETERS=FIELD\n1e-10, 1e-8\n*BOUNDARY\n" + loads, 10, True), asked=10)
    stress, u = job.last("S"), job.last("U")
    scale = float(np.abs(stress_of(energy, wanted[0])).max())
    for k, what in enumerate(("bar", "sheet")):
        principal = stress_of(energy, wanted[k])
        case.near("stress", stress[8 * k, :3], principal, 1e-7, why="uniform strain", place=what, scale=scale)
        case.near("free side", u[8 * k + 6, 2], wanted[k][2] - 1, 1e-7, why="uniform strain", place=what)
    squares, axes = np.linalg.eigh(np.array([[1 + shear**2, 0, shear], [0, 1, 0], [shear, 0, 1.0]]))
    tensor = (axes * stress_of(energy, np.sqrt(squares))) @ axes.T
    voigt = tensor[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    case.near("stress", stress[16], voigt, 1e-7, why="uniform strain", place="shear", scale=scale)
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
    """A rubber cylinder twisted far at constant length: it wants to grow longer (Poynting)."""
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
        job = case.run(deck, f"{2 * n} cells", asked=5)
        x, force = body.nodes + job.last("U"), job.last("RF")
        torque = float((x[high, 0] * force[high, 1] - x[high, 1] * force[high, 0]).sum())
        axial = float(force[high, 2].sum())
        errors.append((torque / (np.pi * (c10 + c01)) - 1, axial / (-np.pi * (c10 / 2 + c01)) - 1))
        if n == 2:
            case.near("torque", torque, np.pi * (c10 + c01), 0.005, why="a polygon of 32 sides with curved edges")
            case.near("axial force", axial, -np.pi * (c10 / 2 + c01), 0.01, why="the pressure is found from a bulk modulus of 10000 C10")
    case.within("error of the torque, 4 over 2 cells", abs(errors[1][0]) / max(abs(errors[0][0]), 1e-9), (0.0, 1.0), why="it falls")
    case.done()
