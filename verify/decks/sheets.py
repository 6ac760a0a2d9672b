"""Decks in the plane: sheets of one layer of hexahedra in x-z, mapped from a grid, with y held; and steps in few words.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from verify.decks.make_decks import Mesh, _named_grid, join, material_cards, mesh_cards

Floats = NDArray[np.float64]
Place = Callable[[Floats, Floats], tuple[Floats, Floats]]


def sheet(name: str, s: Sequence[float] | Floats, t: Sequence[float] | Floats, place: Place | None = None) -> Mesh:
    """One layer (0 <= y <= 1) of a mapped block: x, z = place(s, t), right-handed (s, y, t).

    Surfaces NAME_BOTTOM and NAME_TOP (lowest and highest t), NAME_LEFT and NAME_RIGHT (lowest and highest s); node
    sets of the same names, and the element set NAME.
    """
    ss, ys, tt = np.meshgrid(s, [0.0, 1.0], t, indexing="ij")
    xs, zs = place(ss, tt) if place else (ss, tt)
    nodes = np.stack([a.ravel(order="F") for a in (xs, ys, zs)], axis=1)
    n, m = len(s) - 1, len(t) - 1
    mesh = _named_grid(nodes, (n, 1, m), name)
    first, last = np.arange(m) * n, np.arange(m) * n + n - 1
    mesh.element_sets |= {f"{name}_L": first, f"{name}_R": last}
    mesh.surfaces |= {f"{name}_LEFT": [(f"{name}_L", 6)], f"{name}_RIGHT": [(f"{name}_R", 4)]}
    columns = np.arange(len(nodes)) % (n + 1)
    mesh.node_sets |= {f"{name}_LEFT": np.flatnonzero(columns == 0), f"{name}_RIGHT": np.flatnonzero(columns == n)}
    return mesh


def both_directions(line: Floats) -> Floats:
    """-line and line."""
    return np.concatenate([-line[:0:-1], line])


def between(low: float, high: float, n: int) -> Floats:
    """n equal cells."""
    return np.linspace(low, high, n + 1)


def fix(*entries: str) -> str:
    """*BOUNDARY with its data lines."""
    return "*BOUNDARY\n" + "".join(f"{entry}\n" for entry in entries)


def step(cards: str, n: int, is_nlgeom: bool = False, is_direct: bool = False) -> str:
    """A step of length 1 with n equal increments."""
    direct = ", DIRECT" if is_direct else ""
    least = f"1., 1e-6, {1 / n:.15g}" if not is_direct else "1."
    return f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=1000\n*STATIC{direct}\n{1 / n:.15g}, {least}\n{cards}*END STEP\n"


def pair(slave: str, master: str, mu: float = 0.0, options: str = "") -> str:
    """A contact pair with an interaction of its own."""
    friction = f"*FRICTION\n{mu:.15g}\n" if mu > 0 else ""
    name = f"ON_{master}"
    return f"*SURFACE INTERACTION, NAME={name}\n{friction}*CONTACT PAIR, INTERACTION={name}{options}\n{slave}, {master}\n"


def plane_deck(
    parts: Iterable[tuple[Mesh, tuple[float, float]]], pairs: str, steps: str, sets: dict[str, NDArray] | None = None
) -> str:
    """Plane strain: parts with their (E, nu), each named by its first element set; PLANE holds all nodes."""
    return solid_deck(parts, pairs, steps.replace("*END STEP", "*BOUNDARY\nPLANE, 2\n*END STEP", 1), sets)


def solid_deck(
    parts: Iterable[tuple[Mesh, tuple[float, float]]], pairs: str, steps: str, sets: dict[str, NDArray] | None = None
) -> str:
    """The same without the support across the plane."""
    parts = list(parts)
    mesh = join(part for part, _ in parts)
    mesh.node_sets["PLANE"] = np.arange(len(mesh.nodes))
    mesh.node_sets |= sets or {}
    names = [next(iter(part.element_sets)) for part, _ in parts]
    materials = "".join(material_cards(name, elastic, name) for name, (_, elastic) in zip(names, parts, strict=True))
    return mesh_cards(mesh) + materials + pairs + steps


def rows_of(mesh: Mesh, name: str, layer: float = 0.0) -> NDArray:
    """The nodes of a set with y = layer, from left to right."""
    members = mesh.node_sets[name]
    members = members[np.abs(mesh.nodes[members, 1] - layer) < 1e-9]
    return members[np.argsort(mesh.nodes[members, 0], kind="stable")]
