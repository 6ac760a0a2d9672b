"""Draws a finished job to one PNG, without a display: deformed shape, contact maps, history of the contact force.

    python -m verify.tools.picture job.vtkhdf [--output job.png] [--increment N]

Left: the deformed bodies coloured by the Mises stress (displacements magnified by a round factor that is printed).
Right: pressure and friction on the slave surface, status of each slave node, its slip scenario, and the sums of normal
and tangential contact force over time. Plane bodies are seen along z, and their slaves laid out along x or y. N counts the increments on file from 0, the initial state; default: the last.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402
from matplotlib.colors import BoundaryNorm, ListedColormap, Normalize  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402
from matplotlib.tri import Triangulation  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

INK = "#22303c"
STATUS_COLOURS = ["#dfe4e8", "#2f6db3", "#f28e2b"]
STATUS_NAMES = ["open", "stick", "slip"]
SCENARIO_COLOURS = ["#eef1f3", "#4daf7c", "#f2c14e", "#d1495b", "#6c5b9e"]
SCENARIO_NAMES = ["none", "I slipped too far", "II not enough slip", "III backed up too far", "IV backing up"]
STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": "#9aa7b1",
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
}

#: Corner nodes of the faces of each VTK cell type, outward.
_HEX = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
_TET = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
_WEDGE = [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
FACES = {12: _HEX, 25: _HEX, 10: _TET, 24: _TET, 13: _WEDGE, 26: _WEDGE}
#: Plane cells are their own faces, bars their own lines.
PLANE = {5: [[0, 1, 2]], 22: [[0, 1, 2]], 9: [[0, 1, 2, 3]], 23: [[0, 1, 2, 3]]}
BARS = {3, 21}


@dataclass
class Job:
    """What the picture needs of a result file."""

    name: str
    points: Floats  #: (n, 3) reference coordinates
    skin: list[Ints]  #: outer faces, corner nodes, outward
    bars: list[Ints]  #: ends of trusses and springs
    shells: list[Ints]  #: plane cells among solids: rigid surfaces
    times: Floats
    fields: dict[str, Floats]  #: (n_frames, n, ...) by name
    slaves: Ints  #: slave nodes, empty without contact
    friction: float | None  #: the only coefficient of friction of the deck
    step_ends: list[float]

    def frame(self, name: str, k: int) -> Floats:
        """One field at one increment; zeros where the file does not have it."""
        if name in self.fields:
            return self.fields[name][k]
        return np.zeros(len(self.points))


def read_job(path: Path) -> Job:
    """The temporal VTKHDF layout with one static mesh."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        n = int(grid["NumberOfPoints"][0])
        offsets = {name: values[:] for name, values in grid["Steps/PointDataOffsets"].items()}
        fields = {}
        for name, starts in offsets.items():
            data = grid["PointData"][name]
            fields[name] = np.stack([data[int(o) : int(o) + n] for o in starts])
        cells = grid["Connectivity"][:], grid["Offsets"][:], grid["Types"][:]
        times = grid["Steps/Values"][:]
        text = _text(file)
        slaves = _slaves(file, fields)
        friction = {float(v) for v in re.findall(r"(?im)^\s*\*\s*FRICTION[^\n]*\n\s*([0-9.eE+-]+)", text)}
        skin, shells = outer_faces(*cells, FACES), outer_faces(*cells, PLANE)
        if not skin:
            skin, shells = shells, []
        job = Job(path.stem, grid["Points"][:], skin, bar_ends(*cells), shells, times, fields, slaves, None, _step_ends(text, times))
    if len(friction) == 1:
        job.friction = friction.pop()
    return job


def _text(file: h5py.File) -> str:
    """The deck, if the file holds it."""
    value = file["AMONTONS/deck"][()] if "AMONTONS/deck" in file else b""
    if isinstance(value, np.ndarray):
        value = b"\n".join(bytes(v).rstrip() for v in value.ravel())
    return value.decode() if isinstance(value, bytes) else str(value)


