"""The deformed bodies of a job as an image: outer faces with light and depth, drawn by VTK without a display.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pyvista
import vtk
from numpy.typing import NDArray

from amontons.report.data import Floats, Ints, Job

pyvista.OFF_SCREEN = True
vtk.vtkObject.GlobalWarningDisplayOff()   # else VTK speaks of the display that it does not need
vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_OFF)

INK, TOOL = "#22303c", "#b9c2ca"
COLOURS = "viridis"
MARGIN = 0.04  #: of the view, around the bodies [-]
LIFT = 1.0e-3  #: of the edges towards the viewer, so that their faces do not cover them [size of the model]


@dataclass
class Section:
    """A plane across an axis, in front of which nothing is drawn."""

    axis: int
    value: float


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


def section_camera(axis: int) -> tuple[Floats, Floats, Floats]:
    """The same, on the plane of a section, a little from above and aside."""
    above = np.eye(3)[2 if axis != 2 else 1]
    aside = np.cross(above, np.eye(3)[axis])
    towards = np.eye(3)[axis] + 0.38 * (above if axis != 2 else -above) + 0.3 * aside
    towards = towards / np.linalg.norm(towards)
    right = np.cross(above, towards)
    right = right / np.linalg.norm(right)
    return right, np.cross(towards, right), towards


def is_tool(job: Job, nodes: Ints) -> NDArray[np.bool_]:
    """Which rows of nodes belong to analytic surfaces: their points have no labels."""
    return (job.labels[nodes] == 0).all(axis=1) if len(nodes) else np.zeros(0, dtype=bool)


def surfaces(job: Job, x: Floats, values: Floats) -> tuple[pyvista.PolyData, pyvista.PolyData, pyvista.PolyData]:
    """Outer faces of the bodies with their values, edges of their elements with bars, and analytic surfaces."""
    triangles, sides = job.skin.triangles(), job.skin.edges()
    tool = is_tool(job, triangles)
    lines = sides[~is_tool(job, sides)] if len(sides) else sides
    bodies, edges, tools = (_poly(x, cells) for cells in (triangles[~tool], lines, triangles[tool]))
    if bodies.n_points:
        bodies["value"] = values
    return bodies, edges, tools


def _poly(x: Floats, cells: Ints) -> pyvista.PolyData:
    """Triangles or lines between points."""
    rows = np.hstack([np.full((len(cells), 1), cells.shape[1] if len(cells) else 0), cells]).ravel()
    if not len(cells):
        return pyvista.PolyData()
    return pyvista.PolyData(x, faces=rows) if cells.shape[1] == 3 else pyvista.PolyData(x, lines=rows)


def cut_bodies(cells: tuple[Ints, Ints, Ints], x: Floats, values: Floats, section: Section) -> pyvista.PolyData:
    """Outer faces of what lies behind a section. cells: connectivity, offsets and VTK types."""
    connectivity, offsets, kinds = cells
    sizes = np.diff(offsets)
    rows = np.insert(connectivity, offsets[:-1], sizes)
    grid = pyvista.UnstructuredGrid(rows, kinds, x)
    grid["value"] = values
    origin = np.zeros(3)
    origin[section.axis] = section.value
    return grid.clip(normal=np.eye(3)[section.axis], origin=origin, invert=True).extract_surface(algorithm="dataset_surface")


def render(job: Job, x: Floats, values: Floats, top: float, size: tuple[int, int], focus: NDArray[np.bool_], section: Section | None = None,
           cells: tuple[Ints, Ints, Ints] | None = None) -> tuple[NDArray[np.uint8], Floats, Floats]:  # fmt: skip
    """The image, and the directions right and up. focus: the points that have to be seen; top: value of the last colour."""
    right, up, towards = camera(job.points) if section is None else section_camera(section.axis)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none" if job.is_plane else "light kit")
    plotter.set_background("white")
    bodies, edges, tools = surfaces(job, x, values)
    flat = job.is_plane
    look = {"scalars": "value", "cmap": COLOURS, "clim": (0.0, top), "show_scalar_bar": False, "lighting": not flat, "ambient": 0.42, "diffuse": 0.68,
            "specular": 0.08}  # fmt: skip
    if section is not None and cells is not None:
        bodies = cut_bodies(cells, x, values, section)
        edges = bodies.clean().extract_feature_edges(35.0, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
    if bodies.n_faces:
        plotter.add_mesh(bodies, **look, **({} if flat else {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": 35.0}))
    if edges.n_lines:
        edges.points = edges.points + LIFT * float(np.ptp(x, axis=0).max()) * towards
        look = {"color": INK, "opacity": 0.9} if section is not None else {"color": "white", "opacity": 0.35 if edges.n_lines < 20000 else 0.2}
        plotter.add_mesh(edges, line_width=1.2, lighting=False, **look)
    if len(job.lines):
        plotter.add_mesh(_poly(x, job.lines), color=INK, line_width=4, lighting=False)
    if tools.n_faces:
        plotter.add_mesh(tools, color=TOOL, opacity=0.35, smooth_shading=True)
    _aim(plotter, x[focus] if focus.any() else x, right, up, towards, size)
    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    return np.asarray(image), right, up


def _aim(plotter: pyvista.Plotter, seen: Floats, right: Floats, up: Floats, towards: Floats, size: tuple[int, int]) -> None:
    """A parallel view that holds all these points."""
    low, high = seen.min(axis=0), seen.max(axis=0)
    across, along = seen @ right, seen @ up
    middle = (across.max() + across.min()) / 2 * right + (along.max() + along.min()) / 2 * up + ((low + high) / 2 @ towards) * towards
    reach = float(np.linalg.norm(high - low)) or 1.0
    view = plotter.camera
    view.parallel_projection = True
    view.focal_point, view.position, view.up = middle, middle + 20 * reach * towards, up
    view.parallel_scale = (1 + MARGIN) / 2 * max(float(np.ptp(along)), float(np.ptp(across)) * size[1] / size[0], 1e-12 * reach)
    plotter.renderer.ResetCameraClippingRange()


def without_margins(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The image without white rows and columns at its sides."""
    inked = (image < 250).any(axis=2)
    if not inked.any():
        return image
    rows, columns = np.flatnonzero(inked.any(axis=1)), np.flatnonzero(inked.any(axis=0))
    return image[max(rows[0] - 4, 0) : rows[-1] + 5, max(columns[0] - 4, 0) : columns[-1] + 5]
