"""preCICE: a job as a participant of a coupled simulation, in the style of the CalculiX adapter.

    python -m amontons.precice -i flap -precice-participant Solid     (flap.inp and config.yml, as the CalculiX adapter is called)
    python -m amontons.precice deck.inp config.json Solid             (JSON does without PyYAML)

The configuration file is that of the CalculiX adapter:

    participants:
      Solid:
        interfaces:
        - nodes-mesh: Solid-Nodes
          patch: WET
          read-data: [Force]
          write-data: [Displacement]
        - faces-mesh: Solid-Faces
          patch: WET
          read-data: [Pressure]
    precice-config-file: precice-config.xml

A patch is a node set or a surface of the deck; without one of that name, NWET and SWET are taken, as CalculiX's
pre-processors name them. A nodes-mesh has its nodes, a faces-mesh (or mesh) the middles of a surface's faces.
The prefix of a name selects the data:

| data | mesh | read: set in the job | written: taken from the job |
|---|---|---|---|
| Force | nodes | forces on the nodes | what the body presses on its supports with (minus the reactions) |
| DisplacementDelta | nodes | | displacement since the start of the time window |
| Displacement | nodes | prescribed displacement (the deck must prescribe it) | displacement |
| Position | nodes | | where the nodes are now |
| Pressure | faces | pressure into the body | |
| Temperature | nodes | temperature | temperature |

Implicit coupling needs no more than the job can do anyway: a window is tried, and rolled back, bitwise, or committed. Where a
step of the deck ends within a window, the window is solved in two pieces, and preCICE gets both.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from amontons.job import AmontonsError, Job, UsageError

Floats = NDArray[np.float64]

#: What can be read and written, by the beginning of the name, the longer first; on which mesh.
READABLE = {"Force": "nodes", "Displacement": "nodes", "Pressure": "faces", "Temperature": "nodes"}
WRITABLE = {"DisplacementDelta": "nodes", "Displacement": "nodes", "Position": "nodes", "Force": "nodes", "Temperature": "nodes"}
SAME = 1e-9  #: of two lengths of time, relative


def read_configuration(path: str | PathLike[str]) -> dict[str, Any]:
    """A configuration file: JSON, or YAML where PyYAML is installed."""
    text = Path(path).read_text()
    if Path(path).suffix not in (".yml", ".yaml"):
        return dict(json.loads(text))
    try:
        yaml = importlib.import_module("yaml")
    except ModuleNotFoundError as error:
        raise UsageError(f"{path} is YAML, and PyYAML is not installed; install it, or write the file as JSON.") from error
    return dict(yaml.safe_load(text))


def kind_of(name: str, kinds: Mapping[str, str], mesh: str, doing: str) -> str:
    """Which data a name means.

    Raises:
        UsageError: none that can be read (written) on this mesh.
    """
    for kind, place in kinds.items():
        if name.startswith(kind):
            if place != mesh:
                raise UsageError(f"{name} is {doing} on a {place}-mesh, not on a {mesh}-mesh.")
            return kind
    raise UsageError(f"{name} cannot be {doing}; its name must begin with one of {', '.join(kinds)}.")


def patch_of(job: Job, name: str, is_faces: bool) -> str:
    """The set or surface of a patch: of that name, or with CalculiX's N or S before it."""
    kinds = ("SURFACES",) if is_faces else ("NODE SETS", "SURFACES")
    known = {one.upper() for kind in kinds for one in job.names(kind)}
    other = ("S" if is_faces else "N") + name
    return other if name.upper() not in known and other.upper() in known else name


@dataclass
class Interface:
    """One mesh of the participant: a patch of the job, and what goes over it."""

    mesh: str
    patch: str
    is_faces: bool
    reads: dict[str, str]  #: name of the data: kind
    writes: dict[str, str]
    places: Floats  #: (rows, 3)
    ids: Any = field(default=None)

    @classmethod
    def of(cls, words: Mapping[str, Any], job: Job) -> Interface:
        """From an entry of `interfaces`."""
        if "nodes-mesh-with-connectivity" in words:
            raise UsageError("Connectivity is not given: use nodes-mesh, and a mapping that does without (nearest-neighbor, rbf).")
        is_faces = "nodes-mesh" not in words
        mesh = words.get("nodes-mesh", words.get("faces-mesh", words.get("mesh")))
        if mesh is None or "patch" not in words:
            raise UsageError("An interface needs a nodes-mesh or a faces-mesh, and a patch.")
        place = "faces" if is_faces else "nodes"
        patch = patch_of(job, str(words["patch"]), is_faces)
        return cls(
            mesh, patch, is_faces,
            {name: kind_of(name, READABLE, place, "read") for name in words.get("read-data", [])},
            {name: kind_of(name, WRITABLE, place, "written") for name in words.get("write-data", [])},
            job.get("FACE CENTRES" if is_faces else "X", patch),
        )  # fmt: skip


