"""Stands in for preCICE where it cannot be had: the calls of its Python bindings (version 3) that the adapter makes.

Two participants in two threads, coupled at the same points, in parallel: both solve a window, exchange, and repeat it with
relaxed data until what they write stands; then the window is done. No mapping, no acceleration but constant relaxation.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Meeting:
    """What two participants share. A configuration file is the name of a meeting."""

    windows: int
    length: float
    tolerance: float = 1e-11
    relaxation: float = 1.0  #: of what is exchanged
    most: int = 200
    data: dict[str, np.ndarray] = field(default_factory=dict)  #: as read
    written: dict[str, np.ndarray] = field(default_factory=dict)
    iterations: list[int] = field(default_factory=list)
    iteration: int = 0
    window: int = 0
    is_repeated: bool = False
    barrier: threading.Barrier = field(init=False)

    def __post_init__(self) -> None:
        """Both meet here."""
        self.barrier = threading.Barrier(2, action=self.judge, timeout=120)

    def judge(self) -> None:
        """By one of the two, while the other waits: have the data settled?"""
        change, scale = 0.0, 0.0
        for name, values in self.written.items():
            old = self.data.get(name, np.zeros_like(values))
            change = max(change, np.abs(values - old).max() / max(np.abs(values).max(), 1e-30))
            scale = max(scale, np.abs(values).max())
            self.data[name] = old + self.relaxation * (values - old)
        self.iteration += 1
        self.is_repeated = change > self.tolerance and scale > 0 and self.iteration < self.most
        if not self.is_repeated:
            self.iterations.append(self.iteration)
            self.iteration = 0
            self.window += 1


MEETINGS: dict[str, Meeting] = {}


class Participant:
    """A participant of a meeting."""

    def __init__(self, name: str, configuration: str, rank: int, size: int) -> None:
        """Takes part in the meeting that the configuration names."""
        assert (rank, size) == (0, 1), name
        self.meeting = MEETINGS[configuration]
        self.sizes: dict[str, int] = {}
        self.must_write = True

    def get_mesh_dimensions(self, mesh: str) -> int:
        """Space."""
        assert mesh
        return 3

    def set_mesh_vertices(self, mesh: str, positions: np.ndarray) -> np.ndarray:
        """Numbers of the points."""
        self.sizes[mesh] = len(positions)
        return np.arange(len(positions))

    def requires_initial_data(self) -> bool:
        """All begin with zero."""
        return False

    def initialize(self) -> None:
        """Nothing to exchange yet."""

    def is_coupling_ongoing(self) -> bool:
        """Windows are left."""
        return self.meeting.window < self.meeting.windows

    def is_time_window_complete(self) -> bool:
        """The last advance ended a window."""
        return not self.meeting.is_repeated

    def get_max_time_step_size(self) -> float:
        """The window at once."""
        return self.meeting.length

    def requires_writing_checkpoint(self) -> bool:
        """At the start of each window, once."""
        asked, self.must_write = self.must_write, False
        return asked

    def requires_reading_checkpoint(self) -> bool:
        """The window is repeated."""
        return self.meeting.is_repeated

    def read_data(self, mesh: str, name: str, ids: np.ndarray, time: float) -> np.ndarray:
        """What the other has written, relaxed."""
        assert time >= 0
        shape = (self.sizes[mesh], 3) if not name.startswith(("Pressure", "Temperature")) else (self.sizes[mesh],)
        return self.meeting.data.get(name, np.zeros(shape))[ids]

    def write_data(self, mesh: str, name: str, ids: np.ndarray, values: np.ndarray) -> None:
        """What this one has found."""
        assert len(values) == self.sizes[mesh] == len(ids)
        self.meeting.written[name] = np.array(values, float)

    def advance(self, dt: float) -> None:
        """Meets the other."""
        assert abs(dt - self.meeting.length) < 1e-9
        self.meeting.barrier.wait()
        self.must_write = not self.meeting.is_repeated

    def finalize(self) -> None:
        """Done."""
