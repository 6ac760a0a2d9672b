"""A pin in a lug: tetrahedra with curved edges, a clearance, friction, and a force that nothing but contact bears.

    python -m verify.decks.pin_in_lug [--size 3] [--dialect abaqus|calculix] [--by-displacement] > pin_in_lug.inp

The lug is 12 thick and 40 wide, with a round end about its hole of radius 10; it is held 60 from the centre of the hole. The pin is
36 long; its radius is smaller by the clearance of 0.05. Its ends are rigid and guided: they move along the lug only, pulled by 20 kN
away from its root. E = 210000, nu = 0.3, mu = 0.15, NLGEOM, lengths in mm. gmsh makes the mesh (C3D10).

Dialect abaqus: hard contact, node to surface. Dialect calculix: the linear law that CalculiX's manual recommends for hard contact,
a slope of 50 E and a stick slope of a hundredth of it, surface to surface (its springs at points of the faces). --by-displacement prescribes the displacement of the pin in
place of its force, so that the pin is held before it touches.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import gmsh
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HOLE, WIDTH, THICKNESS, LENGTH, PIN_LENGTH = 10.0, 40.0, 12.0, 60.0, 36.0
GRIP = THICKNESS / 2 + 1.0  #: half length of the pin's surface in the pair
CLEARANCE, FORCE, DISPLACEMENT = 0.05, 20000.0, 0.0945
MODULUS, MU = 210000.0, 0.15
#: From the order of nodes of gmsh's ten-node tetrahedron to that of C3D10.
ORDER = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
#: Faces S1 to S4 of a tetrahedron by its corners.
FACES = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]


@dataclass
class Body:
    """Tetrahedra of a body; labels from 1."""

    name: str
    nodes: Floats  #: (n_nodes, 3)
    elements: Ints  #: (n_elements, 10), from 0

    def faces(self, is_inside: Ints) -> list[tuple[int, int]]:
        """(element from 0, face from 1) of the faces whose corners are all marked and that belong to one element."""
        owners: dict[tuple[int, ...], list[tuple[int, int]]] = {}
        for e, element in enumerate(self.elements):
            for f, local in enumerate(FACES, start=1):
                if is_inside[element[local]].all():
                    owners.setdefault(tuple(sorted(element[local].tolist())), []).append((e, f))
        return [found[0] for found in owners.values() if len(found) == 1]


def mesh_body(name: str, size: float) -> Body:
    """LUG or PIN, meshed by gmsh; edges along the bore are of the size, others up to twice as long."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        build = gmsh.model.occ
        if name == "PIN":
            planes = [-PIN_LENGTH / 2, -GRIP, GRIP, PIN_LENGTH / 2]
            pieces = [build.addCylinder(0, 0, a, 0, 0, b - a, HOLE - CLEARANCE) for a, b in pairwise(planes)]
            build.fragment([(3, pieces[0])], [(3, piece) for piece in pieces[1:]])
        else:
            plate = build.addBox(-LENGTH, -WIDTH / 2, -THICKNESS / 2, LENGTH, WIDTH, THICKNESS)
            end = build.addCylinder(0, 0, -THICKNESS / 2, 0, 0, THICKNESS, WIDTH / 2)
            bore = build.addCylinder(0, 0, -THICKNESS / 2, 0, 0, THICKNESS, HOLE)
            whole, _ = build.fuse([(3, plate)], [(3, end)])
            build.cut(whole, [(3, bore)])
        build.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 2 * size)
        gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, lc: max(size, min(2 * size, size + 0.3 * abs(np.hypot(x, y) - HOLE))))
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.option.setNumber("Mesh.HighOrderOptimize", 1)
        gmsh.model.mesh.generate(3)
        tags, places, _ = gmsh.model.mesh.getNodes()
        tags, first = np.unique(tags, return_index=True)
        _, rows = gmsh.model.mesh.getElementsByType(11)
    finally:
        gmsh.finalize()
    elements = np.searchsorted(tags, rows).reshape(-1, 10)[:, ORDER]
    return Body(name, places.reshape(-1, 3)[first], elements)


def set_cards(card: str, name: str, members: Sequence[int] | Ints) -> list[str]:
    """A set, sixteen numbers to a line."""
    numbers = [str(int(n)) for n in members]
    return [f"*{card}, {card}={name}", *(", ".join(numbers[i:i + 16]) for i in range(0, len(numbers), 16))]


