"""Stands in for preCICE where it is not installed: the calls of its Python bindings (version 3) that the adapter makes.

Two participants in two threads, coupled at the same points, in parallel: both solve a window, exchange, and repeat it with
relaxed data until the written data converge; then the window is done. No mapping, no acceleration but constant relaxation. A
participant may solve a window in pieces; what it reads for a time within the window lies on the straight line from the window's
start, as with preCICE's waveforms of first degree. What preCICE refuses is refused: an advance before the checkpoint was requested
for, or past the end of the window, initial data that are missing, anything after the end.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Exchange:
    """What two participants share. The name of a configuration file identifies the coupling."""

    windows: int
    length: float
    tolerance: float = 1e-11
    relaxation: float = 1.0  #: of what is exchanged
    most: int = 200
    is_implicit: bool = True  #: windows are repeated; else each is solved once
    needs_initial: bool = False  #: data must be written before initialize
    data: dict[str, np.ndarray] = field(default_factory=dict)  #: as read at the end of the window
    start: dict[str, np.ndarray] = field(default_factory=dict)  #: at its start
    written: dict[str, np.ndarray] = field(default_factory=dict)
    iterations: list[int] = field(default_factory=list)
    iteration: int = 0
    window: int = 0
    is_repeated: bool = False
    barrier: threading.Barrier = field(init=False)

    def __post_init__(self) -> None:
        """Barrier for both participants."""
        self.barrier = threading.Barrier(2, action=self.judge, timeout=120)

    def judge(self) -> None:
        """Convergence of the data; called by one of the two, while the other waits."""
        change, scale = 0.0, 0.0
        for name, values in self.written.items():
            old = self.data.get(name, np.zeros_like(values))
            change = max(change, np.abs(values - old).max() / max(np.abs(values).max(), 1e-30))
            scale = max(scale, np.abs(values).max())
            self.data[name] = old + self.relaxation * (values - old)
        self.iteration += 1
        self.is_repeated = self.is_implicit and change > self.tolerance and scale > 0 and self.iteration < self.most
        if not self.is_repeated:
            self.iterations.append(self.iteration)
            self.iteration = 0
            self.window += 1
            self.start = dict(self.data)


EXCHANGES: dict[str, Exchange] = {}


class Participant:
    """A participant of a coupling."""

    def __init__(self, name: str, configuration: str, rank: int, size: int) -> None:
        """Joins the coupling that the configuration names."""
        assert (rank, size) == (0, 1), name
        self.exchange = EXCHANGES[configuration]
        self.sizes: dict[str, int] = {}
        self.done = 0.0  #: of the window
        self.is_complete = False
        self.must_write = self.exchange.is_implicit
        self.must_read = False
        self.state = "new"
        self.has_written = False
        self.pieces: list[float] = []

    def get_mesh_dimensions(self, mesh: str) -> int:
        """Space."""
        assert mesh
        return 3

    def set_mesh_vertices(self, mesh: str, positions: np.ndarray) -> np.ndarray:
        """Numbers of the points."""
        assert self.state == "new"
        assert positions.shape[1] == self.get_mesh_dimensions(mesh)
        self.sizes[mesh] = len(positions)
        return np.arange(len(positions))

    def requires_initial_data(self) -> bool:
        """All begin with zero, unless the configuration requests initial data."""
        assert self.state == "new"
        return self.exchange.needs_initial

    def initialize(self) -> None:
        """What was written is there from the start."""
        assert self.state == "new"
        assert self.has_written or not self.exchange.needs_initial
        self.state = "going"

    def is_coupling_ongoing(self) -> bool:
        """Windows are left."""
        assert self.state == "going"
        return self.exchange.window < self.exchange.windows

    def is_time_window_complete(self) -> bool:
        """The last advance ended a window."""
        return self.is_complete

    def get_max_time_step_size(self) -> float:
        """What is left of the window."""
        return self.exchange.length - self.done

    def requires_writing_checkpoint(self) -> bool:
        """At the start of each window, once."""
        request, self.must_write = self.must_write, False
        return request

    def requires_reading_checkpoint(self) -> bool:
        """The window is repeated."""
        request, self.must_read = self.must_read, False
        return request

    def read_data(self, mesh: str, name: str, ids: np.ndarray, time: float) -> np.ndarray:
        """What the other has written, relaxed."""
        assert -1e-12 <= time <= self.get_max_time_step_size() + 1e-12
        shape = (self.sizes[mesh], 3) if not name.startswith(("Pressure", "Temperature")) else (self.sizes[mesh],)
        start, end = (data.get(name, np.zeros(shape))[ids] for data in (self.exchange.start, self.exchange.data))
        return start + (self.done + time) / self.exchange.length * (end - start)

    def write_data(self, mesh: str, name: str, ids: np.ndarray, values: np.ndarray) -> None:
        """What this one has found."""
        assert self.state != "done"
        assert len(values) == self.sizes[mesh] == len(ids)
        self.has_written = True
        self.exchange.written[name] = np.array(values, float)
        if self.state == "new":
            self.exchange.data[name] = self.exchange.start[name] = self.exchange.written[name]

    def advance(self, dt: float) -> None:
        """Meets the other at the end of the window."""
        assert self.state == "going"
        assert not (self.must_write or self.must_read), "a checkpoint was due"
        assert 0 < dt <= self.get_max_time_step_size() + 1e-14
        self.pieces.append(dt)
        self.done += dt
        self.is_complete = False
        if self.exchange.length - self.done > 1e-14:
            return
        self.done = 0.0
        self.exchange.barrier.wait()
        self.is_complete = not self.exchange.is_repeated
        self.must_write = self.is_complete and self.exchange.is_implicit and self.is_coupling_ongoing()
        self.must_read = self.exchange.is_repeated

    def finalize(self) -> None:
        """Done."""
        assert self.state == "going"
        self.state = "done"
