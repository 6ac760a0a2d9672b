"""Draws a finished job to one PNG, without a display: deformed shape, contact maps, history of the contact forces.

    make picture JOB=job.vtkhdf
    PYTHONPATH=python python -m verify.tools.picture job.vtkhdf [--output job.png] [--increment N] [--pair N] [--section x|y|z[=VALUE]] [--bodies]

Left: the deformed bodies coloured by the Mises stress (displacements magnified by a round factor that is printed), as a whole or cut
by a section. Right, of one pair: pressure and friction on the slave surface, status of each slave node, its slip scenario if the
last increment had any. A slave surface that runs round a cylinder is unrolled, with the seam opposite to the load. Of plane bodies these are curves. Last, of each
pair: N and T over time, the sums of the sizes of the normal and tangential forces of its slave nodes, and mu N, which T cannot exceed.

N of --increment counts the increments on file from 0, the initial state; default: the last. --pair counts from 1 as in the deck;
default: the pair with the largest N. --bodies draws the bodies alone.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
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
from matplotlib.gridspec import GridSpec, SubplotSpec  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402
from matplotlib.transforms import ScaledTranslation  # noqa: E402
from matplotlib.tri import Triangulation  # noqa: E402

from amontons.report import data, round_factor  # noqa: E402
from amontons.report.data import Floats, Ints  # noqa: E402
from PIL import Image  # noqa: E402

from verify.tools import scene, slave_map  # noqa: E402
from verify.tools.scene import Section, camera  # noqa: E402
from verify.tools.slave_map import Map, Pair  # noqa: E402

__all__ = ["Job", "camera", "draw", "main", "read_job", "shape"]

INK = "#22303c"
GREY = "#9aa7b1"
STATUS_COLOURS = ["#dfe4e8", "#2f6db3", "#f28e2b"]
STATUS_NAMES = ["open", "stick", "slip"]
SCENARIO_COLOURS = ["#eef1f3", "#4daf7c", "#f2c14e", "#d1495b", "#6c5b9e"]
SCENARIO_NAMES = ["none", "I slipped too far", "II not enough slip", "III backed up too far", "IV backing up"]
STRIP = 2.5  #: width over height of a map from which maps stand one above the other
PAIR_COLOURS = ["#2f6db3", "#d1495b", "#1b9e77", "#7b3294", "#a6761d", "#666666"]
STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": GREY,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
}


@dataclass
class Job:
    """What the picture needs of a result file."""

    data: data.Job
    pairs: list[Pair]
    cells: tuple[Ints, Ints, Ints]  #: connectivity, offsets, VTK types

    def frame(self, name: str, k: int) -> Floats:
        """One field at one increment; zeros where the file does not have it."""
        fields = self.data.fields
        return fields[name][k] if name in fields else np.zeros(len(self.data.points))

    @property
    def step_ends(self) -> list[float]:
        """Times between two steps."""
        ends = np.cumsum(self.data.steps["period"])
        return [float(end) for end in ends if end < self.data.times[-1] * (1 - 1e-9)]


def read_job(path: Path) -> Job:
    """Result file to what is drawn. ValueError: it is not a result file of Amontons."""
    job = data.read_job(path)
    with h5py.File(path, "r", locking=False) as file:
        grid = file["VTKHDF"]
        cells = grid["Connectivity"][:].astype(np.int64), grid["Offsets"][:].astype(np.int64), grid["Types"][:]
        return Job(job, _pairs(job, file["AMONTONS"]), cells)


def _pairs(job: data.Job, group: h5py.Group) -> list[Pair]:
    """The pairs that have slave nodes; forces and counts are those of the file, node by node and pair by pair."""
    if "contact" not in group or not len(job.slave_node):
        return []
    frames, n = len(job.times), len(job.slave_node)
    table = {name: group["contact"][name][: frames * n].reshape(frames, n, -1) for name in ("force", "shear", "status", "scenario")}
    pairs = []
    for i, (slave, master) in enumerate(zip(job.pairs["slave"], job.pairs["master"], strict=True)):
        mine = np.flatnonzero(job.slave_pair == i)
        if not len(mine):
            continue
        rows = np.flatnonzero(job.pair_history["pair"] == i)
        found = [rows[np.argmin(np.abs(job.pair_history["total_time"][rows] - t))] for t in job.times]
        sizes = [np.linalg.norm(table[name][:, mine], axis=2).sum(axis=1) for name in ("force", "shear")]
        pairs.append(Pair(f"{slave} on {master}", float(job.pairs["friction"][i]), job.slave_node[mine], sizes[0], sizes[1],
                          table["status"][:, mine, 0].astype(np.int64), table["scenario"][:, mine, 0].astype(np.int64),
                          np.asarray(job.pair_history["n_status"])[found]))  # fmt: skip
    return pairs


def nodal(job: Job, nodes: Ints, values: Ints) -> Ints:
    """Values of slave nodes at all nodes."""
    everywhere = np.zeros(len(job.data.points), dtype=np.int64)
    everywhere[nodes] = values
    return everywhere


# ------------------------------------------------------------------------------------------------ the bodies


@dataclass
class View:
    """The deformed bodies as an image."""

    image: np.ndarray
    right: Floats  #: directions of the paper
    up: Floats
    norm: Normalize  #: of the Mises stress
    factor: float  #: of magnification

    @property
    def ratio(self) -> float:
        """Width over height."""
        return float(self.image.shape[1] / self.image.shape[0])


def view_of(job: Job, k: int, section: Section | None = None, is_close: bool = False) -> View:
    """The deformed bodies, whole or cut.

    is_close: only around what is stressed, and at true size where bodies touch: magnified, they would seem to overlap.
    """
    factor = 1.0 if is_close and job.pairs else round_factor(job.data)
    x = job.data.points + factor * job.frame("U", k)
    mises = job.frame("S_mises", k)
    largest = float(job.data.fields["S_mises"].max())   # of the job: rounding of an unloaded body is dark
    norm = Normalize(0.0, max(float(mises.max()), 1e-6 * largest) or 1.0)
    image, right, up = scene.render(job.data, x, mises, norm.vmax, (1500, 1500), in_view(job, x, mises, 0.05 if is_close else 1e-9), section, job.cells)
    return View(scene.without_margins(image), right, up, norm, factor)


def draw_bodies(axes: Axes, view: View) -> None:
    """The image, the directions and the colours below it."""
    axes.imshow(view.image, interpolation="lanczos")
    axes.axis("off")
    axes.set_anchor("N")
    _triad(axes, view.right, view.up, view.ratio)   # what stands below has its place by the width of the image
    place = axes.inset_axes((0.24, -0.07 * view.ratio, 0.7, 0.022 * view.ratio))
    bar = plt.colorbar(plt.cm.ScalarMappable(view.norm, scene.COLOURS), cax=place, orientation="horizontal")
    bar.locator = MaxNLocator(6 if view.ratio > 0.7 else 4)
    bar.set_label("Mises stress")
    bar.outline.set_visible(False)


def in_view(job: Job, x: Floats, mises: Floats, share: float) -> np.ndarray:
    """Rigid bodies may be far larger than what deforms: they are seen only around it."""
    is_stressed = mises > share * max(float(mises.max()), 1e-300)
    is_body = np.zeros(len(x), dtype=bool)
    is_body[job.cells[0]] = True
    if not is_stressed.any():
        return is_body
    low, high = x[is_stressed].min(axis=0), x[is_stressed].max(axis=0)
    margin = 0.3 * float((high - low).max())
    return is_body & ((x >= low - margin) & (x <= high + margin)).all(axis=1)


def _triad(axes: Axes, right: Floats, up: Floats, ratio: float) -> None:
    """The directions of the axes, left of the colours; below a narrow image they reach beyond its left side."""
    size = max(0.16, 0.13 / ratio)
    inset = axes.inset_axes((0.16 - size, -(size + 0.02) * ratio, size, size * ratio))
    for d, name in enumerate("xyz"):
        tip = np.array([right[d], up[d]])
        if np.linalg.norm(tip) < 1e-9:
            continue
        inset.annotate("", xy=tip, xytext=(0, 0), arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.1})
        place = tip * (1 + 0.28 / max(float(np.linalg.norm(tip)), 0.3))
        inset.text(*place, name, ha="center", va="center", fontsize=9)
    inset.set(xlim=(-1.4, 1.4), ylim=(-1.4, 1.4), aspect="equal")
    inset.axis("off")


# ------------------------------------------------------------------------------------------------- the maps


def legend_below(axes: Axes, size: float = 8.5, **words: object) -> None:
    """A legend below the name of the axis."""
    below = axes.transAxes + ScaledTranslation(0, -32 / 72, axes.figure.dpi_scale_trans)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below, frameon=False, fontsize=size, **words)


def _map_axes(axes: Axes, chart: Map, title: str) -> None:
    """Frame of a map."""
    place = np.concatenate(chart.places)
    pad = 0.03 * np.ptp(place, axis=0).max()
    (x0, y0), (x1, y1) = place.min(axis=0) - pad, place.max(axis=0) + pad
    axes.set(xlim=(x0, x1), ylim=(y0, y1), xlabel=chart.labels[0], ylabel=chart.labels[1])
    axes.set_aspect("equal", anchor="N")
    axes.set_title(title + (f" ({chart.remark})" if chart.remark else ""))
    axes.locator_params(nbins=5)
    axes.tick_params(length=2)
    for side in axes.spines.values():
        side.set_visible(False)


def draw_pressure(axes: Axes, job: Job, chart: Map, k: int) -> None:
    """Contact pressure as colour, friction on the slave as arrows."""
    pressure = job.frame("CPRESS", k)
    triangles, start = [], 0
    for face in chart.corners:
        triangles += [[start, start + i, start + i + 1] for i in range(1, len(face) - 1)]
        start += len(face)
    places, nodes = np.concatenate(chart.places), np.concatenate(chart.corners)
    top = float(pressure[nodes].max()) or 1.0
    mesh = axes.tripcolor(Triangulation(*places.T, triangles), pressure[nodes], shading="gouraud", cmap="YlOrRd", vmin=0.0, vmax=top)
    shear = job.frame("CSHEAR", k)
    rows = [(*place, *(chart.directions[n] @ shear[n])) for n, found in chart.nodal.items() for place in found] if shear.ndim == 2 else []
    arrows = np.array(rows).reshape(-1, 4)
    longest = float(np.linalg.norm(arrows[:, 2:], axis=1).max()) if len(arrows) else 0.0
    if longest > 1e-6 * top:
        axes.quiver(
            *arrows.T, color=INK, angles="xy", scale_units="xy", scale=longest / nearest_distance(arrows[:, :2]), width=0.0045,
            headwidth=4, pivot="mid",
        )  # fmt: skip
    _map_axes(axes, chart, "Pressure, and friction on the slave")
    bar = plt.colorbar(mesh, ax=axes, orientation="horizontal", shrink=0.9, aspect=40, pad=0.02)
    bar.set_label("contact pressure")
    bar.outline.set_visible(False)


def nearest_distance(places: Floats) -> float:
    """Median distance of a point to its nearest neighbour."""
    some = places[:: max(1, len(places) // 1500)]
    apart = np.linalg.norm(some[:, None] - places[None], axis=2)
    apart[apart == 0] = np.inf
    return float(np.median(apart.min(axis=1)))


def of_points(pair: slave_map.Pair, k: int) -> str:
    """What the counts of a status are of, where the pair has integration points in place of slave nodes."""
    return "" if sum(pair.counts[k]) == len(pair.scenario[k]) else " (integration points)"


def draw_classes(axes: Axes, chart: Map, values: Ints, counts: Ints, colours: list[str], names: list[str], title: str) -> None:
    """Each slave node's part of the faces around it in the colour of its class; counts are those of the file."""
    cells, nodes = slave_map.parts_of(chart)
    picture = PolyCollection(cells, array=values[nodes], cmap=ListedColormap(colours), norm=BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours)))
    picture.set(edgecolor="face", linewidth=0.2)
    axes.add_collection(picture)
    places = np.concatenate(chart.places)
    axes.plot(*places.T, ".", color="white", ms=2.2, mew=0, alpha=0.8)
    handles = [Patch(color=colours[c], label=f"{names[c]} ({counts[c]})") for c in range(len(names))]
    _map_axes(axes, chart, title)
    legend_below(axes, handles=handles, ncols=3 if len(names) == 3 or is_strip(chart) else 2, handlelength=1.1, columnspacing=1.2)


