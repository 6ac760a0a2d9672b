"""The slave surface of a contact pair laid flat: seen along its mean normal, or unrolled if it runs round a cylinder.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from amontons.report.data import Floats, Ints, Job

CURVED = 0.9  #: a surface whose mean normal is shorter than this is unrolled [-]
ROUND = 0.02  #: largest deviation of a cylinder's nodes from it [radius]


@dataclass
class Pair:
    """A contact pair at the increments on file."""

    name: str
    friction: float
    nodes: Ints  #: slave nodes
    normal: Floats  #: (frames) sum of the sizes of the normal forces of its slave nodes
    shear: Floats  #: (frames) the same of the tangential forces
    status: Ints  #: (frames, slave nodes) 0 open, 1 stick, 2 slip
    scenario: Ints  #: (frames, slave nodes)
    counts: Ints  #: (frames, 3) slave nodes or points that are open, stick, slip

    @property
    def has_coulomb(self) -> bool:
        """Whether mu N limits the friction: 0 < mu < 1e3; rough surfaces and laws of users have other numbers."""
        return bool(0.0 < self.friction < 1e3)


@dataclass
class Map:
    """Faces in the plane. Nodes on the seam of an unrolled surface stand at both ends."""

    corners: list[Ints]  #: nodes of each face
    places: list[Floats]  #: (corners, 2) where they are
    nodal: dict[int, list[Floats]]  #: node to its places
    directions: dict[int, Floats]  #: node to the (2, 3) directions of the map there
    labels: tuple[str, str]
    remark: str = ""


def cylinder_of(x: Floats, areas: Floats) -> tuple[Floats, Floats, float] | None:
    """Axis, a point on it and the radius of the cylinder on which nodes lie; None for other faces. areas: those of the faces, as vectors."""
    size = np.linalg.norm(areas, axis=1)
    unit = areas / np.maximum(size, 1e-300)[:, None]
    values, vectors = np.linalg.eigh((unit * size[:, None]).T @ unit)
    if values[0] > 0.02 * values.sum():
        return None
    axis = vectors[:, 0] * (1 if vectors[np.argmax(np.abs(vectors[:, 0])), 0] > 0 else -1)
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.linalg.norm(first)
    flat = np.stack([x @ first, x @ np.cross(axis, first)], axis=1)
    # (p - c)^2 = r^2: linear in c and r^2 - c^2
    solution, *_ = np.linalg.lstsq(np.column_stack([2 * flat, np.ones(len(flat))]), (flat**2).sum(axis=1), rcond=None)
    centre, radius = solution[:2], float(np.sqrt(max(solution[2] + solution[:2] @ solution[:2], 0.0)))
    if np.abs(np.linalg.norm(flat - centre, axis=1) - radius).max() > ROUND * radius:
        return None
    return axis, centre[0] * first + centre[1] * np.cross(axis, first), radius


def slave_faces(job: Job, nodes: Ints) -> list[Ints]:
    """Corners of the outer faces whose corners are all slave nodes."""
    is_slave = np.zeros(len(job.points), dtype=bool)
    is_slave[nodes] = True
    return [c for c in job.skin.corners if is_slave[c].all()] if not job.is_plane else []


def area_vectors(x: Floats, faces: list[Ints]) -> Floats:
    """(faces, 3) outward, twice the area long."""
    return np.array([np.cross(x[f[2 % len(f)]] - x[f[0]], x[f[-1]] - x[f[1]]) for f in faces])


def map_of(job: Job, pair: Pair, weight: Floats) -> Map | None:
    """The slave surface in the plane. weight: pressure by node; the seam of an unrolled surface lies opposite to it."""
    faces = slave_faces(job, pair.nodes)
    if not faces:
        return None
    x, areas = job.points, area_vectors(job.points, faces)
    bent = np.linalg.norm(areas.sum(axis=0)) < CURVED * np.linalg.norm(areas, axis=1).sum()
    found = cylinder_of(x[pair.nodes], areas) if bent else None
    if found:
        return _unrolled(x, faces, weight, *found)
    remark = ""
    if bent and weight.max() > 0:
        direction = sum((weight[f].mean() * a for f, a in zip(faces, areas, strict=True)), np.zeros(3))
        keep = areas @ direction > 0.2 * np.linalg.norm(areas, axis=1) * np.linalg.norm(direction)
        if keep.any() and not keep.all():
            faces, areas, remark = [f for f, k in zip(faces, keep, strict=True) if k], areas[keep], "loaded side"
    dropped = int(np.argmax(np.abs(areas.sum(axis=0))))
    kept = [d for d in range(3) if d != dropped]
    axes = np.eye(3)[kept]
    return _made(faces, [x[f] @ axes.T for f in faces], dict.fromkeys((int(n) for f in faces for n in f), axes), ("xyz"[kept[0]], "xyz"[kept[1]]), remark)


def _unrolled(x: Floats, faces: list[Ints], weight: Floats, axis: Floats, centre: Floats, radius: float) -> Map:
    """Length along the circumference to the right, along the axis up."""
    from_axis = x - centre - ((x - centre) @ axis)[:, None] * axis
    nodes = np.unique(np.concatenate(faces))
    loaded = (weight[nodes, None] * from_axis[nodes]).sum(axis=0)
    ahead = loaded if np.linalg.norm(loaded) > 1e-9 * radius * max(weight[nodes].sum(), 1e-300) else from_axis[nodes[0]]
    ahead = ahead / np.linalg.norm(ahead)
    aside = np.cross(axis, ahead)
    angle = np.arctan2(from_axis @ aside, from_axis @ ahead)
    places = []
    for face in faces:
        mean = np.arctan2(np.sin(angle[face]).mean(), np.cos(angle[face]).mean())
        turned = mean + np.angle(np.exp(1j * (angle[face] - mean)))
        places.append(np.stack([radius * turned, x[face] @ axis], axis=1))
    directions = {}
    for n in nodes:
        around = np.cross(axis, from_axis[n] / max(np.linalg.norm(from_axis[n]), 1e-300))
        directions[int(n)] = np.stack([around, axis])
    along = next((name for name, unit in zip("xyz", np.eye(3), strict=True) if abs(axis @ unit) > 0.999), "along the axis")
    return _made(faces, places, directions, ("around", along), "unrolled")


def _made(faces: list[Ints], places: list[Floats], directions: dict[int, Floats], labels: tuple[str, str], remark: str) -> Map:
    """With the places of each node."""
    nodal: dict[int, list[Floats]] = {}
    size = max(float(np.ptp(np.concatenate(places), axis=0).max()), 1e-300)
    for face, corners in zip(faces, places, strict=True):
        for node, place in zip(face, corners, strict=True):
            known = nodal.setdefault(int(node), [])
            if all(np.abs(place - other).max() > 1e-6 * size for other in known):
                known.append(place)
    return Map(faces, places, nodal, directions, labels, remark)


def parts_of(chart: Map) -> tuple[list[Floats], Ints]:
    """Each corner's part of its face: the quadrilateral to the middles of its sides and of the face; and the node of each."""
    cells, nodes = [], []
    for face, corners in zip(chart.corners, chart.places, strict=True):
        centre = corners.mean(axis=0)
        for a, node in enumerate(face):
            after, before = (corners[a] + corners[(a + 1) % len(face)]) / 2, (corners[a] + corners[a - 1]) / 2
            cells.append(np.stack([corners[a], after, centre, before]))
            nodes.append(int(node))
    return cells, np.array(nodes, dtype=np.int64)


