"""Line searches over contact problems: NONE, ALL, GLOBAL, NODAL and AUTO, by friction and size of the increments.

    python verify/study/contact_table.py [--outdir DIR] [--program bin/amontons] [--figure contact_table.png] [--seconds 60]

Four small problems: a block sheared on a block at small displacements (space), a block dragged over a table (plane), a cylinder
pressed into a slab and drawn to and fro (plane), a ball pressed on a table and dragged (space); the last three under NLGEOM. Friction
0.05, 0.3 and 1; each step in 20, 5 or 1 increments asked for. A run counts its Newton iterations, failed attempts included;
one that fails or takes longer than allowed does not finish. The table has one row per problem, friction and size.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "decks"))

from ironing_table import ROOT, Outcome, count_rows  # noqa: E402
from make_decks import Floats, _named_grid, block  # noqa: E402
from planes import flat_deck, flatten  # noqa: E402
from sheets import between, fix, pair, sheet, solid_deck  # noqa: E402

MODES = ("NONE", "ALL", "GLOBAL", "NODAL", "AUTO")
FRICTIONS = (0.05, 0.3, 1.0)
SIZES = (20, 5, 1)
STEEL, SOFT = (210000.0, 0.3), (2000.0, 0.3)


def steps(mode: str, n: int, is_nlgeom: bool, *loads: str) -> str:
    """One step for each load, n increments asked for in each."""
    text = ""
    for load in loads:
        text += f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=1000\n*STATIC\n{1 / n:.10g}, 1., 1e-6, {1 / n:.10g}\n"
        text += f"*LINE SEARCH, TYPE={mode}\n{load}*END STEP\n"
    return text


def shear(mu: float, mode: str, n: int) -> str:
    """A block pressed on a block and sheared, small displacements."""
    wide = between(-0.5, 1.5, 7)
    body, table = block(between(0, 1, 5), between(0, 1, 5), between(0, 0.5, 3), "BODY"), block(wide, wide, [-1, -0.4, 0], "TABLE")
    press = fix("TABLE_BOTTOM, 1, 3", "BODY_TOP, 1, 2", "BODY_TOP, 3, 3, -0.002")
    text = steps(mode, n, False, press, fix("BODY_TOP, 1, 1, 0.004"))
    return solid_deck([(body, STEEL), (table, STEEL)], pair("BODY_BOTTOM", "TABLE_TOP", mu), text)


def drag(mu: float, mode: str, n: int) -> str:
    """A block pressed on a table and dragged over eight facets."""
    body, table = sheet("BODY", between(0, 1, 6), between(0, 1, 6)), sheet("TABLE", between(-1, 4, 20), between(-1, 0, 4))
    press = fix("TABLE_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.05")
    text = steps(mode, n, True, press, fix("BODY_TOP, 1, 1, 2."))
    return flat_deck([(flatten(body), STEEL), (flatten(table), STEEL)], "CPE4", pair("BODY_BOTTOM", "TABLE_TOP", mu) + text)


def cylinder(mu: float, mode: str, n: int) -> str:
    """A cylinder pressed into a slab and drawn to and fro."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle, radius = np.radians(-50 + 100 * s), 2 * (0.4 + 0.6 * (1 - t))
        return radius * np.sin(angle), 2 - radius * np.cos(angle)

    body, slab = sheet("BODY", between(0, 1, 16), between(0, 1, 4), place), sheet("SLAB", between(-4, 4, 30), between(-3, 0, 8))
    press = fix("SLAB_BOTTOM, 1, 2", "BODY_TOP, 1", "BODY_TOP, 2, 2, -0.3")
    text = steps(mode, n, True, press, fix("BODY_TOP, 1, 1, 1."), fix("BODY_TOP, 1, 1, -1."))
    return flat_deck([(flatten(body), STEEL), (flatten(slab), SOFT)], "CPE4", pair("BODY_BOTTOM", "SLAB_TOP", mu) + text)


