"""Geometry of contact: closest points on bilinear facets, a continuous normal, material points, tributary areas.

The normal is the one of doc/theory/contact.md: at each node the area vectors of the facets around it (at that node) are
added, and the unit sums are interpolated over the facet. A facet on the rim of a surface reaches a tenth of its length
beyond itself. Written independently of the solver: closest points instead of rays, edges in closed form; on the
surface both are the same point.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SIGNS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
CANDIDATES = 16  #: facets tried for each slave node, nearest centres first
FEATURE_COSINE = np.cos(np.pi / 4)  #: facet normals further apart than this are not averaged: a crease
EXTENSION = 0.1  #: a point this far beyond the rim is still on the surface, in lengths of the facet


@dataclass
class Projection:
    """Where slave points fall on the master."""

    facet: Ints  #: (n) index of the closest facet
    xi: Floats  #: (n, 2) natural coordinates in it
    point: Floats  #: (n, 3) closest point [length]
    normal: Floats  #: (n, 3) continuous unit normal there
    gap: Floats  #: (n) signed distance, negative is penetration [length]
    is_beside: NDArray[np.bool_]  #: (n) the closest point is on the rim of the surface and the slave is beyond it


def shapes(xi: Floats) -> Floats:
    """(..., 4) bilinear shape functions at (..., 2)."""
    return 0.25 * (1 + xi[..., 0, None] * SIGNS[:, 0]) * (1 + xi[..., 1, None] * SIGNS[:, 1])


def shape_slopes(xi: Floats) -> Floats:
    """(..., 4, 2) their derivatives."""
    first = 0.25 * SIGNS[:, 0] * (1 + xi[..., 1, None] * SIGNS[:, 1])
    second = 0.25 * SIGNS[:, 1] * (1 + xi[..., 0, None] * SIGNS[:, 0])
    return np.stack([first, second], axis=-1)


def facet_point(corners: Floats, xi: Floats) -> Floats:
    """(..., 3) points of facets with corners (..., 4, 3)."""
    return np.einsum("...a,...ai->...i", shapes(xi), corners)


def facet_normal(corners: Floats, xi: Floats) -> Floats:
    """(..., 3) x,1 cross x,2: the normal with the length of the area element."""
    tangents = np.einsum("...ad,...ai->...di", shape_slopes(xi), corners)
    return np.cross(tangents[..., 0, :], tangents[..., 1, :])


def unit(vectors: Floats) -> Floats:
    """Vectors over their lengths."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def corner_normals(reference: Floats, current: Floats, quads: Ints) -> Floats:
    """(n_facets, 4, 3) area-weighted unit normal at each corner of each facet.

    Facets around a node are taken together unless, in the reference configuration, they meet in a crease.
    """
    n = len(quads)
    place = np.broadcast_to(SIGNS, (n, 4, 2))
    here = facet_normal(np.repeat(current[quads][:, None], 4, axis=1), place)
    before = unit(facet_normal(np.repeat(reference[quads][:, None], 4, axis=1), place))
    around: dict[int, list[tuple[int, int]]] = {}
    for f, quad in enumerate(quads):
        for a, node in enumerate(quad):
            around.setdefault(int(node), []).append((f, a))
    averaged = np.empty_like(here)
    for entries in around.values():
        for f, a in entries:
            friends = [e for e in entries if before[e] @ before[f, a] > FEATURE_COSINE]
            averaged[f, a] = unit(np.sum([here[e] for e in friends], axis=0))
    return averaged


def rim_edges(quads: Ints) -> NDArray[np.bool_]:
    """(n_facets, 4) whether edge k (corner k to k + 1) belongs to one facet only."""
    ends = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
    _, inverse, counts = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    return (counts[inverse.ravel()] == 1).reshape(-1, 4)


