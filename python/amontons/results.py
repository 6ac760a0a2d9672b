"""A result file in your hands: tables as pandas, the bodies at a time as pyvista, fields as numpy arrays.

    import amontons

    results = amontons.read("bracket.vtkhdf")
    results.pairs[["total_time", "pair", "CFNM", "CFSM", "CAREA"]]
    results.grid(elset="BRACKET").plot(scalars="S_mises")

Tables need pandas, grids pyvista; `pip install "amontons[results]"` installs both with h5py.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from functools import cached_property
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from amontons.job import FileError, UsageError

if TYPE_CHECKING:
    import h5py
    import pandas
    import pyvista

__all__ = ["Results", "read"]

STATUSES = ("open", "stick", "slip")
#: Sums over a pair of which the tables have the magnitude as well, named as in Abaqus: CFNM.
WITH_MAGNITUDE = ("CFN", "CFS", "CMN", "CMS")


def needed(module: str) -> Any:
    """A package that only the results need.

    Raises:
        ImportError: it is not installed; the message has the command.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(f'{module} is needed for this: pip install {module}, or pip install "amontons[results]".') from error


def chosen(kind: str, name: str, names: Sequence[str]) -> str:
    """The name as the file has it; upper and lower case are the same.

    Raises:
        UsageError: there is none; the message has the nearest, or all of a few.
    """
    for one in names:
        if one.upper() == name.strip().upper():
            return one
    near = difflib.get_close_matches(name.upper(), [one.upper() for one in names], n=1, cutoff=0.7)
    if near:
        end = f"; did you mean {next(one for one in names if one.upper() == near[0])}?"
    elif not names:
        end = "; the file has none."
    else:
        end = f"; there are {', '.join(names[:20])}{', ...' if len(names) > 20 else ''}."
    raise UsageError(f"There is no {kind} named {name}{end}")


def read(path: str | PathLike[str]) -> Results:
    """The results of a job, finished or running.

    Args:
        path: job.vtkhdf, or the job without its ending.

    Raises:
        FileError: there is no such file, or it is not one of Amontons.
    """
    return Results(path)


def joined_cells(grid: h5py.Group, labels: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.uint8]]:
    """Connectivity, offsets and types of all cells of /VTKHDF as one grid.

    A node that several partitions have stands in the file several times; all cells take the first, so that the partitions hang together.
    """
    connectivity, offsets, types = (grid[name][:].astype(np.int64) for name in ("Connectivity", "Offsets", "Types"))
    n_points, n_cells, n_ids = (grid[f"NumberOf{name}"][:] for name in ("Points", "Cells", "ConnectivityIds"))
    if len(n_points) == 1:
        return connectivity, offsets, types.astype(np.uint8)
    connectivity = connectivity + np.repeat(np.cumsum(n_points) - n_points, n_ids)
    pieces = np.split(offsets, np.cumsum(n_cells + 1)[:-1])
    offsets = np.concatenate([[0], *(piece[1:] + before for piece, before in zip(pieces, np.cumsum(n_ids) - n_ids, strict=True))])
    _, first, place = np.unique(labels, return_index=True, return_inverse=True)
    joined = np.arange(int(n_points.sum()))
    joined[: len(labels)] = first[place]
    return joined[connectivity], offsets.astype(np.int64), types.astype(np.uint8)


