"""Meshes and decks: the generator of the decks in input/ and of block decks of any size.

Run without arguments it writes the decks of input/ again:

    python -m verify.decks.make_decks [--outdir input]
    python -m verify.decks.make_decks --block 20 [--linear] [--dialect calculix] > block20.inp

As a library it gives meshes of hexahedra (`block`, `arc_indenter`, `ball_octant`), puts them together (`join`) and
writes cards (`mesh_cards`, `block_deck`). Node and face numbering are those of Abaqus.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
STEEL = (210000.0, 0.3)


@dataclass
class Mesh:
    """Hexahedra with named sets; all numbers are indices from 0."""

    nodes: Floats  #: (n_nodes, 3) coordinates [length]
    elements: Ints  #: (n_elements, 8) node indices in Abaqus order
    node_sets: dict[str, Ints] = field(default_factory=dict)
    element_sets: dict[str, Ints] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, int]]] = field(default_factory=dict)  #: name: [(element set, face 1 to 6)]

    def select(self, name: str, inside: Callable[[Floats], NDArray[np.bool_]]) -> None:
        """Make a node set of the nodes whose coordinates (n, 3) are inside."""
        self.node_sets[name] = np.flatnonzero(inside(self.nodes))


# ---------------------------------------------------------------------------------------------------- meshes


def graded(length: float, first: float, n_equal: int, n_growing: int) -> Floats:
    """Points from 0 to length: n_equal cells of size first, then n_growing cells in geometric growth."""
    rest = length - n_equal * first
    low, high = 1.0, 100.0
    for _ in range(200):
        ratio = 0.5 * (low + high)
        total = sum(first * ratio ** (i + 1) for i in range(n_growing))
        low, high = (ratio, high) if total < rest else (low, ratio)
    sizes = [first] * n_equal + [first * low ** (i + 1) for i in range(n_growing)]
    points = np.concatenate([[0.0], np.cumsum(sizes)])
    return points * (length / points[-1])


def grid_elements(nx: int, ny: int, nz: int) -> Ints:
    """Hexahedra of a grid of nx x ny x nz cells whose nodes run x fastest, then y, then z."""
    i, j, k = (a.ravel(order="F") for a in np.meshgrid(range(nx), range(ny), range(nz), indexing="ij"))
    row, layer = nx + 1, (nx + 1) * (ny + 1)
    base = i + row * j + layer * k
    lower = np.stack([base, base + 1, base + 1 + row, base + row], axis=1)
    return np.concatenate([lower, lower + layer], axis=1)


def block(x: Sequence[float] | Floats, y: Sequence[float] | Floats, z: Sequence[float] | Floats, name: str) -> Mesh:
    """A block from its grid lines; sets NAME (all) and surfaces NAME_BOTTOM and NAME_TOP (z lowest and highest)."""
    grid = np.meshgrid(x, y, z, indexing="ij")
    nodes = np.stack([g.ravel(order="F") for g in grid], axis=1)
    return _named_grid(nodes, (len(x) - 1, len(y) - 1, len(z) - 1), name)


def _named_grid(nodes: Floats, cells: tuple[int, int, int], name: str) -> Mesh:
    """A grid of hexahedra with the sets and surfaces of `block`."""
    nx, ny, nz = cells
    mesh = Mesh(nodes, grid_elements(nx, ny, nz))
    layer_n, layer_e = (nx + 1) * (ny + 1), nx * ny
    everything = np.arange(nx * ny * nz)
    mesh.element_sets = {name: everything, f"{name}_E1": everything[:layer_e], f"{name}_E2": everything[-layer_e:]}
    mesh.node_sets = {f"{name}_BOTTOM": np.arange(layer_n), f"{name}_TOP": np.arange(layer_n * nz, layer_n * (nz + 1))}
    mesh.surfaces = {f"{name}_BOTTOM": [(f"{name}_E1", 1)], f"{name}_TOP": [(f"{name}_E2", 2)]}
    return mesh


def arc_indenter(
    centre: float, half: float, radius: float, pole: float, top: float, nx: int, nz: int, name: str
) -> Mesh:
    """One layer (0 <= y <= 1) of an indenter: bottom an arc in x-z with its pole at z = pole, flat top at z = top.

    Columns are straight and vertical; sizes along the arc are equal in x; rows are equal in each column.
    """
    x = np.linspace(-half, half, nx + 1)
    bottom = pole + radius - np.sqrt(radius**2 - x**2)
    rows = np.linspace(0.0, 1.0, nz + 1)
    xs, ys, rs = np.meshgrid(x, [0.0, 1.0], rows, indexing="ij")
    zs = bottom[:, None, None] * (1.0 - rs) + top * rs
    nodes = np.stack([a.ravel(order="F") for a in (xs + centre, ys, zs)], axis=1)
    return _named_grid(nodes, (nx, 1, nz), name)


def ball_octant(radius: float, lateral: Floats, n_core: int, radial: Floats, name: str) -> Mesh:
    """The octant x, y >= 0 of a ball, its centre at (0, 0, radius), its lower pole in the origin.

    A core block is surrounded by three outer blocks; `lateral` (0 to 1) are the lines from the polar axis outwards (1
    is 45 degrees on the sphere), `radial` (0 to 1) the lines from the core to the sphere, n_core the cells of the
    core in height. Surface NAME_CAP is the polar block's part of the sphere, NAME_EQUATOR the node set z = radius.
    """
    edge, diagonal, corner = 0.5 * radius, 0.45 * radius, 0.40 * radius
    steps = np.linspace(0.0, 1.0, n_core + 1)

    def core(s: Floats, t: Floats, w: Floats) -> Floats:
        def side(a: Floats, b: Floats, c: Floats) -> Floats:
            reach = edge * (1 - b) * (1 - c) + diagonal * (b * (1 - c) + c * (1 - b)) + corner * b * c
            return a * reach

        return np.stack([side(s, t, w), side(t, s, w), side(w, s, t)], axis=-1)

    def shell(axis: int) -> Callable[[Floats, Floats, Floats], Floats]:
        def place(a: Floats, b: Floats, r: Floats) -> Floats:
            one = np.ones_like(a)
            inner = core(*np.roll([a, b, one], axis + 1, axis=0))
            ray = np.stack(
                list(np.roll([np.tan(a * math.pi / 4), np.tan(b * math.pi / 4), one], axis + 1, axis=0)), axis=-1
            )
            sphere = radius * ray / np.linalg.norm(ray, axis=-1, keepdims=True)
            return inner * (1 - r[..., None]) + sphere * r[..., None]

        return place

    # np.roll by axis + 1: axis 2 keeps (a, b, 1) = (x, y, z); axis 0 gives (1, a, b); axis 1 gives (b, 1, a).
    parts = [
        _mapped(core, lateral, lateral, steps),
        _mapped(shell(2), lateral, lateral, radial),
        _mapped(shell(0), lateral, steps, radial),
        _mapped(shell(1), steps, lateral, radial),
    ]
    counts = np.cumsum([0] + [len(p.elements) for p in parts])
    mesh = weld(parts, 1e-6 * radius)
    n = len(lateral) - 1
    cap = np.arange(counts[2] - n * n, counts[2])
    mesh.element_sets = {name: np.arange(len(mesh.elements)), f"{name}_CAP_E": cap}
    mesh.surfaces = {f"{name}_CAP": [(f"{name}_CAP_E", 2)]}
    mesh.select(f"{name}_EQUATOR", lambda p: np.abs(p[:, 2]) < 1e-6 * radius)
    mesh.nodes = mesh.nodes[:, [1, 0, 2]] * [1.0, 1.0, -1.0] + [0.0, 0.0, radius]
    return mesh


def _mapped(place: Callable[[Floats, Floats, Floats], Floats], a: Floats, b: Floats, c: Floats) -> Mesh:
    """A mapped block from its grid lines in the unit cube."""
    grid = [g.ravel(order="F") for g in np.meshgrid(a, b, c, indexing="ij")]
    return Mesh(place(*grid), grid_elements(len(a) - 1, len(b) - 1, len(c) - 1))


def weld(parts: Iterable[Mesh], distance: float) -> Mesh:
    """Parts put together, nodes at the same place (to `distance`) made one; sets are lost."""
    glued = join(parts)
    keys = np.round(glued.nodes / distance).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return Mesh(glued.nodes[first[order]], rank[inverse.ravel()][glued.elements])


def join(parts: Iterable[Mesh]) -> Mesh:
    """Parts put together with their sets, nothing glued."""
    whole = Mesh(np.empty((0, 3)), np.empty((0, 8), dtype=np.int64))
    for part in parts:
        n, e = len(whole.nodes), len(whole.elements)
        whole.nodes = np.concatenate([whole.nodes, part.nodes])
        whole.elements = np.concatenate([whole.elements, part.elements + n])
        whole.node_sets |= {name: members + n for name, members in part.node_sets.items()}
        whole.element_sets |= {name: members + e for name, members in part.element_sets.items()}
        whole.surfaces |= part.surfaces
    return whole


def corner_volumes(mesh: Mesh) -> Floats:
    """(n_elements, 8) Jacobian determinants at the corners of each element: all positive in a valid mesh [volume/8]."""
    neighbours = [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)]
    corners = mesh.nodes[mesh.elements]
    columns = []
    for here, others in enumerate(neighbours):
        edges = corners[:, others, :] - corners[:, [here], :]
        columns.append(np.linalg.det(edges))
    return np.stack(columns, axis=1)


# ----------------------------------------------------------------------------------------------------- cards


def mesh_cards(mesh: Mesh) -> str:
    """The cards *NODE, *ELEMENT, *NSET, *ELSET and *SURFACE of a mesh; labels are indices plus one."""
    lines = ["*NODE"]
    lines += [f"{i}, " + ", ".join(_number(v) for v in point) for i, point in enumerate(mesh.nodes, start=1)]
    lines += ["*ELEMENT, TYPE=C3D8"]
    lines += [f"{i}, " + ", ".join(str(n + 1) for n in nodes) for i, nodes in enumerate(mesh.elements, start=1)]
    for name, members in mesh.node_sets.items():
        lines += _set_card("NSET", name, members)
    for name, members in mesh.element_sets.items():
        lines += _set_card("ELSET", name, members)
    for name, entries in mesh.surfaces.items():
        lines += [f"*SURFACE, NAME={name}"] + [f"{elset}, S{face}" for elset, face in entries]
    return "\n".join(lines) + "\n"


def _number(value: float) -> str:
    """A coordinate in at most ten digits, without a negative zero."""
    text = f"{value:.10g}"
    return text.lstrip("-") if float(text) == 0 else text


def _set_card(card: str, name: str, members: Ints) -> list[str]:
    """A set: GENERATE where the members are consecutive, else ten a line."""
    labels = [int(m) + 1 for m in members]
    if labels == list(range(labels[0], labels[-1] + 1)):
        return [f"*{card}, {card}={name}, GENERATE", f"{labels[0]}, {labels[-1]}, 1"]
    rows = [", ".join(str(v) for v in labels[i : i + 10]) for i in range(0, len(labels), 10)]
    return [f"*{card}, {card}={name}"] + rows


def material_cards(name: str, elastic: tuple[float, float], elset: str) -> str:
    """An elastic material (E, nu) and the section that gives it to an element set."""
    young, nu = elastic
    return f"*MATERIAL, NAME={name}\n*ELASTIC\n{young:g}, {nu:g}\n*SOLID SECTION, ELSET={elset}, MATERIAL={name}\n"


def contact_cards(slave: str, master: str, mu: float, kind: str = "NODE TO SURFACE", behavior: str = "HARD") -> str:
    """A contact pair with its interaction; behavior is HARD, or the data of a LINEAR law."""
    law = f"PRESSURE-OVERCLOSURE={behavior}" if behavior == "HARD" else f"PRESSURE-OVERCLOSURE=LINEAR\n{behavior}"
    friction = f"*FRICTION\n{mu:g}\n" if mu > 0 else ""
    return (
        f"*SURFACE INTERACTION, NAME=RUBBING\n*SURFACE BEHAVIOR, {law}\n{friction}"
        f"*CONTACT PAIR, INTERACTION=RUBBING, TYPE={kind}\n{slave}, {master}\n"
    )


OUTPUT_CARDS = "*NODE FILE\nU, RF\n*EL FILE\nS, E\n*CONTACT FILE\nCDIS, CSTR\n"


# ----------------------------------------------------------------------------------------------------- decks

THREE_CUBES = """\
** Three cubes: two stand side by side and are the table, the third is pressed on it and dragged over the seam.
**
** The smallest deck with frictional contact. Step 1 presses, step 2 drags; the cube first sticks, then slides.
** The mesh (20 nodes, 3 elements, sets FLOOR, LID, TABLE, CUBE, ALL) is in three_cubes.mesh beside this file.
** Runs in a moment. Units: N, mm.
*INCLUDE, INPUT=three_cubes.mesh
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*SURFACE, NAME=TABLE_TOP
TABLE, S2
*SURFACE, NAME=CUBE_SOLE
CUBE, S1
*SURFACE INTERACTION, NAME=RUBBING
*FRICTION
0.3
*CONTACT PAIR, INTERACTION=RUBBING
CUBE_SOLE, TABLE_TOP
*STEP, NLGEOM
*STATIC
0.1, 1., , 0.1
*BOUNDARY
FLOOR, 1, 3
LID, 1, 2
LID, 3, 3, -0.001
*END STEP
*STEP, NLGEOM
*STATIC
0.1, 1., , 0.1
*BOUNDARY
LID, 1, 1, 0.003
*END STEP
"""


def three_cubes_mesh() -> str:
    """The mesh of three_cubes.inp: the table's two cubes and the smaller one above their seam."""
    table = block([0, 1, 2], [0, 1], [0, 1], "TABLE")
    cube = block([0.4, 1.2], [0.1, 0.9], [1, 1.8], "CUBE")
    mesh = join([table, cube])
    mesh.node_sets = {"FLOOR": mesh.node_sets["TABLE_BOTTOM"], "LID": mesh.node_sets["CUBE_TOP"]}
    mesh.element_sets = {"TABLE": np.array([0, 1]), "CUBE": np.array([2]), "ALL": np.arange(3)}
    mesh.surfaces = {}
    return (
        "** The mesh of three_cubes.inp: nodes with their places, elements with their nodes, and named sets of both.\n"
        + mesh_cards(mesh)
    )