def draw_history(axes: Axes, job: Job, k: int) -> None:
    """N and T of each pair over time, with mu N where Coulomb's law limits T."""
    times, shown = job.data.times, job.pairs[: len(PAIR_COLOURS)]
    for i, pair in enumerate(shown):
        colour, name = PAIR_COLOURS[i], f"{pair.name}: " if len(job.pairs) > 1 else ""
        wider = min(1.1, 4 / len(shown)) * (len(shown) - 1 - i)   # curves that coincide are all seen
        axes.plot(times, pair.normal, color=colour, lw=2 + wider, label=f"{name}N")
        if pair.shear.max() > 1e-9 * max(pair.normal.max(), 1e-300):
            axes.plot(times, pair.shear, color=colour, lw=1.2 + wider, marker="o", ms=3 + wider, label=f"{name}T")
        if pair.has_coulomb:
            axes.plot(times, pair.friction * pair.normal, color=colour, lw=1, ls="--", label=f"{name}{pair.friction:g} N")
    for end in job.step_ends:
        axes.axvline(end, color=GREY, lw=0.8, ls=":")
    axes.axvline(times[k], color="#d1495b", lw=1.2, alpha=0.8)
    axes.set(xlabel="time", xlim=(0, times[-1]))
    axes.set_ylim(bottom=0)
    axes.set_title("Contact forces, summed by size")
    axes.grid(axis="y", color="#e3e8ec")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    legend_below(axes, 8 if len(job.pairs) > 1 else 8.5, ncols=min(3, len(job.pairs)) if len(job.pairs) > 1 else 3, handlelength=1.6)