def along_of(job: Job, pair: Pair, weight: Floats) -> tuple[Floats, str]:
    """Slave nodes of a plane body: the angle about the centre of a circle [degrees], or the coordinate in which they reach farthest."""
    x = job.points[pair.nodes]
    flat = x[:, :2]
    if len(flat) > 4:
        solution, *_ = np.linalg.lstsq(np.column_stack([2 * flat, np.ones(len(flat))]), (flat**2).sum(axis=1), rcond=None)
        centre, radius = solution[:2], float(np.sqrt(max(solution[2] + solution[:2] @ solution[:2], 0.0)))
        off = np.abs(np.linalg.norm(flat - centre, axis=1) - radius).max()
        turned = np.angle(np.exp(1j * _angles(flat - centre)) * np.conj(np.exp(1j * _angles(flat - centre)[0])))
        if off < 1e-3 * radius and np.ptp(turned) > 2.0:
            pull = (weight[pair.nodes, None] * (flat - centre)).sum(axis=0)
            ahead = float(np.arctan2(pull[1], pull[0]))
            return np.degrees(np.angle(np.exp(1j * (_angles(flat - centre) - ahead)))), "angle from the load [degrees]"
    d = int(np.argmax(np.ptp(x, axis=0)))
    return x[:, d], "xyz"[d]


def _angles(flat: Floats) -> NDArray[np.float64]:
    """About the origin."""
    return np.arctan2(flat[:, 1], flat[:, 0])