def _slaves(file: h5py.File, fields: dict[str, Floats]) -> Ints:
    """Slave nodes from /AMONTONS/contact; else every node that was ever closed."""
    if "AMONTONS/contact/node" in file:
        return np.unique(file["AMONTONS/contact/node"][:]).astype(np.int64)
    status = fields.get("CSTATUS")
    return np.flatnonzero((status > 0).any(axis=0)) if status is not None else np.zeros(0, dtype=np.int64)


def _step_ends(text: str, times: Floats) -> list[float]:
    """Ends of the load steps, from the data lines of *STATIC."""
    periods = [float(p or 1) for p in re.findall(r"(?im)^\s*\*\s*STATIC[^\n]*\n[^,\n]*,\s*([0-9.eEdD+-]*)", text)]
    ends = np.cumsum(periods)
    return [float(end) for end in ends if end < times[-1] * (1 - 1e-9)]


def outer_faces(connectivity: Ints, offsets: Ints, types: Ints, faces: dict[int, list[list[int]]]) -> list[Ints]:
    """Faces that belong to one cell only; faces: the corners of those of each type of cell."""
    seen: dict[tuple[int, ...], Ints | None] = {}
    for start, kind in zip(offsets[:-1], types, strict=False):
        for local in faces.get(int(kind), []):
            nodes = connectivity[start + np.array(local)]
            key = tuple(sorted(int(v) for v in nodes))
            seen[key] = nodes if key not in seen else None
    return [nodes for nodes in seen.values() if nodes is not None]


def bar_ends(connectivity: Ints, offsets: Ints, types: Ints) -> list[Ints]:
    """First and last corner of the cells that are lines."""
    return [connectivity[start + np.array([0, 1])] for start, kind in zip(offsets[:-1], types, strict=False) if int(kind) in BARS]


# ------------------------------------------------------------------------------------------------ the bodies


def round_factor(points: Floats, u: Floats) -> float:
    """1, 2 or 5 times a power of ten: the largest displacement shows as about a twelfth of the model; at least 1."""
    largest = float(np.linalg.norm(u, axis=1).max())
    wanted = float(np.ptp(points, axis=0).max()) / 12 / largest if largest > 0 else 1.0
    if wanted <= 1.5:
        return 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(v for v in (1, 2, 5) if v * power <= wanted * 1.0000001)


def camera(points: Floats) -> tuple[Floats, Floats, Floats]:
    """Right, up, and towards the viewer; along z on plane bodies, flatter on a model that is thin in y."""
    extent = np.ptp(points, axis=0)
    if extent[2] == 0:
        return np.eye(3)[0], np.eye(3)[1], np.eye(3)[2]
    azimuth, elevation = (-62.0, 24.0) if extent[1] > 0.2 * extent.max() else (-80.0, 14.0)
    a, e = math.radians(azimuth), math.radians(elevation)
    towards = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return right, np.cross(towards, right), towards


def draw_bodies(axes: Axes, job: Job, k: int, is_close: bool = False) -> float:
    """Deformed outer faces, those turned away left out, far ones first. Gives the factor of magnification.

    is_close: only around what is stressed, and at true size where bodies touch: magnified, they would seem to overlap.
    """
    u = job.frame("U", k)
    factor = 1.0 if is_close and len(job.slaves) else round_factor(job.points, u)
    x = job.points + factor * u
    mises = job.frame("S_mises", k)
    right, up, towards = camera(job.points)
    for bar in job.bars:
        axes.plot(x[bar] @ right, x[bar] @ up, color=INK, lw=1.5)
    if job.shells:
        outlines = [np.stack([x[face] @ right, x[face] @ up], axis=1) for face in job.shells]
        axes.add_collection(PolyCollection(outlines, facecolors="none", edgecolors="#9aa7b1", linewidths=0.4, zorder=3))
    norm = Normalize(0.0, float(mises.max()) or 1.0)
    if job.skin:
        _draw_faces(axes, job, x, mises, norm)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.margins(0.01)
    _look_at(axes, np.stack([x @ right, x @ up], axis=1), mises > (0.05 if is_close else 1e-9) * norm.vmax)
    axes.axis("off")
    _triad(axes, right, up)
    bar = plt.colorbar(
        plt.cm.ScalarMappable(norm, "viridis"), cax=axes.inset_axes((0.22, -0.07, 0.7, 0.022)), orientation="horizontal"
    )
    bar.set_label("Mises stress")
    bar.outline.set_visible(False)
    return factor


