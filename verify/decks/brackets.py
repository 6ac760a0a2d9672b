"""An angle bracket of elastic-plastic sheet: its limit load lies between the two bounds of plastic hinges.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.decks.make_decks import Mesh, block
from verify.decks.solids import as_kind, node_set, pressure_on

THICKNESS, WIDTH, LENGTH = 10.0, 40.0, 100.0
YIELD = 300.0


@dataclass
class Bracket:
    """An upright, fixed at its foot, with an arm at its top; pressure on the outer half of the arm."""

    kind: str = "C3D10"
    n_thickness: int = 2
    n_width: int = 5
    n_length: int = 10
    hardening: str = f"{YIELD}, 0.\n"
    pressure: float = 2.0
    is_nlgeom: bool = False

    def mesh(self) -> Mesh:
        """Hexahedra of the angle."""
        x = np.concatenate([np.linspace(0, THICKNESS, self.n_thickness + 1), np.linspace(THICKNESS, LENGTH, self.n_length + 1)[1:]])
        mesh = block(x, np.linspace(0, WIDTH, self.n_width + 1), LENGTH - x[::-1], "BRACKET")
        centres = mesh.nodes[mesh.elements].mean(axis=1)
        elements = mesh.elements[(centres[:, 0] < THICKNESS) | (centres[:, 2] > LENGTH - THICKNESS)]
        kept, numbers = np.unique(elements, return_inverse=True)
        mesh.nodes, mesh.elements = mesh.nodes[kept], numbers.reshape(elements.shape)
        return mesh

    def deck(self, controls: str = "") -> str:
        """The deck; ten increments if none fails."""
        body = as_kind(self.mesh(), self.kind)
        top = body.outer_faces(body.where(2, LENGTH))
        loaded = [(e, f) for e, f in top if body.nodes[body.elements[e][:4], 0].mean() > LENGTH / 2]
        step = f"*STEP, INC=500{', NLGEOM' if self.is_nlgeom else ''}\n*STATIC\n0.1, 1., 1e-5, 0.1\n{controls}"
        return (
            body.cards()
            + node_set("FOOT", body.where(2, 0.0))
            + f"*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*PLASTIC\n{self.hardening}*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n"
            + f"*BOUNDARY\nFOOT, 1, 3\n{step}{pressure_on(loaded, self.pressure)}"
            + "*NODE PRINT, NSET=FOOT, TOTALS=ONLY\nRF\n*NODE FILE\nU, RF\n*EL FILE\nS\n*END STEP\n"
        )


def limit_pressures() -> tuple[float, float]:
    """Bounds of the pressure at which the arm turns about a hinge in the upright (bending with the force's own compression): plane
    stress, and plane strain, 2/sqrt(3) times as strong. Tresca's hinge, M = Mp (1 - (N/Np)^2), of P. G. Hodge, Plastic Analysis of
    Structures (1959), chapter 7."""
    force = WIDTH * LENGTH / 2  # of a unit pressure
    lever = 0.75 * LENGTH - 0.5 * THICKNESS
    bounds = []
    for strength in (YIELD, 2 / np.sqrt(3) * YIELD):
        moment, normal = strength * WIDTH * THICKNESS**2 / 4, strength * WIDTH * THICKNESS
        bounds.append(float(np.roots([moment * (force / normal) ** 2, force * lever, -moment]).max()))
    return bounds[0], bounds[1]