def _draw_maps(figure: plt.Figure, parts: list[SubplotSpec], job: Job, k: int, pair: Pair, chart: Map) -> None:
    """Pressure, status, and scenarios where nodes have any."""
    places = [figure.add_subplot(part) for part in parts]
    draw_pressure(places[0], job, chart, k)
    draw_classes(places[1], chart, nodal(job, pair.nodes, pair.status[k]), pair.counts[k], STATUS_COLOURS, STATUS_NAMES, f"Status{of_points(pair, k)}")
    if len(places) > 2:
        scenario, counts = nodal(job, pair.nodes, pair.scenario[k]), np.bincount(pair.scenario[k], minlength=len(SCENARIO_NAMES))
        draw_classes(places[2], chart, scenario, counts, SCENARIO_COLOURS, SCENARIO_NAMES, "Slip scenario, last seen")


def _draw_contact(figure: plt.Figure, grid: GridSpec, job: Job, k: int, pair: Pair, chart: Map | None,
                  below: SubplotSpec | None) -> None:  # fmt: skip
    """The panels on the right. below: where the forces stand, if that is below the bodies."""
    has_scenario = bool(pair.scenario[k].any())
    if chart is None:
        forces = below or grid[1, 2]
        _draw_line_of_slaves(figure, grid[0, 1:], grid[1, 1:] if below else grid[1, 1], job, k, pair)
    elif is_strip(chart):   # one above the other
        heights = [1.3, 1, 1][: 2 + has_scenario] + ([] if below else [1.7])
        rows = grid[:, 1:].subgridspec(len(heights), 1, height_ratios=heights)
        forces = below or rows[len(heights) - 1]
        _draw_maps(figure, [rows[i] for i in range(2 + has_scenario)], job, k, pair, chart)
    else:
        forces = grid[1, 2] if has_scenario else grid[1, 1:]
        _draw_maps(figure, [grid[0, 1], grid[0, 2], grid[1, 1]][: 2 + has_scenario], job, k, pair, chart)
    draw_history(figure.add_subplot(forces), job, k)