def _look_at(axes: Axes, flat: Floats, is_stressed: NDArray[np.bool_]) -> None:
    """Rigid bodies may be far larger than what deforms: they are seen only around it."""
    if not is_stressed.any():
        return
    low, high = flat[is_stressed].min(axis=0), flat[is_stressed].max(axis=0)
    margin = 0.3 * (high - low).max()
    if (np.ptp(flat, axis=0) > (high - low) + 2 * margin).any():
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        axes.set_xlim(max(left, low[0] - margin), min(right, high[0] + margin))
        axes.set_ylim(max(bottom, low[1] - margin), min(top, high[1] + margin))


def _draw_faces(axes: Axes, job: Job, x: Floats, mises: Floats, norm: Normalize) -> None:
    """The faces as shaded pieces, and the edges of the elements."""
    right, up, towards = camera(job.points)
    pieces = cut_faces(job.skin, x, mises)
    facing = pieces.normals @ towards
    order = np.argsort(pieces.corners.mean(axis=1) @ towards)
    order = order[facing[order] > 1e-6]
    colours = plt.get_cmap("viridis")(norm(pieces.values))
    colours[:, :3] *= (0.72 + 0.28 * np.clip(facing, 0, 1))[:, None]
    shapes, fills, strokes, widths = [], [], [], []
    line = (0.0, 0.0, 0.0, 0.45)
    thin = 0.45 if len(job.skin) < 3000 else 0.2
    flat = np.stack([pieces.corners @ right, pieces.corners @ up], axis=-1)
    for i in order:
        shapes.append(flat[i])
        fills.append(colours[i])
        strokes.append(colours[i])
        widths.append(0.4)
        for side in np.flatnonzero(pieces.is_edge[i]):
            shapes.append(flat[i][[side, (side + 1) % 4]])
            fills.append((0, 0, 0, 0))
            strokes.append(line)
            widths.append(thin)
    axes.add_collection(PolyCollection(shapes, facecolors=fills, edgecolors=strokes, linewidths=widths))


@dataclass
class Pieces:
    """Faces cut into small quadrilaterals, so that colour runs smoothly and depth sorts well."""

    corners: Floats  #: (m, 4, 3)
    values: Floats  #: (m) mean value
    normals: Floats  #: (m, 3) unit normal of the face
    is_edge: NDArray[np.bool_]  #: (m, 4) whether the side from corner k to k + 1 is on the element's edge


def cut_faces(skin: list[Ints], x: Floats, values: Floats) -> Pieces:
    """The more pieces, the fewer faces there are."""
    corners = np.array([f if len(f) == 4 else [*f, f[2]] for f in skin])
    cuts = 4 if len(skin) < 2500 else 2 if len(skin) < 10000 else 1
    places, nodal = x[corners], values[corners]
    normals = np.cross(places[:, 2] - places[:, 0], places[:, 3] - places[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]

    def at(s: float, t: float) -> Floats:
        return np.array([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])

    quads, means, edges = [], [], []
    for i in range(cuts):
        for j in range(cuts):
            low, high = np.array([i, j]) / cuts, np.array([i + 1, j + 1]) / cuts
            weights = [at(low[0], low[1]), at(high[0], low[1]), at(high[0], high[1]), at(low[0], high[1])]
            quads.append(np.stack([np.einsum("a,fai->fi", w, places) for w in weights], axis=1))
            means.append(nodal @ at(*((low + high) / 2)))
            edges.append(np.tile([j == 0, i == cuts - 1, j == cuts - 1, i == 0], (len(skin), 1)))
    return Pieces(
        np.concatenate(quads), np.concatenate(means), np.tile(normals, (cuts * cuts, 1)), np.concatenate(edges)
    )


def _triad(axes: Axes, right: Floats, up: Floats) -> None:
    """The directions of the axes in a corner."""
    inset = axes.inset_axes((0.0, -0.15, 0.16, 0.16))
    for d, name in enumerate("xyz"):
        if right[d] == 0 and up[d] == 0:
            continue
        tip = np.array([right[d], up[d]])
        inset.annotate("", xy=tip, xytext=(0, 0), arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.1})
        place = tip * (1 + 0.28 / max(float(np.linalg.norm(tip)), 0.3))
        inset.text(*place, name, ha="center", va="center", fontsize=9)
    inset.set(xlim=(-1.4, 1.4), ylim=(-1.4, 1.4), aspect="equal")
    inset.axis("off")


