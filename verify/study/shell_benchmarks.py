"""The benchmark shells of MacNeal and Harder on several meshes, even and uneven: displacement over the published one.

    python -m verify.study.shell_benchmarks [--program bin/amontons] [--dialect abaqus] [--seconds 120]

Scordelis-Lo roof (0.3024), pinched cylinder with diaphragms (1.8248e-5), hemisphere with a hole (0.0930): R. H. MacNeal, R. L. Harder, A proposed
standard set of problems to test finite element accuracy, Finite Elements in Analysis and Design 1 (1985) 3-20. Uneven meshes, whose cells are warped: Y. Ko,
P.-S. Lee, K.-J. Bathe, A new MITC4+ shell element, Comput. Struct. 182 (2017) 404-418.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

from verify.decks.shells import Floats, Shell, held, section, shell

Place = Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]

MESHES = [("S4", 8), ("S4", 10), ("S4", 16), ("S4", 20), ("S4", 32), ("S4", 40), ("S3", 16), ("S3", 32), ("S8R", 4), ("S8R", 8), ("S8R", 16), ("S6", 4)]
MESHES += [("S6", 8), ("S6", 16), ("S6", 32)]
UNEVEN = [("S4", 4), ("S4", 8), ("S4", 16), ("S4", 32), ("S3", 16), ("S8R", 4), ("S8R", 8), ("S6", 4), ("S6", 8), ("S6", 16)]


def uneven(place: Place, n: int) -> Place:
    """Cells whose sides along an edge are as 1 : 2 : ... : n, along the opposite one as n : ... : 1, with straight lines between them."""

    def rising(x: Floats) -> Floats:
        return x * (n * x + 1) / (n + 1)

    def falling(x: Floats) -> Floats:
        return 1 - rising(1 - x)

    def moved(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        return place((1 - v) * rising(u) + v * falling(u), (1 - u) * rising(v) + u * falling(v))

    return moved


def step(load: str) -> str:
    """One linear step."""
    return f"*STEP\n*STATIC\n{load}*END STEP\n"


def arc(radius: float, length: float, angle: float) -> Place:
    """A part of a cylinder about y, from the top."""
    return lambda u, v: (radius * np.sin(np.radians(angle * u)), length * v, radius * np.cos(np.radians(angle * u)))


def mesh(kind: str, n: int, place: Place, is_uneven: bool) -> Shell:
    """n x n cells."""
    return shell(kind, (n, n), uneven(place, n) if is_uneven else place)


def roof(kind: str, n: int, is_uneven: bool = False) -> tuple[Shell, str, int, int, float]:
    """Mesh, deck, node, direction and displacement of the roof."""
    body = mesh(kind, n, arc(25, 25, 40), is_uneven)
    supports = held(body.where(1, 0.0), "1") + held(body.where(1, 0.0), "3") + held(body.where(1, 1.0), "YSYMM") + held(body.where(0, 0.0), "XSYMM")
    deck = body.cards() + section(4.32e8, 0.0, 0.25, 360.0) + supports + step("*DLOAD\nE, GRAV, 1., 0, 0, -1\n")
    return body, deck, body.at(1, 1), 2, -0.3024


def cylinder(kind: str, n: int, is_uneven: bool = False) -> tuple[Shell, str, int, int, float]:
    """The same of the pinched cylinder."""
    body = mesh(kind, n, arc(300, 300, 90), is_uneven)
    supports = held(body.where(1, 0.0), "1") + held(body.where(1, 0.0), "3") + held(body.where(1, 1.0), "YSYMM")
    supports += held(body.where(0, 0.0), "XSYMM") + held(body.where(0, 1.0), "ZSYMM")
    node = body.at(0, 1)
    return body, body.cards() + section(3e6, 0.3, 3.0) + supports + step(f"*CLOAD\n{node + 1}, 3, -.25\n"), node, 2, -1.8248e-5


def hemisphere(kind: str, n: int, is_uneven: bool = False) -> tuple[Shell, str, int, int, float]:
    """The same of the hemisphere with a hole of 18 degrees."""

    def place(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        a, b = np.radians(90 * u), np.radians(72 * v)
        return 10 * np.cos(b) * np.cos(a), 10 * np.cos(b) * np.sin(a), 10 * np.sin(b)

    body = mesh(kind, n, place, is_uneven)
    node = body.at(0, 0)
    supports = held(body.where(0, 0.0), "YSYMM") + held(body.where(0, 1.0), "XSYMM") + held([node], "3")
    load = step(f"*CLOAD\n{node + 1}, 1, 1.\n{body.at(1, 0) + 1}, 2, -1.\n")
    return body, body.cards() + section(6.825e7, 0.3, 0.04) + supports + load, node, 0, 0.0930


def displacement(program: str, dialect: str, seconds: float, deck: str, node: int, component: tuple[str, int]) -> float:
    """Last value of a component of the field U or UR at a node; nan if the job does not finish."""
    name, direction = component
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "job.inp"
        path.write_text(deck)
        done = subprocess.run([program, f"--dialect={dialect}", "--outdir", folder, str(path)], capture_output=True, timeout=seconds, check=False)
        if done.returncode != 0:
            return float("nan")
        with h5py.File(Path(folder) / "job.vtkhdf") as file:
            points = int(file["VTKHDF/NumberOfPoints"][0])
            return float(file[f"VTKHDF/PointData/{name}"][-points:][node, direction])


def ratio(program: str, dialect: str, seconds: float, made: tuple[Shell, str, int, int, float]) -> float:
    """Displacement over the published one; nan if the job does not finish."""
    _, deck, node, direction, expected = made
    return displacement(program, dialect, seconds, deck, node, ("U", direction)) / expected


def main(arguments: list[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--program", default="bin/amontons")
    parser.add_argument("--dialect", default="abaqus")
    parser.add_argument("--seconds", type=float, default=120)
    options = parser.parse_args(arguments)
    for title, meshes in (("mesh", MESHES), ("uneven mesh", UNEVEN)):
        print(f"| {title} | roof | cylinder | hemisphere |\n|---|---|---|---|")
        for kind, n in meshes:
            row = [ratio(options.program, options.dialect, options.seconds, made(kind, n, meshes is UNEVEN)) for made in (roof, cylinder, hemisphere)]
            print(f"| {kind}, {n} x {n} | " + " | ".join(f"{r:.3f}" for r in row) + " |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