def is_strip(chart: Map) -> bool:
    """Whether a map is much wider than high."""
    width, height = np.ptp(np.concatenate(chart.places), axis=0)
    return bool(width > STRIP * height)


def _draw_line_of_slaves(figure: plt.Figure, above: SubplotSpec, below: SubplotSpec, job: Job, k: int, pair: Pair) -> None:
    """The panels of slaves that have no faces, as those of plane bodies."""
    place, label = slave_map.along_of(job.data, pair, job.frame("CPRESS", k))
    order = np.argsort(place, kind="stable")
    nodes, s = pair.nodes[order], place[order]
    pressure = job.frame("CPRESS", k)[nodes]
    shear = np.linalg.norm(np.reshape(job.frame("CSHEAR", k)[nodes], (len(nodes), -1)), axis=1)
    axes = figure.add_subplot(above)
    axes.plot(s, pressure, color="#2f6db3", lw=1.5, marker="o", ms=3, label="pressure")
    axes.plot(s, shear, color="#f28e2b", lw=1.5, marker="o", ms=3, label="friction")
    axes.set(xlabel=label)
    axes.set_title("Pressure and friction of the slave nodes")
    axes.legend(frameon=False, fontsize=8.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes = figure.add_subplot(below)
    rows = [("status", pair.status[k], pair.counts[k], STATUS_COLOURS, STATUS_NAMES)]
    if pair.scenario[k].any():
        counts = np.bincount(pair.scenario[k], minlength=len(SCENARIO_NAMES))
        rows.append(("scenario", pair.scenario[k], counts, SCENARIO_COLOURS, SCENARIO_NAMES))
    for height, (_, values, counts, colours, names) in enumerate(rows):
        for c, what in enumerate(names):
            mine = values[order] == c
            axes.scatter(s[mine], np.full(mine.sum(), -height), 14, color=colours[c], label=f"{what} ({counts[c]})", edgecolors=GREY, linewidths=0.3)
    axes.set(xlabel=label, ylim=(0.4 - len(rows), 0.6), yticks=-np.arange(len(rows)), yticklabels=[name for name, *_ in rows])
    axes.set_title(f"Status{of_points(pair, k)}" + (", and slip scenario last seen" if len(rows) > 1 else ""))
    handles = axes.get_legend_handles_labels()[0]
    if len(rows) > 1:   # a column of the status, one of the scenarios
        gap = [Patch(alpha=0, label="")] * (len(SCENARIO_NAMES) - len(STATUS_NAMES))
        handles = handles[: len(STATUS_NAMES)] + gap + handles[len(STATUS_NAMES) :]
    legend_below(axes, 8, handles=handles, ncols=len(rows) if len(rows) > 1 else len(STATUS_NAMES))
    axes.spines[["top", "right", "left"]].set_visible(False)


# ------------------------------------------------------------------------------------------------- the whole


def draw(job: Job, k: int, output: Path, pair: int | None = None, section: Section | None = None, is_bodies_only: bool = False) -> float:
    """The whole picture; gives the factor of magnification. pair: from 0; default: the one with the largest N."""
    times = job.data.times
    with plt.rc_context(STYLE):
        has_contact = bool(job.pairs) and not is_bodies_only
        view = view_of(job, k, section)
        shown = int(np.argmax([p.normal[k] for p in job.pairs])) if has_contact and pair is None else pair or 0
        figure = plt.figure(figsize=(13.5, 7.6) if has_contact else (8, 7.6), dpi=120, layout="constrained")
        grid = figure.add_gridspec(2, 3 if has_contact else 1, width_ratios=[1.7, 1, 1] if has_contact else None)
        share = 0.8 * (1 / view.ratio + 0.22)   # of the height that the image and what stands below it take
        chart = slave_map.map_of(job.data, job.pairs[shown], job.frame("CPRESS", k)) if has_contact else None
        is_low = has_contact and share < 0.7 and (chart is None or is_strip(chart))   # the forces have a place below it
        left = grid[:, 0].subgridspec(2, 1, height_ratios=[share, 1 - share]) if is_low else None
        bodies = figure.add_subplot(left[0] if left else grid[:, 0])
        draw_bodies(bodies, view)
        magnified = "true scale" if view.factor == 1 else f"displacements \u00d7 {view.factor:g}"
        cut = "" if section is None else f", cut at {'xyz'[section.axis]} = {section.value:g}"
        bodies.set_title(f"Deformed shape{cut}, {magnified}")
        name = f"{job.data.name}   t = {times[k]:.4g}   (increment {k} of {len(times) - 1} on file)"
        if has_contact:
            _draw_contact(figure, grid, job, k, job.pairs[shown], chart, left[1] if left else None)
            name += f"   pair {shown + 1} of {len(job.pairs)}: {job.pairs[shown].name}" if len(job.pairs) > 1 else ""
        figure.suptitle(name, x=0.01, ha="left", fontsize=14)
        figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08, wspace=0.03, hspace=0.04)
        figure.savefig(output, facecolor="white")
        plt.close(figure)
    return view.factor


