"""Reads a result file as far as the checks need it: points, displacements, times, the deck text.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass
class Results:
    """Displacements of all increments on file, increment 0 included."""

    points: Floats  #: (n_nodes, 3) reference coordinates [length]
    times: Floats  #: (n_frames) total time
    displacements: Floats  #: (n_frames, n_nodes, 3) [length]
    reactions: Floats | None  #: (n_frames, n_nodes, 3) RF, where the file has it [force]
    deck_text: str | None
    labels: NDArray[np.int64] | None = None  #: (n_nodes) the user's node numbers
    dialect: str = "abaqus"
    element_labels: NDArray[np.int64] | None = None  #: (n_elements) the user's element numbers
    stresses: Floats | None = None  #: (n_frames, n_points, 6) Cauchy stress xx yy zz xy yz xz at the integration points


def read_results(path: Path) -> Results:
    """The temporal VTKHDF layout with one static mesh."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        reactions = point_data(grid, "RF") if "RF" in grid["PointData"] else None
        times = grid["Steps/Values"][:]
        stresses = _values(file, "AMONTONS/integration_points/S")
        return Results(
            points=grid["Points"][:],
            times=times,
            displacements=point_data(grid, "U"),
            reactions=reactions,
            deck_text=_text(file, "AMONTONS/deck"),
            labels=_values(file, "AMONTONS/mesh/node_label"),
            dialect=(_text(file, "AMONTONS/dialect") or "abaqus").strip(),
            element_labels=_values(file, "AMONTONS/mesh/element_label"),
            stresses=None if stresses is None else stresses.reshape(len(times), -1, 6),
        )


def read_field(path: Path, name: str) -> Floats:
    """(n_frames, n_nodes, ...) one point array of a file."""
    with h5py.File(path) as file:
        return point_data(file["VTKHDF"], name)


def read_history(path: Path) -> dict[str, NDArray]:
    """/AMONTONS/history: one row per attempt at an increment, columns by name."""
    with h5py.File(path) as file:
        return {name: values[:] for name, values in file["AMONTONS/history"].items()}


def point_data(grid: h5py.Group, name: str) -> Floats:
    """(n_frames, n_nodes, ...) values of one point array."""
    n = int(grid["NumberOfPoints"][0])
    values = grid["PointData"][name]
    offsets = grid["Steps/PointDataOffsets"][name][:]
    return np.stack([values[int(o) : int(o) + n] for o in offsets])


def _values(file: h5py.File, name: str) -> NDArray | None:
    """A data set; None if the file does not have it."""
    return file[name][:] if name in file else None


def _text(file: h5py.File, name: str) -> str | None:
    """A text in one piece or in lines; None if the file does not have it."""
    if name not in file:
        return None
    value = file[name][()]
    if isinstance(value, np.ndarray):
        value = b"\n".join(bytes(v).rstrip() for v in value.ravel())
    return value.decode()