def project(points: Floats, quads: Ints, reference: Floats, current: Floats) -> Projection:
    """Closest points of the master (quads of node indices) to points (n, 3)."""
    corners = current[quads]
    count = min(CANDIDATES, len(quads))
    _, near = cKDTree(corners.mean(axis=1)).query(points, k=count)
    near = near.reshape(len(points), count)
    pairs = corners[near].reshape(-1, 4, 3)
    targets = np.repeat(points, count, axis=0)
    xi, edge = closest_on_facets(targets, pairs)
    distance = np.linalg.norm(targets - facet_point(pairs, xi), axis=1).reshape(near.shape)
    best = np.argmin(distance, axis=1)
    rows = np.arange(len(points))
    facet, xi = near[rows, best], xi.reshape(*near.shape, 2)[rows, best]
    edge = edge.reshape(near.shape)[rows, best]
    on_rim = (edge >= 0) & rim_edges(quads)[facet, np.maximum(edge, 0)]
    beyond = _newton(points, corners[facet])
    is_extended = on_rim & (np.abs(beyond) <= 1 + 2 * EXTENSION).all(axis=1)
    xi = np.where(is_extended[:, None], beyond, xi)
    point = facet_point(corners[facet], xi)
    normal = unit(np.einsum("na,nai->ni", shapes(xi), corner_normals(reference, current, quads)[facet]))
    offset = points - point
    along = np.einsum("ni,ni->n", offset, normal)
    lateral = np.linalg.norm(offset - along[:, None] * normal, axis=1)
    size = np.sqrt(np.linalg.norm(facet_normal(corners[facet], np.zeros_like(xi)), axis=1)) * 2
    gap = np.sign(along) * np.linalg.norm(offset, axis=1)
    return Projection(facet, xi, point, normal, gap, on_rim & ~is_extended & (lateral > 1e-6 * size))


def closest_on_facets(points: Floats, corners: Floats) -> tuple[Floats, Ints]:
    """(n, 2) natural coordinates of the closest point of each facet to its point, and (n) the edge it is on or -1.

    Newton inside the facet; the four straight edges in closed form.
    """
    inside = _newton(points, corners)
    is_inside = (np.abs(inside) <= 1.0).all(axis=1)
    choices = [np.where(is_inside[:, None], inside, 0.0)]
    squares = [np.where(is_inside, _square(points, corners, inside), np.inf)]
    for k in range(4):
        start, end = corners[:, k], corners[:, (k + 1) % 4]
        along = end - start
        fraction = np.einsum("ni,ni->n", points - start, along) / np.einsum("ni,ni->n", along, along)
        fraction = np.clip(fraction, 0.0, 1.0)[:, None]
        choices.append(SIGNS[k] * (1 - fraction) + SIGNS[(k + 1) % 4] * fraction)
        squares.append(_square(points, corners, choices[-1]))
    best = np.argmin(np.stack(squares), axis=0)
    return np.stack(choices)[best, np.arange(len(points))], best - 1


def _square(points: Floats, corners: Floats, xi: Floats) -> Floats:
    offset = points - facet_point(corners, xi)
    return np.einsum("ni,ni->n", offset, offset)


def _newton(points: Floats, corners: Floats) -> Floats:
    """Stationary point of the distance, Gauss-Newton first, then Newton; coordinates kept within [-3, 3]."""
    xi = np.zeros((len(points), 2))
    twist = 0.25 * np.einsum("a,nai->ni", SIGNS[:, 0] * SIGNS[:, 1], corners)
    for iteration in range(30):
        tangents = np.einsum("nad,nai->ndi", shape_slopes(xi), corners)
        offset = points - facet_point(corners, xi)
        slope = np.einsum("ndi,ni->nd", tangents, offset)
        matrix = np.einsum("ndi,nei->nde", tangents, tangents)
        if iteration > 3:
            bend = np.einsum("ni,ni->n", twist, offset)
            matrix[:, 0, 1] -= bend
            matrix[:, 1, 0] -= bend
        step = np.linalg.solve(matrix, slope[..., None])[..., 0]
        xi = np.clip(xi + step, -3.0, 3.0)
        if np.abs(step).max(initial=0.0) < 1e-14:
            break
    return xi


def tributary_areas(nodes: Ints, quads: Ints, current: Floats) -> Floats:
    """(n) area of each slave node: the integral of its shape function over the facets around it [length^2]."""
    total = np.zeros(len(current))
    gauss = np.array([[a, b] for a in (-1, 1) for b in (-1, 1)]) / np.sqrt(3.0)
    corners = current[quads]
    for xi in gauss:
        place = np.broadcast_to(xi, (len(quads), 2))
        area = np.linalg.norm(facet_normal(corners, place), axis=1)
        np.add.at(total, quads.ravel(), (area[:, None] * shapes(place)).ravel())
    return total[nodes]
