"""Surface-to-surface contact by the dual mortar method: patch tests of every element kind, equilibrium of forces and moments.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from verify.cases.contact import test_hertz, test_sliding
from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks import make_decks, solids
from verify.decks.grids import bodies_deck, grid
from verify.decks.sheets import between, fix, pair, step

Proof = Callable[..., Case]
Floats = NDArray[np.float64]

YOUNG, NU, PRESSURE = 1000.0, 0.3, 10.0
STRESS = np.array([0.0, 0.0, -PRESSURE, 0.0, 0.0, 0.0])


def exact(points: Floats) -> Floats:
    """The displacements of bars that stand side by side under the pressure."""
    return points * np.array([NU, NU, -1.0]) * PRESSURE / YOUNG


def faces_at(body: solids.Solids, height: Callable[[Floats], Floats], first: int) -> str:
    """Data lines of the faces whose corners are at a height z(x, y)."""
    nodes = np.flatnonzero(np.abs(body.nodes[:, 2] - height(body.nodes)) < 1e-9)
    return "".join(f"{e + first + 1}, S{f}\n" for e, f in body.outer_faces(nodes))


def renumbered(body: solids.Solids, first_node: int, first_element: int, name: str) -> str:
    """The cards of a body with higher labels."""
    labels = solids.Solids(body.kind, body.nodes, body.elements + first_node)
    lines = labels.cards().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("*ELEMENT"))
    nodes = [f"{first_node + i}, " + ", ".join(f"{v:.15g}" for v in x) for i, x in enumerate(body.nodes, start=1)]
    elements, is_new = [], True
    for line in lines[start + 1 :]:
        if is_new:
            label, rest = line.split(",", 1)
            line = f"{int(label) + first_element},{rest}"
        elements.append(line)
        is_new = not line.endswith(",")
    return "\n".join(["*NODE", *nodes, f"*ELEMENT, TYPE={body.kind}, ELSET={name}", *elements]) + "\n"


def stack(
    kinds: tuple[str, str],
    cells: tuple[int, int],
    *,
    slope: float = 0.0,
    mu: float = 0.0,
    overhang: float = 0.0,
    skew: float = 0.0,
    is_nlgeom: bool = False,
    behavior: str = "",
) -> tuple[str, Floats, int]:
    """Two blocks with prescribed outer nodes but for those at the interface: deck, all nodes, nodes of the upper block.

    slope: of the interface along x. overhang: how far the upper block reaches beyond the lower one. skew: shifts the inner nodes of
    the interface, so that faces are no parallelograms.
    """
    bodies = []
    for z, kind, n, reach in ((1, kinds[0], cells[0], overhang), (0, kinds[1], cells[1], 0.0)):
        block = make_decks.block(between(0, 1 + reach, n), between(0, 1, n), between(z, z + 1, 2), "BODY")
        x = block.nodes
        bubble = np.sin(np.pi * x[:, 0] / (1 + reach)) * np.sin(np.pi * x[:, 1]) * skew / n
        x[:, 0] += bubble * (1 if z else -0.7)
        x[:, 1] += bubble * (0.4 if z else 0.8)
        x[:, 2] += slope * x[:, 0]
        bodies.append(solids.as_kind(block, kind))
    upper, lower = bodies

    def interface(points: Floats) -> Floats:
        return 1 + slope * points[:, 0]

    n_upper = len(upper.nodes)
    nodes = np.concatenate([upper.nodes, lower.nodes])
    held: list[int] = []
    for body, first in ((upper, 0), (lower, n_upper)):
        outer = body.boundary_nodes()
        held += list(first + outer[np.abs(body.nodes[outer, 2] - interface(body.nodes[outer])) > 1e-9])
    friction = f"*FRICTION\n{mu}\n" if mu else ""
    deck = (
        renumbered(upper, 0, 0, "ABOVE")
        + renumbered(lower, n_upper, len(upper.elements), "BELOW")
        + "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
        + "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n" for name in ("ABOVE", "BELOW"))
        + "*SURFACE, NAME=SLAVE\n" + faces_at(upper, interface, 0)
        + "*SURFACE, NAME=MASTER\n" + faces_at(lower, interface, len(upper.elements))
        + f"*SURFACE INTERACTION, NAME=I\n{behavior}{friction}"
        + "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n"
        + f"*STEP{', NLGEOM' if is_nlgeom else ''}\n*STATIC\n1., 1.\n"
        + solids.prescribed(held, exact(nodes)[held])
        + "*END STEP\n"
    )
    return deck, nodes, n_upper


MODEL = "Two blocks of edge 1, one on the other, E = 1000, nu = 0.3; the outer nodes but those of the interface have the displacements of a "
MODEL += "uniaxial stress of 10, in one increment. *CONTACT PAIR, TYPE=SURFACE TO SURFACE. "
SOURCE = "R. L. Taylor and P. Papadopoulos (1991); P. Wriggers and A. Popp (eds.), Contact Modeling for Solids and Particles, Springer 2018"

#: name: kinds above and below, cells above and below, options
PATCHES: dict[str, tuple[tuple[str, str], tuple[int, int], dict]] = {
    "c3d8": (("C3D8", "C3D8"), (4, 3), {}),
    "c3d8-coarse-slave": (("C3D8", "C3D8"), (2, 5), {}),
    "c3d8-skew": (("C3D8", "C3D8"), (4, 3), {"skew": 0.3}),
    "c3d8-inclined": (("C3D8", "C3D8"), (4, 3), {"slope": 0.2, "mu": 0.5}),
    "c3d8-linear-law": (("C3D8", "C3D8"), (4, 3), {"behavior": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e7\n"}),
    "c3d4": (("C3D4", "C3D4"), (4, 3), {}),
    "c3d4-inclined": (("C3D4", "C3D4"), (3, 4), {"slope": 0.2, "mu": 0.5}),
    "c3d6-on-c3d8": (("C3D6", "C3D8"), (3, 2), {}),
    "c3d10": (("C3D10", "C3D10"), (3, 2), {}),
    "c3d10-inclined": (("C3D10", "C3D10"), (2, 3), {"slope": 0.2, "mu": 0.5}),
    "c3d20": (("C3D20", "C3D20"), (3, 2), {}),
    "c3d20-skew": (("C3D20", "C3D20"), (3, 2), {"skew": 0.3}),
    "c3d20r-inclined": (("C3D20R", "C3D20R"), (2, 3), {"slope": 0.2, "mu": 0.5}),
    "c3d20-on-c3d10": (("C3D20", "C3D10"), (2, 3), {}),
    "c3d8-on-c3d20": (("C3D8", "C3D20"), (3, 2), {}),
}


@pytest.mark.parametrize("name", PATCHES)
def test_patch(proof: Proof, name: str) -> None:
    """A uniform pressure goes through an interface of meshes that do not match, whatever their kinds."""
    kinds, cells, options = PATCHES[name]
    case = proof(
        f"mortar-patch-{name}",
        title=f"Contact patch test, surface to surface: {kinds[0]} on {kinds[1]}, {cells[0]} x {cells[0]} on {cells[1]} x {cells[1]} cells",
        model=MODEL + "".join(f"{key}: {str(value).strip()}. " for key, value in options.items()),
        formula="Stress sigma_zz = -10 everywhere, all others zero; displacements linear; contact pressure 10/(1 + slope^2) at each slave node.",
        source=SOURCE,
        proves="The integrals of the mortar method are exact on flat interfaces; node-to-surface contact fails this test.",
    )
    deck, nodes, n_upper = stack(kinds, cells, **options)
    job = case.run(deck, requested=1)
    soft = PRESSURE / 1e7 if "behavior" in options else 0.0   # the overclosure of a law that gives: the stress falls by soft E/2
    tolerance = 1e-8 + 2 * soft * YOUNG / PRESSURE
    stress = job.last("S")
    case.near("stress", stress, np.tile(STRESS, (len(stress), 1)), tolerance, why="in the space of the elements", place="all nodes", time="the end")
    case.near("displacement", job.results.displacements[-1], exact(nodes), tolerance, why="in the space of the elements",
              place="all nodes", time="the end")  # fmt: skip
    slope = options.get("slope", 0.0)
    slaves = np.flatnonzero(np.abs(nodes[:n_upper, 2] - 1 - slope * nodes[:n_upper, 0]) < 1e-9)
    case.near("contact pressure", job.last("CPRESS")[slaves], PRESSURE / (1 + slope**2), tolerance, why="constant: in the space of the duals",
              place="all slave nodes", time="the end")  # fmt: skip
    forces = job.last("RF")
    case.near("sum of forces", forces.sum(axis=0), 0.0, 1e-9, scale=PRESSURE, why="the weights of a row add up to zero",
              place="all nodes", time="the end")  # fmt: skip
    moments = np.cross(nodes, forces).sum(axis=0)
    case.near("sum of moments", moments, 0.0, 1e-9, scale=PRESSURE, why="the relative position of a row is zero on a flat interface",
              place="all nodes", time="the end")  # fmt: skip
    case.done()


def plate(kind: str, n: int, low: float, first: tuple[int, int]) -> tuple[Floats, str, NDArray, NDArray]:
    """n x 2 squares of 4 or 8 nodes, 1 <= x <= 2, low <= y <= low + 1: nodes, their cards, and those of the lower and the upper side."""
    is_quadratic = kind[3] == "8"
    m = 2 if is_quadratic else 1
    x, y = np.meshgrid(between(1, 2, m * n), between(low, low + 1, 2 * m))
    keep = np.ones(x.shape, dtype=bool)
    if is_quadratic:
        keep[1::2, 1::2] = False
    number = np.cumsum(keep).reshape(keep.shape) + first[0]
    rows = []
    for e, (j, i) in enumerate(np.ndindex(2, n), start=first[1] + 1):
        a, b = m * j, m * i
        places = [(a, b), (a, b + m), (a + m, b + m), (a + m, b)]
        if is_quadratic:
            places += [(a, b + 1), (a + 1, b + 2), (a + 2, b + 1), (a + 1, b)]
        rows.append(", ".join(str(v) for v in [e, *(number[place] for place in places)]))
    nodes = np.stack([x[keep], y[keep]], axis=1)
    lines = [f"{first[0] + i}, {p[0]:.15g}, {p[1]:.15g}" for i, p in enumerate(nodes, start=1)]
    cards = "\n".join(["*NODE", *lines, f"*ELEMENT, TYPE={kind}, ELSET=ALL", *rows]) + "\n"
    return nodes, cards, np.flatnonzero(nodes[:, 1] < low + 1e-9), np.flatnonzero(nodes[:, 1] > low + 1 - 1e-9)


@pytest.mark.parametrize("kinds", [("CPE4", "CPE4"), ("CPE8", "CPE8"), ("CPS4", "CPS8R"), ("CPE4I", "CPE4I"), ("CAX4I", "CAX4"), ("CAX4", "CAX4"), ("CAX8", "CAX8R")])
def test_plane_patch(proof: Proof, kinds: tuple[str, str]) -> None:
    """The patch test in the plane and in bodies of revolution."""
    case = proof(
        f"mortar-patch-{kinds[0]}-on-{kinds[1]}".lower(),
        title=f"Contact patch test, surface to surface: {kinds[0]} on {kinds[1]}",
        model="Two plates (rings with 1 < r < 2 for CAX), 5 x 2 on 3 x 2 squares, E = 1000, nu = 0.3, thickness 1; the outer nodes but those of "
        "the interface have the displacements of a uniaxial stress of 10, in one increment.",
        formula="Stress sigma_yy = -10 and what nu makes of it everywhere; contact pressure 10 at each slave node.",
        source=SOURCE,
        proves="The integrals are exact on lines, with the weight of the radius too.",
    )
    upper, above, bottom, _ = plate(kinds[0], 5, 1.0, (0, 0))
    lower, below, _, _ = plate(kinds[1], 3, 0.0, (len(upper), 10))
    is_strain = kinds[0].startswith("CPE")
    strain = np.array([NU * (1 + NU), -(1 - NU**2)]) if is_strain else np.array([NU, -1.0])
    nodes = np.concatenate([upper, lower])
    wanted = nodes * strain * PRESSURE / YOUNG
    is_inner = np.zeros(len(nodes), dtype=bool)
    for body, first in ((upper, 0), (lower, len(upper))):
        y = body[:, 1]
        is_side = (np.abs(body[:, 0] - 1) < 1e-9) | (np.abs(body[:, 0] - 2) < 1e-9) | (np.abs(y - 2) < 1e-9) | (np.abs(y) < 1e-9)
        is_inner[first : first + len(body)] = ~is_side | (np.abs(y - 1) < 1e-9)
    held = "".join(
        f"{n + 1}, {k + 1}, {k + 1}, {wanted[n, k]:.17g}\n" for n in np.flatnonzero(~is_inner) for k in range(2)
    )
    section = "" if kinds[0].startswith("CAX") else "1.\n"
    deck = (
        above + below + "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n" + section
        + "*SURFACE, NAME=SLAVE\n" + "".join(f"{e}, S1\n" for e in range(1, 6))
        + "*SURFACE, NAME=MASTER\n" + "".join(f"{e}, S3\n" for e in range(14, 17))
        + "*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n"
        + "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n" + held + "*END STEP\n"
    )
    job = case.run(deck, requested=1)
    stress = job.last("S")
    expected = np.array([0.0, -PRESSURE, -NU * PRESSURE if is_strain else 0.0, 0.0, 0.0, 0.0])
    case.near("stress", stress, np.tile(expected, (len(stress), 1)), 1e-8, why="in the space of the elements", place="all nodes", time="the end")
    case.near("displacement", job.results.displacements[-1][:, :2], wanted, 1e-8, why="in the space of the elements",
              place="all nodes", time="the end")  # fmt: skip
    case.near("contact pressure", job.last("CPRESS")[bottom], PRESSURE, 1e-8, why="constant: in the space of the duals",
              place="all slave nodes", time="the end")  # fmt: skip
    case.near("sum of forces", job.last("RF")[:, 1].sum(), 0.0, 1e-9, scale=PRESSURE, why="the weights of a row add up to zero",
              place="all nodes", time="the end")  # fmt: skip
    case.done()


def over(overhang: float) -> tuple[str, Floats, int]:
    """A stiff block that reaches beyond the soft one below it, pressed down on it as a whole: deck, nodes, nodes of the upper block."""
    upper = solids.as_kind(make_decks.block(between(0, 1 + overhang, 3), between(-overhang, 1, 4), between(1, 1.5, 1), "BODY"), "C3D8")
    lower = solids.as_kind(make_decks.block(between(0, 1, 4), between(0, 1, 3), between(0, 1, 2), "BODY"), "C3D8")
    n_upper = len(upper.nodes)
    nodes = np.concatenate([upper.nodes, lower.nodes])
    top = upper.where(2, 1.5)
    deck = (
        renumbered(upper, 0, 0, "ABOVE")
        + renumbered(lower, n_upper, len(upper.elements), "BELOW")
        + "*MATERIAL, NAME=STIFF\n*ELASTIC\n1e12, 0.\n*MATERIAL, NAME=SOFT\n*ELASTIC\n1000., 0.3\n"
        + "*SOLID SECTION, ELSET=ABOVE, MATERIAL=STIFF\n*SOLID SECTION, ELSET=BELOW, MATERIAL=SOFT\n"
        + "*SURFACE, NAME=SLAVE\n" + faces_at(upper, lambda x: np.ones(len(x)), 0)
        + "*SURFACE, NAME=MASTER\n" + faces_at(lower, lambda x: np.ones(len(x)), len(upper.elements))
        + "*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n"
        + "*STEP\n*STATIC\n1., 1.\n"
        + solids.prescribed(top, np.tile([0.0, 0.0, -PRESSURE / YOUNG], (len(top), 1)))
        + "".join(f"{n_upper + n + 1}, {axis + 1}\n" for axis in range(3) for n in lower.where(axis, 0.0))
        + "*END STEP\n"
    )
    return deck, nodes, n_upper


@pytest.mark.parametrize("overhang", [0.4, 0.02])
def test_overhang(proof: Proof, overhang: float) -> None:
    """Facets that are covered in part: 0.4 gives large parts and small ones, 0.02 gives bare slivers."""
    case = proof(
        f"mortar-overhang-{overhang:g}".replace(".", ""),
        title=f"A stiff block overhangs a soft one by {overhang:g}, surface to surface",
        model="The stiff block (E = 1e12) is the slave, 3 x 4 facets, and reaches over two edges of the soft one (E = 1000, nu = 0.3, 4 x 3 "
        "facets); it goes down by 0.01. Small displacements, no friction.",
        formula="The soft block stands under a uniform stress of -10.",
        source="T. Cichosz and M. Bischoff, Comput. Methods Appl. Mech. Engrg. 200 (2011) 1317-1332",
        proves="Duals made on the covered part of a facet pass a uniform pressure where the slave overhangs.",
    )
    deck, nodes, n_upper = over(overhang)
    job = case.run(deck, requested=1)
    points = job.integration_points("S")[-1]
    soft = points[12 * 8 :]
    case.near("stress of the soft block", soft, np.tile(STRESS, (len(soft), 1)), 1e-6, why="E of the stiff block is finite, and its size costs digits",
              place="all nodes of the soft block", time="the end")  # fmt: skip
    forces = job.last("RF")
    case.near("sum of forces", forces.sum(axis=0), 0.0, 1e-8, scale=PRESSURE, why="digits lost to the stiff block", place="all nodes", time="the end")
    case.near("sum of moments", np.cross(nodes, forces).sum(axis=0), 0.0, 1e-8, scale=PRESSURE, why="the same", place="all nodes", time="the end")
    case.done()


def as_mortar(proof: Proof) -> Proof:
    """Makes cases whose decks have surface-to-surface contact."""

    def make(name: str, **words: str) -> Case:
        case = proof(f"mortar-{name}", **{**words, "title": words["title"] + ", surface to surface"})
        run = case.run
        case.run = lambda deck, *args, **options: run(  # type: ignore[method-assign]
            deck.replace(", TYPE=NODE TO SURFACE", "").replace("*CONTACT PAIR,", "*CONTACT PAIR, TYPE=SURFACE TO SURFACE,"),
            *args,
            **options,
        )
        return case

    return make


def test_reversal(proof: Proof) -> None:
    """Press, drag, drag back: Coulomb's bound and the work of friction."""
    test_sliding.test_reversal(as_mortar(proof))


