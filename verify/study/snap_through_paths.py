"""Paths of structures that snap through, by *STATIC, RIKS: a table of limit loads and efforts, and a picture.

    python -m verify.study.snap_through_paths [--program bin/amontons] [--figure doc/verification/snap-through.png] [--seconds 120]

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import resource
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from verify.cases.solution.test_failure_report import pressed_arch
from verify.cases.solution.test_path_following import heads, path, ridge_force, turning_points
from verify.cases.solution.test_stabilization import history
from verify.decks.snap_through import TRUSSES, hinged_roof, lee_frame, path_step, toggle
from verify.independent.elastica import Toggle

ARCH = "*STEP, NLGEOM, INC=200\n*STATIC, RIKS\n0.002, 1., 1e-8, 0.01, 0.06\n*BOUNDARY\nARCH_LEFT, 1, 2\nARCH_RIGHT, 1, 2\nSTAMP_TOP, 1\n*CLOAD\nSTAMP_TOP, 2, -300.\n*END STEP\n"
#: name, deck, column of the displacement in job.dat (0: the stamp), force for the load factor 1
CASES = [
    ("von Mises truss", TRUSSES + path_step("0.05, 1., 1e-5, 0.2, 1.", "*CLOAD\n2, 2, -1.\n"), 2, 1.0),
    ("Lee's frame, CPS8R", lee_frame("0.05, 1., 1e-8, 0.3, 2.2, LOADED, 2, -95."), 2, 1.0),
    ("Williams' toggle, CPS8R", toggle("0.05, 1., 1e-8, 0.1, 2.", 12.943, 0.386, 0.243, 0.753, 1.03e7), 2, 40.0),
    ("hinged roof 12.7, S8R", hinged_roof("0.02, 1., 1e-8, 0.1, 1., LOADED, 3, -28.", 12.7), 3, 3000.0),
    ("hinged roof 6.35, S8R", hinged_roof("0.02, 1., 1e-8, 0.1, 1., LOADED, 3, -28.", 6.35), 3, 3000.0),
    ("stamp on an arch, mu = 0.2", pressed_arch()[: pressed_arch().index("*STEP")] + ARCH, 0, 1500.0),
]


def run(program: Path, deck: str, column: int, seconds: float) -> tuple[np.ndarray, np.ndarray, int, int, float]:
    """Displacement down and load factor from the start on, failed attempts, iterations, processor seconds."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "job.inp").write_text(deck)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([program.resolve(), "job"], cwd=folder, capture_output=True, text=True, timeout=seconds, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        u, factor = path(folder, column) if column else (heads(folder), history(folder, "load_factor"))
        failed, iterations = (int(re.search(rf"{what} +(\d+)", done.stdout)[1]) for what in ("attempts that failed", "Newton iterations"))
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return np.concatenate([[0.0], -u]), np.concatenate([[0.0], factor]), failed, iterations, spent


def references(name: str, u: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Displacements and forces of a reference in closed form or by shooting."""
    points = np.linspace(0.0, u.max(), 200)
    if name.startswith("von"):
        return points, ridge_force(-points)
    if name.startswith("Williams"):
        beams = Toggle(12.943, 0.386, (1.03e7 * 0.753 * 0.243**3 / 12.0, 1.03e7 * 0.753 * 0.243))
        return points[1::10], np.array([beams.load(x) for x in points[1::10]])
    return None


def main() -> None:
    """Prints the table and draws the picture."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=Path, default=Path("bin/amontons"))
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--seconds", type=float, default=120.0)
    options = parser.parse_args()
    results = {}
    print("| structure | limit loads | increments | failed attempts | iterations | processor time [s] |\n|---|---|---|---|---|---|")
    for name, deck, column, force in CASES:
        u, factor, failed, iterations, spent = run(options.program, deck, column, options.seconds)
        limits = ", ".join(f"{force * x:.4g}" for x in turning_points(factor))
        print(f"| {name} | {limits} | {len(u) - 1} | {failed} | {iterations} | {spent:.1f} |", flush=True)
        results[name] = u, force * factor
    if options.figure:
        draw(results, options.figure)


def draw(results: dict[str, tuple[np.ndarray, np.ndarray]], file: Path) -> None:
    """Force against displacement, one picture for each structure."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 3, figsize=(11, 6.4), constrained_layout=True)
    for axis, (name, (u, force)) in zip(axes.flat, results.items(), strict=True):
        known = references(name, u)
        if known is not None:
            axis.plot(*known, "-" if len(known[0]) > 50 else "x", color="tab:orange", label="reference")
        axis.plot(u, force, ".-", color="tab:blue", linewidth=0.8, markersize=4, label="RIKS")
        axis.axhline(0.0, color="black", linewidth=0.5)
        axis.set(title=name, xlabel="displacement", ylabel="force")
        if known is not None:
            axis.legend()
    figure.savefig(file, dpi=90, metadata={"Software": None})


if __name__ == "__main__":
    main()