class Adapter:
    """A job coupled by preCICE (version 3)."""

    def __init__(self, job: Job, configuration: Mapping[str, Any], name: str, *, precice: Any = None) -> None:
        """Registers the meshes of a participant.

        Args:
            job: at its start.
            configuration: as `read_configuration` gives it.
            name: of the participant.
            precice: the Python bindings of preCICE, or what has the same calls; default: the package `precice`.

        Raises:
            UsageError: the configuration does not fit the job.
            ModuleNotFoundError: preCICE is not installed.
        """
        participants = configuration.get("participants", {})
        if name not in participants:
            raise UsageError(f"There is no participant {name}; there are {', '.join(participants) or 'none'}.")
        self.job = job
        self.interfaces = [Interface.of(words, job) for words in participants[name]["interfaces"]]
        bindings = precice if precice is not None else importlib.import_module("precice")
        self.participant = bindings.Participant(name, str(configuration["precice-config-file"]), 0, 1)
        for interface in self.interfaces:
            dimensions = self.participant.get_mesh_dimensions(interface.mesh)
            interface.ids = self.participant.set_mesh_vertices(interface.mesh, interface.places[:, :dimensions])
        self._start: dict[str, Floats] = {}

    def run(self) -> None:
        """The coupled simulation from beginning to end."""
        if self.participant.requires_initial_data():
            self._note_start()
            self._write()
        self.participant.initialize()
        is_new = True
        while self.participant.is_coupling_ongoing():
            if self.participant.requires_writing_checkpoint() or is_new:
                self._note_start()  # the job itself keeps its last commit: nothing to save
            self.participant.advance(self._solve(self.participant.get_max_time_step_size()))
            is_new = False
            if self.participant.requires_reading_checkpoint():
                self.job.rollback()
            elif self.participant.is_time_window_complete():
                self.job.commit()
                is_new = True
        self.participant.finalize()

    def _solve(self, longest: float) -> float:
        """Solves what is left of the window, or as far as the deck's step goes; returns how far that was.

        Raises:
            UsageError: the steps of the deck are at their end, and the coupling is not.
        """
        left = self.job.number("TIME LEFT")
        if left == 0.0:
            raise UsageError(f"The steps of the deck end at time {self.job.time:g}; the coupling continues. Make the deck's steps longer.")
        dt = longest if left > longest * (1 - SAME) else left
        self._read(dt)
        self.job.try_step(dt)
        self._write()
        return dt

    def _note_start(self) -> None:
        """The displacements at the start of the time window."""
        self._start = {face.patch: self.job.get("U", face.patch) for face in self.interfaces if not face.is_faces}

    def _read(self, dt: float) -> None:
        """Copies the data of the other participants into the job."""
        quantities = {"Force": "CF", "Displacement": "U", "Pressure": "P", "Temperature": "NT"}
        for interface in self.interfaces:
            for name, kind in interface.reads.items():
                values = np.asarray(self.participant.read_data(interface.mesh, name, interface.ids, dt), float)
                if values.ndim == 2 and values.shape[1] == 2:   # a plane mesh says nothing of the third direction
                    for k in (0, 1):
                        self.job.set(f"{quantities[kind]}{k + 1}", interface.patch, values[:, k])
                else:
                    self.job.set(quantities[kind], interface.patch, values.ravel())

    def _write(self) -> None:
        """Sends the results of the job to the other participants."""
        for interface in self.interfaces:
            dimensions = self.participant.get_mesh_dimensions(interface.mesh)
            for name, kind in interface.writes.items():
                self.participant.write_data(interface.mesh, name, interface.ids, self._values(interface.patch, kind, dimensions))

    def _values(self, patch: str, kind: str, dimensions: int) -> Floats:
        """Data of a kind at the nodes of a patch."""
        if kind == "Temperature":
            return self.job.get("NT", patch)
        if kind == "Force":
            return -self.job.get("RF", patch)[:, :dimensions]
        u = self.job.get("U", patch)
        if kind == "Position":
            u = u + self.job.get("X", patch)
        if kind == "DisplacementDelta":
            u = u - self._start[patch]
        return u[:, :dimensions]


def main(words: list[str] | None = None) -> int:
    """Deck, configuration, name of the participant; or as the CalculiX adapter is called."""
    words = sys.argv[1:] if words is None else words
    if len(words) == 4 and words[0] == "-i" and words[2] == "-precice-participant":
        deck = words[1] if words[1].endswith(".inp") else f"{words[1]}.inp"
        words = [deck, "config.yml", words[3]]
    if len(words) != 3:
        print(__doc__)
        return 2
    deck, configuration, name = words
    try:
        with Job(deck, files=True, checkpoint=False, log=print) as job:
            Adapter(job, read_configuration(configuration), name).run()
    except AmontonsError as error:
        print(f"*ERROR: {error}")
        return error.status
    except ModuleNotFoundError as error:
        print(f"*ERROR: {error}; the adapter needs preCICE's Python bindings: pip install pyprecice.")
        return UsageError.status
    except RuntimeError as error:   # what preCICE's bindings raise
        print(f"*ERROR: preCICE: {error}")
        return UsageError.status
    return 0


if __name__ == "__main__":
    sys.exit(main())