@pytest.mark.parametrize("degrees", [10, 30])
def test_stuck_block_turns(proof: Proof, degrees: float) -> None:
    """A block that sticks turns with the one below it: no force comes from turning."""
    test_sliding.test_stuck_block_turns(as_mortar(proof), degrees)


def test_hertz_point(proof: Proof) -> None:
    """Hertz, a ball on a plane."""
    test_hertz.test_hertz_point(as_mortar(proof))


def test_shrink_fit_quarter(proof: Proof) -> None:
    """A quarter of a curved fit on meshes that do not match: supports at slave nodes on both planes of symmetry."""
    case = proof(
        "mortar-shrink-fit-quarter",
        title="A quarter of a shrink fit with meshes that do not match, surface to surface",
        model="A quarter of two rings, 0.5 and 0.7 long, held at one end, radii 1, 1.5 and 2, the inner one 0.005 too large, E = 1000, nu = 0.3, mu = 0.2, NLGEOM, "
        "12 x 2 x 4 and 9 x 3 x 3 C3D8. The interference is taken out over a step (*CONTACT INTERFERENCE, SHRINK; 2 increments).",
        formula="Both halves of the quarter are mirror images; the force on each plane of symmetry is that of the other one.",
        source="symmetry of the model",
        proves="A slave node on a plane of symmetry meets what is in front of it. With a normal that leans out of the plane it could not where it sticks, and the "
        "job was cut back without end.",
    )
    parts = []
    for name, radii, n, y in (("INNER", (1.0, 1.505), 12, (0.0, 0.5)), ("OUTER", (1.5, 2.0), 9, (-0.1, 0.6))):
        part = make_decks.block(between(0, 1, n), between(*y, 2 if n == 12 else 3), between(*radii, 4 if n == 12 else 3), name)
        s, along, radius = part.nodes.T
        sets = {"LEFT": s == 0.0, "RIGHT": s == 1.0, "FRONT": along == y[0]}
        part.node_sets |= {f"{name}_{side}": np.flatnonzero(chosen) for side, chosen in sets.items()}
        angle = 0.5 * np.pi * (1 - s)
        part.nodes[:] = np.stack([radius * np.cos(angle), along, radius * np.sin(angle)], axis=1)
        parts.append((part, (1000.0, 0.3)))
    inner = parts[0][0]
    held = ("INNER_LEFT, 1", "OUTER_LEFT, 1", "INNER_RIGHT, 3", "OUTER_RIGHT, 3", "INNER_FRONT, 2", "OUTER_FRONT, 2")
    steps = test_sliding.step(test_sliding.fix(*held) + "*CONTACT INTERFERENCE, SHRINK\nINNER_TOP, OUTER_BOTTOM\n", 2, True)
    pairs = test_sliding.pair("INNER_TOP", "OUTER_BOTTOM", 0.2, ", TYPE=SURFACE TO SURFACE")
    job = case.run(test_sliding.solid_deck(parts, pairs, steps), requested=2)
    slaves = inner.node_sets["INNER_TOP"]
    angle = np.round(np.degrees(np.arctan2(inner.nodes[slaves, 2], inner.nodes[slaves, 0])), 6)
    order = np.lexsort((inner.nodes[slaves, 1], angle))
    mirrored = np.lexsort((inner.nodes[slaves, 1], -angle))
    pressure = job.last("CPRESS")[slaves]
    case.near("pressure, mirrored", pressure[order], pressure[mirrored], 1e-5, why="symmetry of the model; the tolerance of Newton's method", place="all slave nodes", time="1")
    case.true("it presses", bool(pressure.max() > 1.0), why="an interference of 0.005", place="all slave nodes", time="1")
    force = job.last("RF")[: len(inner.nodes)]
    left, right = force[inner.node_sets["INNER_LEFT"], 0].sum(), force[inner.node_sets["INNER_RIGHT"], 2].sum()
    case.near("forces on the planes of symmetry", left, right, 1e-6, why="symmetry", place="the inner ring", time="1")
    case.done()