class Results:
    """A result file. What is read stays; a running job is read again by `read`.

    Attributes:
        path: of the file.
        name: of the job.
        version: of the program that wrote it.
        dialect: "abaqus" or "calculix".
        heading: of the deck.
        deck: the deck itself.
        times: total time of each frame.
        node_labels, element_labels: of the deck, in the order of the fields. In a file that ties partitions a node of several of them has
            a row for each.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        """Reads the model; fields are read at their first use."""
        path = Path(path)
        self.path = path if path.suffix == ".vtkhdf" else path.with_name(path.name + ".vtkhdf")
        self.name = self.path.stem
        with self._open() as file:
            if "AMONTONS" not in file or "VTKHDF" not in file:
                raise FileError(f"{self.path} is not a result file of Amontons.")
            ours, grid = file["AMONTONS"], file["VTKHDF"]
            self.version, self.dialect = _text(ours, "version"), _text(ours, "dialect")
            self.heading, self.deck = _text(ours, "heading"), _text(ours, "deck")
            n_frames = int(grid["Steps"].attrs["NSteps"])
            self.times: NDArray[np.float64] = grid["Steps/Values"][:n_frames]
            self.node_labels: NDArray[np.int64] = ours["mesh/node_label"][:].astype(np.int64)
            self.element_labels: NDArray[np.int64] = ours["mesh/element_label"][:].astype(np.int64)
            self._points: NDArray[np.float64] = grid["Points"][:]   # nodes, then points of analytic surfaces
            self._cells = joined_cells(grid, self.node_labels)
            self._cell_data = {name: item[:] for name, item in grid["CellData"].items() if not name.startswith("ELSET ")}
            self._node_sets, self._element_sets = _sets(ours["mesh/node_sets"]), _sets(ours["mesh/element_sets"])
            self._fields = {name: _unit(item) for name, item in grid["PointData"].items()}
            self._pairs = [f"{s} / {m}" for s, m in zip(_words(ours["pairs/slave"]), _words(ours["pairs/master"]), strict=True)]

    def _open(self) -> h5py.File:
        """The file, which the program may be writing at the same time."""
        try:
            return needed("h5py").File(self.path, "r", locking=False)
        except OSError as error:
            reason = "there is no such file" if not self.path.exists() else str(error)
            raise FileError(f"{self.path} cannot be read: {reason}.") from error

    def __repr__(self) -> str:
        """What is in it."""
        end = f"time {self.times[-1]:g}" if len(self.times) else "no time"
        return (f"<Results {self.path.name}: {len(self.times)} frames to {end}, {len(self.node_labels)} nodes, "
                f"{len(self.element_labels)} elements, {len(self._pairs)} contact pairs>")  # fmt: skip

    @property
    def points(self) -> NDArray[np.float64]:
        """Coordinates of the nodes in the deck, (nodes, 3)."""
        return self._points[: len(self.node_labels)]

    @property
    def fields(self) -> dict[str, str]:
        """Names and units of the fields at the nodes."""
        return dict(self._fields)

    @property
    def node_sets(self) -> list[str]:
        """Names of the node sets."""
        return list(self._node_sets)

    @property
    def element_sets(self) -> list[str]:
        """Names of the element sets."""
        return list(self._element_sets)

    @property
    def pair_names(self) -> list[str]:
        """The contact pairs, "slave / master", in the order of the deck."""
        return list(self._pairs)

    @cached_property
    def history(self) -> pandas.DataFrame:
        """One row per attempt at an increment: times, iterations, forces, energies; `reason` says why an attempt failed.

        Columns with several components have the numbers 1, 2, 3 behind their names; those of slave nodes are n_open, n_stick and
        n_slip. `history.attrs["units"]` has the units, `history.attrs["descriptions"]` what each column is.
        """
        return self._table("history")

    @cached_property
    def iterations(self) -> pandas.DataFrame:
        """One row per Newton iteration."""
        return self._table("iterations")

    @cached_property
    def pairs(self) -> pandas.DataFrame:
        """One row per contact pair and increment: forces of pressure CFN and friction CFS, moments CMN and CMS, area CAREA.

        Vectors have the columns CFN1, CFN2, CFN3 and their magnitude CFNM; `pair` is "slave / master". Forces act on the slave.
        """
        table = self._table("pair_history")
        if table.empty:
            return table
        table["pair"] = [self._pairs[i] for i in table["pair"]]
        table.attrs["descriptions"]["pair"] = "Slave / master."
        for name in WITH_MAGNITUDE:
            size = np.sqrt(sum(table[f"{name}{k}"].to_numpy() ** 2 for k in (1, 2, 3)))
            table.insert(table.columns.get_loc(f"{name}3") + 1, f"{name}M", size)
            table.attrs["units"][f"{name}M"] = table.attrs["units"][f"{name}1"]
            table.attrs["descriptions"][f"{name}M"] = "Magnitude of the vector: " + table.attrs["descriptions"][f"{name}1"]
        return table

    def field(self, name: str, time: float | None = None, nset: str | None = None) -> NDArray[Any]:
        """A field at the nodes, (nodes, components), or (nodes,) of single numbers.

        Args:
            name: of `fields`.
            time: that of a frame (the nearest is taken); default the last.
            nset: only the nodes of a set, in the order of the set; default all, in the order of `node_labels`.

        Raises:
            UsageError: there is no such field, set or time.
        """
        name, k = chosen("field", name, list(self._fields)), self.frame(time)
        n = len(self._points)
        with self._open() as file:
            values = file[f"VTKHDF/PointData/{name}"][k * n : (k + 1) * n]
        return values[: len(self.node_labels)] if nset is None else values[self._node_sets[chosen("node set", nset, self.node_sets)]]

    def nodes(self, nset: str) -> NDArray[np.int64]:
        """The labels of the nodes of a set, in the order of `field`."""
        return self.node_labels[self._node_sets[chosen("node set", nset, self.node_sets)]]

    def frame(self, time: float | None = None) -> int:
        """The number of the frame nearest to a time, from 0; None: the last.

        Raises:
            UsageError: the time lies before the first or after the last frame, or there is none.
        """
        if not len(self.times):
            raise UsageError(f"{self.path} has no frame yet.")
        if time is None:
            return len(self.times) - 1
        slack = 1.0e-9 * max(1.0e-300, abs(self.times[-1]))
        if not self.times[0] - slack <= time <= self.times[-1] + slack:
            raise UsageError(f"Time {time:g} is not on file; the frames go from {self.times[0]:g} to {self.times[-1]:g}.")
        return int(np.argmin(np.abs(self.times - time)))

    def grid(self, time: float | None = None, elset: str | Iterable[str] | None = None) -> pyvista.UnstructuredGrid:
        """The bodies with all fields, for pyvista; not deformed (`grid.warp_by_vector("U")` is).

        Args:
            time: that of a frame (the nearest is taken, `grid.field_data["TIME"]` holds it); default the last.
            elset: only the elements of one or several sets; default all, and analytic surfaces.

        Raises:
            UsageError: there is no such set or time.
            ImportError: pyvista is not installed.
        """
        pyvista = needed("pyvista")
        k, n = self.frame(time), len(self._points)
        first, length = self._cells[1][:-1].astype(np.int64), np.diff(self._cells[1]).astype(np.int64)
        padded = np.empty(int((length + 1).sum()), dtype=np.int64)   # the number of its nodes before each cell
        heads = first + np.arange(len(first))
        padded[heads] = length
        padded[np.delete(np.arange(len(padded)), heads)] = self._cells[0]
        grid = pyvista.UnstructuredGrid(padded, self._cells[2], self._points)
        with self._open() as file:
            for name, item in file["VTKHDF/PointData"].items():
                grid.point_data[name] = item[k * n : (k + 1) * n]
        for name, values in self._cell_data.items():
            grid.cell_data[name] = values
        grid.point_data["NODE"] = np.concatenate([self.node_labels, np.zeros(n - len(self.node_labels), dtype=np.int64)])
        if elset is not None:
            names = [elset] if isinstance(elset, str) else list(elset)
            wanted = [self._element_sets[chosen("element set", name, self.element_sets)] for name in names]
            labels = self.element_labels[np.concatenate(wanted)] if wanted else []
            grid = grid.extract_cells(np.flatnonzero(np.isin(self._cell_data["ELEMENT"], labels)))
        grid.field_data["TIME"] = [self.times[k]]
        return grid

    def _table(self, group: str) -> pandas.DataFrame:
        """A group of columns as a table."""
        columns: dict[str, NDArray[Any] | list[str]] = {}
        notes: dict[str, dict[str, str]] = {"units": {}, "descriptions": {}}
        with self._open() as file:
            ours = file["AMONTONS"]
            order = sorted(ours.get(group, {}), key=_place)
            phases = _words(ours["phases"])
            for name in order:
                item = ours[group][name]
                values = _words(item) if item.dtype.kind in "SO" else item[:]
                several = isinstance(values, np.ndarray) and values.ndim == 2
                titles = _titles(name, values.shape[1], phases) if several else [name]
                for k, title in enumerate(titles):
                    columns[title] = values[:, k] if several else values
                    notes["units"][title] = _unit(item)
                    notes["descriptions"][title] = _attribute(item, "description")
        shortest = min((len(values) for values in columns.values()), default=0)   # a running job may be writing a row
        table = needed("pandas").DataFrame({title: values[:shortest] for title, values in columns.items()})
        table.attrs.update(notes)
        return table


def _place(name: str) -> tuple[int, str]:
    """Where a column stands: counts and times first."""
    first = ("step", "increment", "attempt", "iteration", "pair", "total_time", "step_time", "dt", "is_converged")
    return (first.index(name) if name in first else len(first), name)


def _titles(name: str, width: int, phases: list[str]) -> list[str]:
    """The columns of a vector."""
    if name == "n_status":
        return [f"n_{status}" for status in STATUSES]
    if name == "seconds":
        return [f"seconds_{phase}" for phase in phases]
    return [f"{name}{k + 1}" for k in range(width)]


def _sets(group: h5py.Group) -> dict[str, NDArray[np.int64]]:
    """Members of each set, counted from 0."""
    first, members = group["first"][:], group["members"][:].astype(np.int64)
    return {name: members[a:b] for name, a, b in zip(_words(group["name"]), first[:-1], first[1:], strict=True)}


def _words(item: h5py.Dataset) -> list[str]:
    """A data set of texts."""
    return [v.decode(errors="replace").strip() for v in item[:]]


def _text(group: h5py.Group, name: str) -> str:
    """A data set that holds one text."""
    value = group[name][()] if name in group else b""
    return bytes(value).decode(errors="replace").rstrip()


def _attribute(item: h5py.Dataset, name: str) -> str:
    """An attribute that is a text."""
    value = item.attrs.get(name, "")
    return value.decode() if isinstance(value, bytes) else str(value)


def _unit(item: h5py.Dataset) -> str:
    """The unit of a data set."""
    return _attribute(item, "unit")