def reduce_colours(path: Path) -> None:
    """A picture of 256 colours, which looks the same and has a fifth of the bytes."""
    with Image.open(path) as image:
        reduced = image.convert("RGB").quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE)
    reduced.save(path, optimize=True)


def shape(path: Path) -> tuple[plt.Figure, str]:
    """The deformed bodies alone at the end of a job, small, and what to write below."""
    job = read_job(path)
    k = len(job.data.times) - 1
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(6.4, 4.4), layout="constrained")
        view = view_of(job, k, is_close=True)
        draw_bodies(figure.add_subplot(), view)
        plt.close(figure)
    magnified = "in true size" if view.factor == 1 else f"{view.factor:g} times as large"
    return figure, f"elements at the end (t = {job.data.times[k]:.4g}), displacements {magnified}; the colour is the Mises stress."


def section_of(text: str, job: Job) -> Section:
    """x, y or z, with =VALUE; default: the middle of the bodies. ValueError: another text."""
    name, _, value = text.partition("=")
    if name not in ("x", "y", "z"):
        raise ValueError(f"a section is x, y or z with =VALUE, not {text}")
    axis = "xyz".index(name)
    along = job.data.points[:, axis]
    return Section(axis, float(value) if value else float(along.max() + along.min()) / 2)


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="Draw a finished job to PNG, without a display.")
    parser.add_argument("result", type=Path, help="job.vtkhdf")
    parser.add_argument("--output", type=Path, help="default: the result file's name with .png")
    parser.add_argument("--increment", type=int, default=-1, metavar="N", help="increment on file from 0; default: the last")
    parser.add_argument("--pair", type=int, metavar="N", help="contact pair from 1; default: that with the largest normal force")
    parser.add_argument("--section", metavar="AXIS[=VALUE]", help="leave out what lies above this value of x, y or z; default: the middle")
    parser.add_argument("--bodies", action="store_true", help="the bodies alone")
    options = parser.parse_args(arguments)
    try:
        job = read_job(options.result)
        section = section_of(options.section, job) if options.section else None
    except (OSError, KeyError, ValueError) as problem:
        print(f"picture: {options.result}: {problem}", file=sys.stderr)
        return 2
    count = len(job.data.times)
    if not -count <= options.increment < count:
        print(f"picture: increment {options.increment} is not on file; there are 0 to {count - 1}", file=sys.stderr)
        return 2
    if options.pair is not None and not 1 <= options.pair <= len(job.pairs):
        print(f"picture: there is no pair {options.pair}; there are {len(job.pairs)} with slave nodes", file=sys.stderr)
        return 2
    output = options.output or options.result.with_suffix(".png")
    factor = draw(job, options.increment % count, output, None if options.pair is None else options.pair - 1, section, options.bodies)
    if output.suffix == ".png":
        reduce_colours(output)
    print(f"{output} (displacements magnified by {factor:g})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