def block_mesh(n: int, lower: int | None = None) -> Mesh:
    """Upper block 1 x 1 x 0.5 (n elements on its edge) over the middle of a lower one 2 x 2 x 1 (`lower` on its edge).

    Without `lower`, about 1.5 n: some 6.7 n^3 unknowns in all; no node of the upper block lies on a facet edge.
    """
    m = lower or next(m for m in range(round(1.5 * n), n, -1) if not _lines_meet(n, m))
    line = np.linspace(-0.5, 0.5, n + 1)
    below = np.linspace(-1.0, 1.0, m + 1)
    bottom = block(below, below, np.linspace(-1.0, 0.0, (m + 1) // 2 + 1), "LOWER")
    return join([block(line, line, np.linspace(0.0, 0.5, (n + 1) // 2 + 1), "UPPER"), bottom])


def _lines_meet(n: int, m: int) -> bool:
    """Whether a grid line of the upper block lies on one of the lower: 1/2 + k/n = 2 j/m for some k, j."""
    return any((n * m + 2 * k * m) % (4 * n) == 0 for k in range(n + 1))


def block_deck(
    n: int,
    *,
    lower: int | None = None,
    is_nlgeom: bool = True,
    mu: float = 0.3,
    dialect: str = "abaqus",
    surface_to_surface: bool = False,
    title: str = "",
) -> str:
    """The friction benchmark: pressed by 0.002 in ten increments, then dragged by 0.004 in ten more.

    In the calculix dialect the contact law is LINEAR with K = 50 E, which is what CalculiX makes of HARD.
    """
    step = "*STEP, NLGEOM" if is_nlgeom else "*STEP"
    behavior = "HARD" if dialect == "abaqus" else f"{50 * STEEL[0]:g}, 1."
    kind = "SURFACE TO SURFACE" if surface_to_surface else "NODE TO SURFACE"
    head = title or f"** Block pressed and dragged over a block, {n} elements on the upper edge.\n"
    return (
        (f"** dialect: {dialect}\n" if dialect != "abaqus" else "")
        + head
        + mesh_cards(_with_all(block_mesh(n, lower)))
        + material_cards("STEEL", STEEL, "ALL")
        + contact_cards("UPPER_BOTTOM", "LOWER_TOP", mu, kind, behavior)
        + f"{step}\nPress\n*STATIC\n0.1, 1., , 0.1\n"
        + "*BOUNDARY\nLOWER_BOTTOM, 1, 3\nUPPER_TOP, 1, 2\nUPPER_TOP, 3, 3, -0.002\n"
        + "*NODE PRINT, NSET=UPPER_TOP, TOTALS=ONLY\nRF\n"
        + OUTPUT_CARDS
        + f"*END STEP\n{step}\nDrag\n*STATIC\n0.1, 1., , 0.1\n*BOUNDARY\nUPPER_TOP, 1, 1, 0.004\n*END STEP\n"
    )


def _with_all(mesh: Mesh) -> Mesh:
    """The mesh with an element set ALL."""
    mesh.element_sets["ALL"] = np.arange(len(mesh.elements))
    return mesh


SHEAR_BLOCK = """\
** Shear block: an elastic block pressed on a larger one, then dragged over it with friction.
**
** Upper block 1 x 1 x 0.5, lower block 2 x 2 x 1, meshes that do not match, E = 210000, nu = 0.3, mu = 0.3, NLGEOM.
** Step 1 presses the top down by 0.002 and keeps it from moving sideways; step 2 drags it by 0.004 along x while the
** press stays. First everything sticks but the rim, then the slip zone grows inwards, and at the end all of it slides.
** 9936 unknowns, 144 slave nodes, 20 increments: about five seconds on one core. Units: N, mm.
"""


def hertz_deck(fine: float = 0.75) -> str:
    """A ball's octant pressed on a rigid flat: Hertz. fine: the elements at the contact."""
    radius, press, elastic = 50.0, 0.5, (20000.0, 0.3)
    modulus = elastic[0] / (1 - elastic[1] ** 2)
    a, force = math.sqrt(radius * press), 4 / 3 * modulus * math.sqrt(radius) * press**1.5
    p0 = 3 * force / (2 * math.pi * a * a)
    quarter_arc = radius * math.pi / 4
    lateral = graded(quarter_arc, fine, math.ceil(5.25 / fine), 6) / quarter_arc
    radial = 1.0 - graded(0.5 * radius, fine, round(1.5 / fine), 6)[::-1] / (0.5 * radius)
    ball = ball_octant(radius, lateral, 4, radial, "BALL")
    on_cap = np.max(ball.nodes[ball.elements[ball.element_sets["BALL_CAP_E"]]][:, :, :2], axis=(1, 2)) < 14.0
    ball.element_sets["BALL_CAP_E"] = ball.element_sets["BALL_CAP_E"][on_cap]
    ball.select("SYMMETRY_X", lambda p: np.abs(p[:, 0]) < 1e-9 * radius)
    ball.select("SYMMETRY_Y", lambda p: np.abs(p[:, 1]) < 1e-9 * radius)
    plate = block([-2, 7, 16], [-2, 7, 16], [-5, 0], "PLATE")
    plate.node_sets["PLATE"] = np.arange(len(plate.nodes))
    mesh = _with_all(join([ball, plate]))
    head = f"""\
** Hertz: an elastic ball pressed on a rigid flat without friction, by symmetry one octant of it.
**
** R = {radius:g}, E = {elastic[0]:g}, nu = {elastic[1]:g}; the equator goes down by d = {press:g}; small displacements.
** The flat is a fixed plate. Closed form (Hertz 1882), P the force on the whole ball (four times the deck's):
**   E* = E/(1 - nu^2) = {modulus:.1f},  a = (3 P R / (4 E*))^(1/3),  p0 = 3 P / (2 pi a^2),  P = 4/3 E* R^(1/2) d^(3/2)
** d = {press:g} gives a = {a:.3f}, p0 = {p0:.1f}, P = {force:.0f} for a ball whose approach is measured far away.
** The equator is not: expect P some 6 % higher, and for that P the edge within one element ({fine:g}), p0 within 1 %.
** {3 * len(mesh.nodes)} unknowns, 5 increments: about a second on one core. Units: N, mm.
"""
    return (
        head
        + mesh_cards(mesh)
        + material_cards("BALL", elastic, "ALL")
        + contact_cards("BALL_CAP", "PLATE_TOP", 0.0)
        + "*STEP\nPress\n*STATIC\n0.2, 1., , 0.2\n"
        + f"*BOUNDARY\nPLATE, 1, 3\nSYMMETRY_X, 1\nSYMMETRY_Y, 2\nBALL_EQUATOR, 3, 3, {-press:g}\n"
        + "*NODE PRINT, NSET=BALL_EQUATOR, TOTALS=ONLY\nRF\n"
        + OUTPUT_CARDS
        + "*END STEP\n"
    )


def ironing_deck() -> str:
    """A curved indenter pressed into a soft slab and dragged along it, plane strain."""
    slab = block(np.linspace(0, 9, 61), [0, 1], 3.0 - graded(3.0, 0.15, 4, 6)[::-1], "SLAB")
    iron = arc_indenter(2.1, 0.6, 0.75, 3.05, 4.25, 12, 10, "IRON")
    mesh = join([iron, slab])
    mesh.select("PLANE", lambda p: np.full(len(p), True))
    head = f"""\
** Ironing: a curved elastic indenter is pressed into a softer slab and dragged along it over many facets.
**
** After the shallow ironing of Fischer and Wriggers (2006): one layer of elements in plane strain (y is held), indenter
** E = 6896, slab E = 689.6, nu = 0.32, mu = 0.3, NLGEOM. The indenter's bottom is an arc of radius 0.75, 0.05 above the
** slab; step 1 presses its top down by 0.3, step 2 drags it by 4 along x: 27 facets of 0.15. Increments are automatic.
** {3 * len(mesh.nodes)} unknowns, half of them held: about five seconds on one core. Units: N, mm.
"""
    return (
        head
        + mesh_cards(mesh)
        + material_cards("HARD", (6896.0, 0.32), "IRON")
        + material_cards("SOFT", (689.6, 0.32), "SLAB")
        + contact_cards("IRON_BOTTOM", "SLAB_TOP", 0.3)
        + "*STEP, NLGEOM, INC=200\nPress\n*STATIC\n0.1, 1., 1e-4, 0.1\n"
        + "*BOUNDARY\nSLAB_BOTTOM, 1\nSLAB_BOTTOM, 3\nPLANE, 2\nIRON_TOP, 1\nIRON_TOP, 3, 3, -0.3\n"
        + "*NODE PRINT, NSET=IRON_TOP, TOTALS=ONLY\nRF\n"
        + OUTPUT_CARDS
        + "*END STEP\n*STEP, NLGEOM, INC=500\nDrag\n*STATIC\n0.01, 1., 1e-5, 0.025\n"
        + "*BOUNDARY\nIRON_TOP, 1, 1, 4.\n*END STEP\n"
    )


def input_decks() -> dict[str, str]:
    """The files of input/ by name."""
    return {
        "three_cubes.inp": THREE_CUBES,
        "three_cubes.mesh": three_cubes_mesh(),
        "shear_block.inp": block_deck(11, lower=15, title=SHEAR_BLOCK),
        "hertz_octant.inp": hertz_deck(),
        "ironing.inp": ironing_deck(),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the decks of input/, or print one block deck."""
    parser = argparse.ArgumentParser(description="Write the decks of input/, or print a block deck.")
    parser.add_argument("--outdir", type=Path, default=Path(__file__).resolve().parents[2] / "input")
    parser.add_argument("--block", type=int, metavar="N", help="print the block deck with N elements on the upper edge")
    parser.add_argument("--linear", action="store_true", help="block deck without NLGEOM")
    parser.add_argument("--surface-to-surface", action="store_true", help="block deck of that contact type")
    parser.add_argument("--dialect", choices=["abaqus", "calculix"], default="abaqus")
    options = parser.parse_args(arguments)
    if options.block:
        sys.stdout.write(
            block_deck(
                options.block,
                is_nlgeom=not options.linear,
                dialect=options.dialect,
                surface_to_surface=options.surface_to_surface,
            )
        )
        return 0
    for name, text in input_decks().items():
        (options.outdir / name).write_text(text)
        print(f"{options.outdir / name}: {len(text) // 1000} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