# ------------------------------------------------------------------------------------------------- the maps


@dataclass
class Map:
    """The slave surface laid flat."""

    nodes: Ints  #: slave nodes of its faces
    plane: Floats  #: (n_points, 2) coordinates of all nodes in the plane
    faces: list[Ints]
    axes: Floats  #: (2, 3) directions of the plane
    labels: tuple[str, str]


def slave_map(job: Job) -> Map:
    """The faces whose nodes are all slaves, seen along their mean normal with the axes nearest to x, y, z."""
    is_slave = np.zeros(len(job.points), dtype=bool)
    is_slave[job.slaves] = True
    faces = [f for f in job.skin if is_slave[f].all()]
    x = job.points
    normal = sum((np.cross(x[f[2]] - x[f[0]], x[f[-1]] - x[f[1]]) for f in faces), np.zeros(3))
    dropped = int(np.argmax(np.abs(normal))) if faces else 2
    kept = [d for d in range(3) if d != dropped]
    axes = np.eye(3)[kept]
    return Map(
        np.unique(np.concatenate(faces)) if faces else job.slaves,
        x @ axes.T,
        faces,
        axes,
        ("xyz"[kept[0]], "xyz"[kept[1]]),
    )


def _map_axes(axes: Axes, chart: Map, title: str) -> None:
    """Frame of a map."""
    place = chart.plane[chart.nodes]
    pad = 0.03 * np.ptp(place, axis=0).max()
    (x0, y0), (x1, y1) = place.min(axis=0) - pad, place.max(axis=0) + pad
    axes.set(xlim=(x0, x1), ylim=(y0, y1), xlabel=chart.labels[0], ylabel=chart.labels[1])
    axes.set_aspect("equal")
    axes.set_title(title)
    axes.locator_params(nbins=5)
    axes.tick_params(length=2)
    for side in axes.spines.values():
        side.set_visible(False)


def draw_pressure(axes: Axes, job: Job, chart: Map, k: int) -> None:
    """Contact pressure as colour, friction on the slave as arrows."""
    pressure = job.frame("CPRESS", k)
    triangles = [t for f in chart.faces for t in ([f[:3]] if len(f) == 3 else [f[[0, 1, 2]], f[[0, 2, 3]]])]
    top = max(float(pressure[chart.nodes].max()), 1e-300)
    mesh = axes.tripcolor(
        Triangulation(*chart.plane.T, triangles), pressure, shading="gouraud", cmap="YlOrRd", vmin=0.0, vmax=top
    )
    if "CSHEAR" in job.fields:
        shear = job.frame("CSHEAR", k) @ chart.axes.T
        longest = float(np.linalg.norm(shear[chart.nodes], axis=1).max())
        if longest > 1e-6 * top:
            spacing = nearest_distance(chart.plane[chart.nodes])
            axes.quiver(
                *chart.plane[chart.nodes].T, *shear[chart.nodes].T, color=INK, angles="xy", scale_units="xy",
                scale=longest / spacing, width=0.0045, headwidth=4, pivot="mid",
            )  # fmt: skip
    _map_axes(axes, chart, "Pressure, and friction on the slave")
    bar = plt.colorbar(mesh, cax=axes.inset_axes((0.0, -0.3, 1.0, 0.04)), orientation="horizontal")
    bar.set_label("contact pressure")
    bar.outline.set_visible(False)


def nearest_distance(places: Floats) -> float:
    """Median distance of a point to its nearest neighbour."""
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + np.diag(np.full(len(places), np.inf))
    return float(np.median(apart.min(axis=1)))