def bent(increments: int) -> str:
    """A cantilever of 11 C3D8I whose tip goes down by its length over ten; a block under it ends at nine tenths of its length."""
    parts = {
        "BEAM": (make_decks.block(between(0, 10, 11), between(0, 1, 1), between(0.1, 0.6, 1), "BODY"), "C3D8I"),
        "BASE": (make_decks.block(between(6, 9, 4), between(-0.2, 1.3, 2), between(-1, 0, 2), "BODY"), "C3D8I"),
    }
    deck, held, first_node, first_element = "", "", 0, 0
    for name, (mesh, kind) in parts.items():
        body = solids.as_kind(mesh, kind)
        height = 0.1 if name == "BEAM" else 0.0
        deck += renumbered(body, first_node, first_element, name) + f"*SURFACE, NAME={name}_FACE\n"
        deck += faces_at(body, lambda x, z=height: np.full(len(x), z), first_element)  # type: ignore[misc]
        deck += f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL\n"
        if name == "BEAM":
            held += "".join(f"{n + 1}, 1, 3\n" for n in body.where(0, 0.0)) + "".join(f"{n + 1}, 2\n" for n in range(len(body.nodes)))
            tip = "".join(f"{n + 1}, 3, 3, -1.\n" for n in body.where(0, 10.0))
        else:
            held += "".join(f"{first_node + n + 1}, 1, 3\n" for n in body.where(2, -1.0))
        first_node, first_element = first_node + len(body.nodes), first_element + len(body.elements)
    return (
        deck
        + "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*SURFACE INTERACTION, NAME=I\n"
        + "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nBEAM_FACE, BASE_FACE\n*BOUNDARY\n" + held
        + f"*STEP, NLGEOM\n*STATIC\n{1 / increments}, 1., 1e-6, {1 / increments}\n*BOUNDARY\n" + tip + "*END STEP\n"
    )