def ball(mu: float, mode: str, n: int) -> str:
    """A ball pressed on a table and dragged."""
    line = between(-1, 1, 6)
    u, v, w = (a.ravel(order="F") for a in np.meshgrid(line, line, line, indexing="ij"))
    x = u * np.sqrt(1 - v * v / 2 - w * w / 2 + v * v * w * w / 3)
    y = v * np.sqrt(1 - w * w / 2 - u * u / 2 + w * w * u * u / 3)
    z = w * np.sqrt(1 - u * u / 2 - v * v / 2 + u * u * v * v / 3)
    body = _named_grid(np.stack([x, y, z + 1], axis=1), (6, 6, 6), "BALL")
    table = block(between(-1.5, 2.5, 9), between(-1.5, 1.5, 7), between(-1, 0, 2), "TABLE")
    press = fix("TABLE_BOTTOM, 1, 3", "BALL_TOP, 1, 2", "BALL_TOP, 3, 3, -0.05")
    text = steps(mode, n, True, press, fix("BALL_TOP, 1, 1, 0.8"))
    return solid_deck([(body, STEEL), (table, STEEL)], pair("BALL_BOTTOM", "TABLE_TOP", mu), text)


PROBLEMS: dict[str, tuple[Callable[[float, str, int], str], int]] = {
    "block sheared": (shear, 2), "block dragged": (drag, 2), "cylinder": (cylinder, 3), "ball": (ball, 2),
}  #: name: (deck, its steps)


def run(program: Path, folder: Path, name: str, deck: str, asked: int, seconds: float) -> Outcome:
    """Runs one deck; one that takes too long is stopped and did not finish."""
    (folder / f"{name}.inp").write_text(deck)
    command = [program, "--quiet", "--no-checkpoint", "--outdir", folder, folder / f"{name}.inp"]
    try:
        code = subprocess.run(command, check=False, capture_output=True, timeout=seconds).returncode
    except subprocess.TimeoutExpired:
        code = -1
    (folder / f"{name}.vtkhdf").unlink(missing_ok=True)
    return count_rows(folder / f"{name}.sta", asked, code == 0)


def draw(sums: dict[str, list[int]], file: Path) -> None:
    """Runs finished, and iterations over the runs that all modes finish."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 3.0))
    left, right = figure.subplots(1, 2)
    left.bar(MODES, [sums[mode][0] for mode in MODES])
    left.set(ylabel="runs finished")
    right.bar(MODES, [sums[mode][3] for mode in MODES])
    right.set(ylabel="iterations, runs that all finish")
    for axes in (left, right):
        axes.tick_params(axis="x", labelsize=8)
    figure.tight_layout()
    figure.savefig(file, dpi=110, metadata={"Software": None})


def main() -> int:
    """Runs all cases and prints the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--outdir", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--seconds", type=float, default=60.0, help="most time of one run")
    options = parser.parse_args()
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    print("| problem | mu | increments a step | " + " | ".join(MODES) + " |")
    print("|---" * (3 + len(MODES)) + "|", flush=True)
    sums = {mode: [0, 0, 0, 0] for mode in MODES}  # finished, their iterations, failed attempts, iterations where all finish
    for name, (deck, n_steps) in PROBLEMS.items():
        for mu in FRICTIONS:
            for n in SIZES:
                asked = n_steps * n
                row = {}
                for mode in MODES:
                    job = f"{mode.lower()}_{name.replace(' ', '_')}_{mu:g}_{n}"
                    row[mode] = run(options.program, folder, job, deck(mu, mode, n), asked, options.seconds)
                for mode, o in row.items():
                    sums[mode][0] += o.is_done
                    sums[mode][1] += o.iterations * o.is_done
                    sums[mode][2] += o.failed
                    sums[mode][3] += o.iterations * all(other.is_done for other in row.values())
                cells = [f"{o.per_asked:.1f} ({o.failed})" if o.is_done else "-" for o in row.values()]
                print(f"| {name} | {mu:g} | {n} | " + " | ".join(cells) + " |", flush=True)
    for k, words in enumerate(("runs finished", "iterations of the finished runs", "failed attempts", "iterations where all finish")):
        print(f"| {words} | | | " + " | ".join(str(sums[mode][k]) for mode in MODES) + " |")
    if options.figure:
        draw(sums, options.figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
