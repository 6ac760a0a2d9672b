"""NAFEMS LE1 with two meshes, and Cook's membrane at finite strain, in the plane.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.cases.elastic.test_plane_and_discrete_elements import Sheet, material, sheet, supports
from verify.cases.proof import Case, observed_order
from verify.decks.sheets import Floats, step

Proof = Callable[..., Case]


@pytest.mark.parametrize("shape", ["4", "6", "8", "8R"])
def test_le1(proof: Proof, shape: str) -> None:
    """The elliptic membrane."""
    case = proof(
        f"nafems-le1-cps{shape.lower()}",
        title=f"NAFEMS LE1: elliptic membrane, CPS{shape}",
        model="A quarter of a membrane 0.1 thick between the ellipses 2 x 1 and 3.25 x 2.75, E = 210000, nu = 0.3, pulled outward by 10 on its outer edge; "
        "symmetry on the axes; one increment, small displacements; "
        f"{'32 x 64 and 64 x 128' if shape == '4' else '16 x 32 and 32 x 64'} cells.",
        formula="sigma_yy at D (2, 0) = 92.7.",
        source="NAFEMS, The standard NAFEMS benchmarks, LE1",
        proves="Stress at a corner of a curved edge in plane stress, pull on a curved edge.",
    )

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        angle = np.pi / 2 * v
        return (2.0 + 1.25 * u) * np.cos(angle), (1.0 + 1.75 * u) * np.sin(angle)

    errors = []
    for n in (32, 64) if shape == "4" else (16, 32):
        body = sheet("CPS", shape, (n, 2 * n), place)
        load = "*DLOAD\n" + "".join(f"{e + 1}, P{side}, -10.\n" for e, side in body.edges(0, 1.0))
        held = supports(body.where(1, 0.0), 2) + supports(body.where(1, 1.0), 1)
        job = case.run(body.cards() + material(210e3, 0.3, 0.1) + held + step(load, 1), f"{n} x {2 * n}", requested=1)
        d = int(np.argmin(np.abs(body.uv).sum(axis=1)))
        found = float(job.last("S")[d, 1])
        errors.append(abs(found / 92.7 - 1))
    case.near("sigma_yy", found, 92.7, 0.02, why="extrapolated to the corner from the integration points; 2 % is accepted", place="D", time="the end",
              order=f"{observed_order(errors):.1f}")  # fmt: skip
    case.done()


def panel(prefix: str, shape: str, n: int) -> Sheet:
    """Cook's panel."""
    return sheet(prefix, shape, (n, n), lambda u, v: (48 * u, 44 * u + v * (44 - 28 * u)))


@pytest.mark.slow
def test_cook_finite(proof: Proof) -> None:
    """Cook's membrane of nearly incompressible rubber."""
    case = proof(
        "cook-finite",
        title="Cook's membrane at finite strain, nearly incompressible",
        model="The panel (0,0) (48,44) (48,60) (0,44) of thickness 1 in plane strain; neo-Hooke with G = 80.194, K = 400889.8; left side held, a shear force of 100 "
        "in all on the right side, NLGEOM, 20 increments; CPE4 (mean dilatation) 8 x 8, 16 x 16, 32 x 32 and CPE8R 16 x 16.",
        formula="The corner (48, 60) rises by 6.9; the elements agree with each other.",
        source="J. C. Simo, F. Armero, Int. J. Numer. Meth. Engng 33 (1992) 1413-1449, and many after them",
        proves="No locking of CPE4 and CPE8R in bending and shear of rubber.",
    )
    rubber = f"*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n{80.194 / 2}, {2 / 400889.8:.12g}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n1.\n"
    rises = []
    for shape, n in (("4", 8), ("4", 16), ("4", 32), ("8R", 16)):
        body = panel("CPE", shape, n)
        right = body.where(0, 1.0)
        order = right[np.argsort(body.nodes[right, 1])]
        share = np.zeros(len(order))
        for k in range(0, len(order) - 1, 1 if shape == "4" else 2):
            if shape == "4":
                share[k : k + 2] += 0.5
            else:
                share[k : k + 3] += np.array([1, 4, 1]) / 6
        load = "*CLOAD\n" + "".join(f"{node + 1}, 2, {100 * s / n:.15g}\n" for node, s in zip(order, share, strict=True))
        held = supports(body.where(0, 0.0), 1, 2)
        job = case.run(body.cards() + rubber + held + step(load, 20, True), f"CPE{shape} {n} x {n}", requested=20)
        rises.append(float(job.last("U")[order[-1], 1]))
    case.near("rise of the corner", rises[2], 6.9, 0.01, why="the figure has two digits", place="(48, 60)", time="CPE4 32 x 32")
    case.near("rise of the corner", rises[2], rises[3], 0.01, why="both are near their limit", place="(48, 60)", time="CPE4 32 x 32 against CPE8R 16 x 16",
              order=f"{observed_order(np.abs(np.diff(rises[:3]))):.1f}")  # fmt: skip
    case.within("change from 16 to 32", abs(rises[2] / rises[1] - 1), (0.0, 0.02), why="a locking element changes by factors",
                place="(48, 60)", time="the end")  # fmt: skip
    case.done()
