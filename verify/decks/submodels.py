"""Decks of submodels: blocks in a homogeneous state, and a plate with a hole whose region around the hole is cut out.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from verify.decks.make_decks import block as block_mesh
from verify.decks.solids import Solids, as_kind, node_set, prescribed

Floats = NDArray[np.float64]

E, NU = 1000.0, 0.3
LAW = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
#: displacement gradient of the homogeneous state
GRADIENT = np.array([[0.02, 0.05, -0.01], [0.01, -0.03, 0.02], [0.00, 0.04, 0.01]])
CARD = "*SUBMODEL, TYPE=NODE, INPUT={}\nCUT\n"
RADIUS, REMOTE = 1.0, 10.0  #: of the hole [length], stress far from it [stress]
OUTER, CUT_RADIUS = 8.0, 2.5  #: of the global model and of the submodel [length]


def block(kind: str, counts: tuple[int, int, int], low: Floats, high: Floats, shake: float = 0.0) -> Solids:
    """A box of elements; inner nodes of the grid may be shaken, over the size of a cell."""
    mesh = block_mesh(*(np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True)), name="B")
    if shake:
        inner = np.all((mesh.nodes > low + 1e-9) & (mesh.nodes < high - 1e-9), axis=1)
        cell = (high - low) / np.array(counts)
        random = np.random.default_rng(5)
        mesh.nodes[inner] += shake * cell * random.uniform(-1, 1, (int(inner.sum()), 3))
    return as_kind(mesh, kind)


def homogeneous_global(mesh: Solids, steps: str) -> str:
    """A block whose surface moves by GRADIENT x; the steps are text with {} where *BOUNDARY cards of the surface stand."""
    outer = mesh.boundary_nodes()
    moved = prescribed(outer, mesh.nodes[outer] @ GRADIENT.T)
    return mesh.cards() + LAW + steps.replace("{}", moved)


def short_rows(members: Iterable[int], values: Floats) -> str:
    """*BOUNDARY in numbers of at most twenty characters, which is what CalculiX reads."""
    rows = (f"{int(n) + 1}, {d}, {d}, {v:.11g}\n" for n, value in zip(members, values, strict=True) for d, v in enumerate(value, start=1))
    return "*BOUNDARY\n" + "".join(rows)


def submodel(mesh: Solids, card: str, steps: str) -> str:
    """A block whose surface is the set CUT."""
    return mesh.cards() + LAW + node_set("CUT", mesh.boundary_nodes()) + card + steps


def kirsch(x: Floats) -> Floats:
    """Displacements around a hole under tension along x, plane strain.

    Source: S. Timoshenko, J. N. Goodier, Theory of elasticity, 3rd ed., section 35 (stresses, integrated).
    """
    r, angle = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])
    mu, kappa, a = E / (2 * (1 + NU)), 3 - 4 * NU, RADIUS
    scale = REMOTE * a / (8 * mu)
    u = scale * (r / a * (kappa + 1) * np.cos(angle) + 2 * a / r * ((1 + kappa) * np.cos(angle) + np.cos(3 * angle)) - 2 * a**3 / r**3 * np.cos(3 * angle))
    v = scale * (r / a * (kappa - 3) * np.sin(angle) + 2 * a / r * ((1 - kappa) * np.sin(angle) + np.sin(3 * angle)) - 2 * a**3 / r**3 * np.sin(3 * angle))
    return np.stack([u, v, np.zeros_like(u)], axis=1)


def quarter_ring(counts: tuple[int, int], outer: float, kind: str = "C3D20R") -> Solids:
    """A quarter of a ring around the hole, one element thick, radial steps in a geometric series, mid-side nodes on the arcs."""
    n_r, n_a = counts
    mesh = as_kind(block_mesh(*(np.linspace(0.0, 1.0, n + 1) for n in (n_r, n_a, 1)), name="R"), kind)
    s, t, z = mesh.nodes.T
    r, angle = RADIUS * (outer / RADIUS) ** s, t * np.pi / 2
    mesh.nodes[:] = np.stack([r * np.cos(angle), r * np.sin(angle), 0.5 * z], axis=1)
    return mesh


def plate(mesh: Solids, driven: str) -> str:
    """A quarter of the plate with its symmetries, in plane strain, and a step; driven: cards before the step, then {} and those in it."""
    flat = node_set("FLAT", range(len(mesh.nodes))) + node_set("SYMX", np.flatnonzero(np.abs(mesh.nodes[:, 0]) < 1e-9))
    flat += node_set("SYMY", np.flatnonzero(np.abs(mesh.nodes[:, 1]) < 1e-9))
    before, _, within = driven.partition("{}")
    return (
        "** dialect: calculix\n" + mesh.cards() + LAW + flat + before + "*BOUNDARY\nFLAT, 3\nSYMX, 1\nSYMY, 2\n"
        f"*STEP\n*STATIC\n{within}*NODE FILE\nU, RF\n*EL FILE\nS\n*END STEP\n"
    )


def plate_global() -> str:
    """The coarse plate, whose outer edge moves by Kirsch's solution."""
    mesh = quarter_ring((6, 6), OUTER)
    edge = np.flatnonzero(np.abs(np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) - OUTER) < 1e-9)
    return plate(mesh, "{}" + short_rows(edge, kirsch(mesh.nodes[edge])))


def plate_submodel(card: str = CARD.format("global.frd"), counts: tuple[int, int] = (10, 16)) -> str:
    """The fine region around the hole, driven at its outer edge."""
    mesh = quarter_ring(counts, CUT_RADIUS)
    edge = np.flatnonzero(np.abs(np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) - CUT_RADIUS) < 1e-9)
    return plate(mesh, node_set("CUT", edge) + card + "{}*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 2\n")