def test_bent_over_edge(proof: Proof) -> None:
    """A slave that bends over the edge of its master: nodes beyond the edge are below the master's plane and inside nothing."""
    case = proof(
        "mortar-bent-over-edge",
        title="A cantilever bends over the edge of a block, surface to surface",
        model="A steel beam, 10 x 1 x 0.5, 11 C3D8I, held at one end and across, 0.1 above a block of 4 x 2 x 2 C3D8I that ends at 9. Its tip goes down by 1, NLGEOM, "
        "no friction. Exact contact; the lower face of the beam is the slave.",
        formula="Elastic bodies without friction: the end does not depend on the increments. The block bears what contact brings: its reactions have force and "
        "moment of the pair.",
        source="uniqueness of a path without dissipation; equilibrium",
        proves="What contact is near the edge of a master is the same whatever the increments, and forces act where the sums over the pair say.",
    )
    deck = bent(5)
    job = case.run(deck, requested=5)
    finer = case.run(bent(20), name="finer", requested=20)
    displacement = job.last("U")
    case.near("displacement", displacement, finer.last("U"), 2e-3, scale=1.0, why="the tolerance of Newton's method, 5e-3 of the force", place="all nodes", time="1")
    case.true("it touches", bool(job.last("CPRESS").max() > 0.0), why="the tip is 1 lower", place="all slave nodes", time="1")
    base = np.flatnonzero(job.points[:, 2] == -1.0)
    reaction = job.last("RF")[base]
    with h5py.File(job.path) as file:
        sums = {key: values[-1] for key, values in file["AMONTONS/pair_history"].items()}
    moment = np.cross(job.points[base], reaction).sum(axis=0)
    scale = float(np.linalg.norm(reaction.sum(axis=0)))
    case.near("force of the pair", sums["CFN"], reaction.sum(axis=0), 5e-3, scale=scale, why="the tolerance of Newton's method", place="the base of the block", time="1")
    case.near("moment of the pair", sums["CMN"], moment, 5e-3, scale=10 * scale, why="the same, times the length of the beam", place="the base of the block", time="1")
    case.done()


