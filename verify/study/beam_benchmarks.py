"""The straight, curved and twisted beams of MacNeal and Harder by shells and beams: displacement over the published one.

    python -m verify.study.beam_benchmarks [--program bin/amontons] [--dialect abaqus] [--seconds 120]

R. H. MacNeal, R. L. Harder, A proposed standard set of problems to test finite element accuracy, Finite Elements in Analysis and Design 1 (1985) 3-20.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse

import numpy as np

from verify.decks.shells import Floats, Shell, held, section, shell
from verify.study.shell_benchmarks import displacement, step

# direction of the unit load at the end (4: moment about x), published displacement
STRAIGHT = {"extension": (1, 3e-5), "in plane": (2, 0.1081), "out of plane": (3, 0.4321), "twist": (4, 0.03208)}
CURVED = {"in plane": (2, 0.08734), "out of plane": (3, 0.5022)}
TWISTED = {"in plane": (3, 5.424e-3), "out of plane": (2, 1.754e-3)}
SHAPES = ["regular", "trapezoids", "parallelograms"]
KINDS = ["S3", "S4", "S6", "S8R", "B31", "B32"]


def skew(u: Floats, v: Floats, shape: str) -> Floats:
    """Shifts along x of the lines between the cells, +-0.1 at both edges of the strip: 45 degrees over its width of 0.2."""
    inside = (u > 1e-9) & (u < 1 - 1e-9)
    line = np.rint(6 * u)
    slope = np.where(line % 2 == 1, 1.0, -1.0) if shape == "trapezoids" else np.ones_like(u)
    return np.where(inside, slope * (v - 0.5) * 0.2, 0.0) if shape != "regular" else 0 * u


def straighten(mesh: Shell) -> Shell:
    """Puts the middles of the sides of cells between their ends."""
    for nodes in mesh.elements:
        corners = len(nodes) // 2
        for k in range(corners if mesh.kind[1] in "68" else 0):
            mesh.nodes[nodes[corners + k]] = (mesh.nodes[nodes[k]] + mesh.nodes[nodes[(k + 1) % corners]]) / 2
    return mesh


def shell_deck(problem: str, kind: str, shape: str, direction: int) -> tuple[str, int]:
    """A deck of shells and the node (from 0) at the middle of the loaded end, or at its edge."""
    modulus, ratio, thickness = 1e7, 0.25 if problem == "curved" else 0.3, 0.1
    cells = (6, 1)
    if problem == "straight":
        body = straighten(shell(kind, cells, lambda u, v: (6 * u + skew(u, v, shape), 0.2 * (v - 0.5), 0 * u)))
    elif problem == "curved":
        body = shell(kind, cells, lambda u, v: ((4.12 + 0.2 * (1 - v)) * np.cos(np.pi / 2 * u), (4.12 + 0.2 * (1 - v)) * np.sin(np.pi / 2 * u), 0 * u))
    else:
        modulus, ratio, thickness, cells = 29e6, 0.22, 0.32, (12, 2)

        def twisted(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
            across = 1.1 * (v - 0.5)
            return 12 * u, across * np.cos(np.pi / 2 * u), across * np.sin(np.pi / 2 * u)

        body = shell(kind, cells, twisted)
    loads = "".join(f"{i + 1}, {direction}, {w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    deck = body.cards() + section(modulus, ratio, thickness) + held(body.where(0, 0.0), "ENCASTRE") + step("*CLOAD\n" + loads)
    return deck, body.at(1.0, 0.5 if kind[1] in "68" or cells[1] == 2 else 0.0)


def beam_deck(problem: str, kind: str, direction: int) -> tuple[str, int]:
    """The same of beams; those of the twisted one have a section each."""
    per = 2 if kind.startswith("B32") else 1
    n = 12 if problem == "twisted" else 6
    s = np.linspace(0, 1, per * n + 1)
    modulus, ratio, size = 1e7, 0.25 if problem == "curved" else 0.3, ".2, .1"
    places = np.stack([6 * s, 0 * s, 0 * s], axis=1)
    if problem == "curved":
        places = np.stack([4.22 * np.cos(np.pi / 2 * s), 4.22 * np.sin(np.pi / 2 * s), 0 * s], axis=1)
    if problem == "twisted":
        modulus, ratio, size = 29e6, 0.22, "1.1, .32"
        places = np.stack([12 * s, 0 * s, 0 * s], axis=1)
    deck = "*NODE\n" + "".join(f"{i + 1}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(places))
    deck += f"*MATERIAL, NAME=M\n*ELASTIC\n{modulus:.15g}, {ratio}\n"
    for e in range(n):
        middle = (e + 0.5) / n * np.pi / 2
        first = {"straight": (0, 1, 0), "curved": (np.cos(middle), np.sin(middle), 0), "twisted": (0, np.cos(middle), np.sin(middle))}[problem]
        deck += f"*ELEMENT, TYPE={kind}, ELSET=E{e}\n{e + 1}, " + ", ".join(str(per * e + k + 1) for k in range(per + 1)) + "\n"
        deck += f"*BEAM SECTION, ELSET=E{e}, MATERIAL=M, SECTION=RECT\n{size}\n" + ", ".join(f"{x:.15g}" for x in first) + "\n"
    return deck + held([0], "ENCASTRE") + step(f"*CLOAD\n{per * n + 1}, {direction}, 1.\n"), per * n


def ratio_of(program: str, dialect: str, seconds: float, problem: str, kind: str, shape: str, direction: int, expected: float) -> float:
    """Displacement over the published one; nan if the job does not finish."""
    deck, node = beam_deck(problem, kind, direction) if kind[0] == "B" else shell_deck(problem, kind, shape, direction)
    component = ("UR" if direction > 3 else "U", (direction - 1) % 3)
    return displacement(program, dialect, seconds, deck, node, component) / expected


def main(arguments: list[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--program", default="bin/amontons")
    parser.add_argument("--dialect", default="abaqus")
    parser.add_argument("--seconds", type=float, default=120)
    options = parser.parse_args(arguments)
    print("| problem | load | " + " | ".join(KINDS) + " |\n|---|---|" + "---|" * len(KINDS))
    rows = [("straight", shape, STRAIGHT) for shape in SHAPES] + [("curved", "", CURVED), ("twisted", "", TWISTED)]
    for problem, shape, loads in rows:
        for load, (direction, expected) in loads.items():
            found = [
                "" if kind[0] == "B" and shape not in ("", "regular") else
                f"{ratio_of(options.program, options.dialect, options.seconds, problem, kind, shape, direction, expected):.3f}"
                for kind in KINDS
            ]  # fmt: skip
            print(f"| {problem}{', ' + shape if shape else ''} | {load} | " + " | ".join(found) + " |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
