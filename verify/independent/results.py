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


def read_results(path: Path) -> Results:
    """The temporal VTKHDF layout with one static mesh."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        reactions = point_data(grid, "RF") if "RF" in grid["PointData"] else None
        text = _deck_text(file)
        return Results(grid["Points"][:], grid["Steps/Values"][:], point_data(grid, "U"), reactions, text)


def point_data(grid: h5py.Group, name: str) -> Floats:
    """(n_frames, n_nodes, ...) values of one point array."""
    n = int(grid["NumberOfPoints"][0])
    values = grid["PointData"][name]
    offsets = grid["Steps/PointDataOffsets"][name][:]
    return np.stack([values[int(o) : int(o) + n] for o in offsets])


def _deck_text(file: h5py.File) -> str | None:
    """/AMONTONS/deck: the lines of the deck, includes in place."""
    if "AMONTONS/deck" not in file:
        return None
    value = file["AMONTONS/deck"][()]
    if isinstance(value, np.ndarray):
        value = b"\n".join(bytes(v).rstrip() for v in value.ravel())
    return value.decode()