@pytest.mark.parametrize("angle", [62.0, 70.0, 77.0])
@pytest.mark.parametrize("place", [2.1, 2.2, 2.3])
def test_no_force_beside_a_steep_flank(run: Run, tmp_path: Path, angle: float, place: float) -> None:
    """A coarse slave stays a twentieth above a block whose steep flank begins below one of its faces. Bodies that are apart have no force,
    although the dual functions are negative where the gap is large.
    """
    gap, drop, low = 0.05, 1.0, 0.3
    flank = [place, place + drop / np.tan(np.radians(angle))]
    lines = np.concatenate([between(0.8, place, 3), between(*flank, 2)[1:], between(flank[1], 4.5, 4)[1:]])

    def block(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        return s, -2 + (2 - low - drop * np.interp(s, flank, [0, 1])) * t

    bodies = [(grid("PLATE", between(0, 4, 10), between(0, 0.4, 1)), "*ELASTIC\n1000., 0.3\n"),
              (grid("BLOCK", lines, between(0, 1, 2), place=block), "*ELASTIC\n9000., 0.3\n")]  # fmt: skip
    supports = fix("BLOCK_T0, 1, 2", "PLATE_T1, 1", f"PLATE_T1, 2, 2, {gap - low}")
    cards = pair("PLATE_T0", "BLOCK_T1", options=", TYPE=SURFACE TO SURFACE") + step(supports, 4, is_nlgeom=True)
    (tmp_path / "flank.inp").write_text(bodies_deck(bodies, "CPE4", cards))
    done = run(["--outdir", tmp_path, tmp_path / "flank.inp"], tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "flank.vtkhdf") as file:
        assert np.abs(np.asarray(file["VTKHDF/PointData/CPRESS"])).max() == 0.0
        assert np.abs(np.asarray(file["VTKHDF/PointData/RF"])).max() <= 1e-9, "rounding, of forces of 1"