def draw_classes(
    axes: Axes, job: Job, chart: Map, values: Ints, colours: list[str], names: list[str], title: str
) -> None:
    """Each slave node's part of the faces around it in the colour of its class."""
    cells, classes = [], []
    for face in chart.faces:
        corners = chart.plane[face]
        centre = corners.mean(axis=0)
        for a, node in enumerate(face):
            after, before = (corners[a] + corners[(a + 1) % len(face)]) / 2, (corners[a] + corners[a - 1]) / 2
            cells.append([corners[a], after, centre, before])
            classes.append(int(values[node]))
    picture = PolyCollection(
        cells,
        array=np.array(classes),
        cmap=ListedColormap(colours),
        norm=BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours)),
    )
    picture.set(edgecolor="face", linewidth=0.2)
    axes.add_collection(picture)
    axes.plot(*chart.plane[chart.nodes].T, ".", color="white", ms=2.2, mew=0, alpha=0.8)
    counts = [int((values[chart.nodes] == c).sum()) for c in range(len(names))]
    handles = [Patch(color=colours[c], label=f"{names[c]} ({counts[c]})") for c in range(len(names))]
    _map_axes(axes, chart, title)
    axes.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3 if len(names) == 3 else 2,
        frameon=False, fontsize=8.5, handlelength=1.1, columnspacing=1.2,
    )  # fmt: skip


def draw_history(axes: Axes, job: Job, k: int) -> None:
    """Normal and tangential contact force on the slave over time, with mu N where there is one mu."""
    normal = np.linalg.norm(job.fields["CNORMF"][:, job.slaves].sum(axis=1), axis=1)
    shear = np.linalg.norm(job.fields["CSHEARF"][:, job.slaves].sum(axis=1), axis=1)
    axes.plot(job.times, normal, color="#2f6db3", lw=2, marker="o", ms=3, label="normal N")
    if shear.max() > 1e-9 * normal.max():
        axes.plot(job.times, shear, color="#f28e2b", lw=2, marker="o", ms=3, label="tangential T")
    if job.friction:
        axes.plot(job.times, job.friction * normal, color=INK, lw=1.2, ls="--", label=f"{job.friction:g} N")
    for end in job.step_ends:
        axes.axvline(end, color="#9aa7b1", lw=0.8, ls=":")
    axes.axvline(job.times[k], color="#d1495b", lw=1.2, alpha=0.8)
    axes.set(xlabel="time", xlim=(0, job.times[-1]))
    axes.set_ylim(bottom=0)
    axes.set_title("Contact force")
    axes.grid(axis="y", color="#e3e8ec")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3, frameon=False, fontsize=8.5, handlelength=1.6)


def draw(job: Job, k: int, output: Path) -> float:
    """The whole picture; gives the factor of magnification."""
    with plt.rc_context(STYLE):
        has_contact = len(job.slaves) > 0 and "CNORMF" in job.fields
        figure = plt.figure(figsize=(15.5, 8.4) if has_contact else (9, 8.4), dpi=120, layout="constrained")
        grid = figure.add_gridspec(2, 3 if has_contact else 1, width_ratios=[1.7, 1, 1] if has_contact else None)
        bodies = figure.add_subplot(grid[:, 0])
        factor = draw_bodies(bodies, job, k)
        magnified = "true scale" if factor == 1 else f"displacements \u00d7 {factor:g}"
        bodies.set_title(f"Deformed shape, {magnified}")
        if has_contact:
            _draw_contact(figure, grid, job, k)
        figure.suptitle(
            f"{job.name}   t = {job.times[k]:.4g}   (increment {k} of {len(job.times) - 1} on file)",
            x=0.01,
            ha="left",
            fontsize=14,
        )
        figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08, wspace=0.03, hspace=0.04)
        figure.savefig(output, facecolor="white")
        plt.close(figure)
    return factor


def shape(path: Path) -> tuple[plt.Figure, str]:
    """The deformed bodies alone at the end of a job, small, and what to write below."""
    job = read_job(path)
    k = len(job.times) - 1
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(6.4, 4.4), layout="constrained")
        factor = draw_bodies(figure.add_subplot(), job, k, is_close=True)
        plt.close(figure)
    magnified = "in true size" if factor == 1 else f"{factor:g} times as large"
    return figure, f"elements at the end (t = {job.times[k]:.4g}), displacements {magnified}; the colour is the Mises stress."