def body_cards(body: Body, node0: int, element0: int) -> list[str]:
    """Nodes, elements, and the surface of the bore or of the pin's barrel within the lug."""
    lines = ["*NODE", *(f"{node0 + i}, {x:.9g}, {y:.9g}, {z:.9g}" for i, (x, y, z) in enumerate(body.nodes))]
    lines += [f"*ELEMENT, TYPE=C3D10, ELSET={body.name}"]
    lines += [", ".join(str(v) for v in (element0 + e, *(row + node0))) for e, row in enumerate(body.elements)]
    radius = np.hypot(body.nodes[:, 0], body.nodes[:, 1])
    marked = np.abs(radius - (HOLE if body.name == "LUG" else HOLE - CLEARANCE)) < 1e-4
    if body.name == "PIN":
        marked &= np.abs(body.nodes[:, 2]) < GRIP + 1e-6
    return [*lines, f"*SURFACE, NAME={body.name}_FACE", *(f"{element0 + e}, S{f}" for e, f in body.faces(marked))]


def pin_in_lug(size: float = 3.0, dialect: str = "abaqus", by_displacement: bool = False) -> str:
    """The deck."""
    lug, pin = mesh_body("LUG", size), mesh_body("PIN", size)
    first = len(lug.nodes) + 1
    reference = first + len(pin.nodes)
    ends = first + np.flatnonzero(np.abs(np.abs(pin.nodes[:, 2]) - PIN_LENGTH / 2) < 1e-6)
    root = 1 + np.flatnonzero(np.abs(lug.nodes[:, 0] + LENGTH) < 1e-6)
    lines = ["*HEADING", "A pin in a lug"] + (["** dialect: calculix"] if dialect == "calculix" else [])
    lines += body_cards(lug, 1, 1) + body_cards(pin, first, len(lug.elements) + 1)
    lines += ["*NODE", f"{reference}, 0., 0., 0.", f"{reference + 1}, 0., 0., 0."]
    lines += set_cards("NSET", "ROOT", root) + set_cards("NSET", "ENDS", ends)
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{MODULUS}, 0.3"]
    lines += ["*SOLID SECTION, ELSET=LUG, MATERIAL=STEEL", "*SOLID SECTION, ELSET=PIN, MATERIAL=STEEL"]
    lines += [f"*RIGID BODY, NSET=ENDS, REF NODE={reference}, ROT NODE={reference + 1}"]
    lines += ["*SURFACE INTERACTION, NAME=DRY"]
    if dialect == "calculix":
        lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{50 * MODULUS}", "*FRICTION", f"{MU}, {MODULUS / 2}"]
    else:
        lines += ["*FRICTION", f"{MU}"]
    lines += ["*CONTACT PAIR, INTERACTION=DRY, TYPE=" + ("SURFACE TO SURFACE" if dialect == "calculix" else "NODE TO SURFACE"), "LUG_FACE, PIN_FACE"]
    lines += ["*BOUNDARY", "ROOT, 1, 3", f"{reference}, 2, 3", f"{reference + 1}, 1, 3"]
    lines += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.1, 1."]
    load = ["*BOUNDARY", f"{reference}, 1, 1, {DISPLACEMENT}"] if by_displacement else ["*CLOAD", f"{reference}, 1, {FORCE}"]
    lines += [*load, "*NODE PRINT, NSET=ROOT, TOTALS=ONLY", "RF"]
    lines += ["*NODE FILE", "U", "*EL FILE", "S", "*CONTACT FILE", "CDIS, CSTR"] if dialect == "calculix" else []
    return "\n".join([*lines, "*END STEP", ""])


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="Print the deck of a pin in a lug.")
    parser.add_argument("--size", type=float, default=3.0, help="length of the edges in the contact")
    parser.add_argument("--dialect", choices=["abaqus", "calculix"], default="abaqus")
    parser.add_argument("--by-displacement", action="store_true", help="move the pin in place of pulling it")
    options = parser.parse_args(arguments)
    sys.stdout.write(pin_in_lug(options.size, options.dialect, options.by_displacement))
    return 0


if __name__ == "__main__":
    sys.exit(main())