def _draw_contact(figure: plt.Figure, grid: matplotlib.gridspec.GridSpec, job: Job, k: int) -> None:
    """The four panels on the right."""
    chart = slave_map(job)
    if not chart.faces:
        _draw_line_of_slaves(figure, grid, job, k)
        return
    draw_pressure(figure.add_subplot(grid[0, 1]), job, chart, k)
    status = job.frame("CSTATUS", k).astype(int)
    scenario = job.frame("CSCENARIO", k).astype(int)
    draw_classes(figure.add_subplot(grid[0, 2]), job, chart, status, STATUS_COLOURS, STATUS_NAMES, "Status")
    draw_classes(
        figure.add_subplot(grid[1, 1]),
        job,
        chart,
        scenario,
        SCENARIO_COLOURS,
        SCENARIO_NAMES,
        "Slip scenario, last seen",
    )
    draw_history(figure.add_subplot(grid[1, 2]), job, k)


def _draw_line_of_slaves(figure: plt.Figure, grid: matplotlib.gridspec.GridSpec, job: Job, k: int) -> None:
    """The panels of slaves that have no faces, as those of plane bodies: over the direction in which they reach farthest."""
    places = job.points[job.slaves]
    along = int(np.argmax(np.ptp(places, axis=0)))
    order = np.argsort(places[:, along], kind="stable")
    nodes, s = job.slaves[order], places[order, along]
    pressure = job.frame("CPRESS", k)[nodes]
    shear = np.linalg.norm(np.reshape(job.frame("CSHEAR", k)[nodes], (len(nodes), -1)), axis=1)
    axes = figure.add_subplot(grid[0, 1:])
    axes.plot(s, pressure, color="#2f6db3", lw=1.5, marker="o", ms=3, label="pressure")
    axes.plot(s, shear, color="#f28e2b", lw=1.5, marker="o", ms=3, label="friction")
    axes.set(xlabel="xyz"[along])
    axes.set_title("Pressure and friction of the slave nodes")
    axes.legend(frameon=False, fontsize=8.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes = figure.add_subplot(grid[1, 1])
    for name, colours, names, height in (
        ("CSTATUS", STATUS_COLOURS, STATUS_NAMES, 1.0),
        ("CSCENARIO", SCENARIO_COLOURS, SCENARIO_NAMES, 0.0),
    ):
        values = job.frame(name, k)[nodes].astype(int)
        for c, what in enumerate(names):
            axes.scatter(s[values == c], np.full((values == c).sum(), height), 14, color=colours[c], label=f"{what} ({(values == c).sum()})",
                         edgecolors="#9aa7b1", linewidths=0.3)  # fmt: skip
    axes.set(xlabel="xyz"[along], ylim=(-0.6, 1.6), yticks=[0, 1], yticklabels=["scenario", "status"])
    axes.set_title("Status, and slip scenario last seen")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2, frameon=False, fontsize=8)
    axes.spines[["top", "right", "left"]].set_visible(False)
    draw_history(figure.add_subplot(grid[1, 2]), job, k)


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="Draw a finished job to PNG, without a display.")
    parser.add_argument("result", type=Path, help="job.vtkhdf")
    parser.add_argument("--output", type=Path, help="default: the result file's name with .png")
    parser.add_argument(
        "--increment", type=int, default=-1, metavar="N", help="increment on file from 0; default: the last"
    )
    options = parser.parse_args(arguments)
    try:
        job = read_job(options.result)
    except (OSError, KeyError) as problem:
        print(f"picture: {options.result}: {problem}", file=sys.stderr)
        return 2
    count = len(job.times)
    if not -count <= options.increment < count:
        print(f"picture: increment {options.increment} is not on file; there are 0 to {count - 1}", file=sys.stderr)
        return 2
    output = options.output or options.result.with_suffix(".png")
    factor = draw(job, options.increment % count, output)
    print(f"{output} (displacements magnified by {factor:g})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
