"""STATIC, RIKS: paths against closed forms, shooting along beams, published limit loads and prescribed displacements; what ends them.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.cases.solution.test_failure_report import pressed_arch
from verify.cases.solution.test_stabilization import history
from verify.conftest import Run
from verify.decks.snap_through import TRUSSES, hinged_roof, lee_frame, path_step, toggle
from verify.independent.elastica import LeeFrame, Toggle

LOAD = "*CLOAD\n2, 2, -1.\n"


def path(folder: Path, column: int) -> tuple[np.ndarray, np.ndarray]:
    """Displacements of the loaded node, from job.dat, and load factors at the increments."""
    rows = [line.split() for line in (folder / "job.dat").read_text().splitlines()]
    return np.array([float(row[column]) for row in rows if len(row) == 4 and row[0].isdigit()]), history(folder, "load_factor")


def count(text: str, what: str) -> int:
    """A count of the summary."""
    found = re.search(rf"{what} +(\d+)", text)
    assert found, text
    return int(found[1])


def turning_points(values: np.ndarray) -> np.ndarray:
    """The values at the turning points: the vertices of the parabolas through three points about each."""
    left, middle, right = values[:-2], values[1:-1], values[2:]
    at = np.flatnonzero((middle - left) * (right - middle) < 0)
    return middle[at] - (right[at] - left[at]) ** 2 / (8.0 * (right[at] - 2.0 * middle[at] + left[at]))


def ridge_force(u: np.ndarray) -> np.ndarray:
    """The force down on a von Mises truss of two bars that keep their volume, with Hencky's strain."""
    height, first = 1.0 + u, np.sqrt(101.0)
    length = np.sqrt(100.0 + height**2)
    return -2.0 * 1000.0 * first / length * np.log(length / first) * height / length


def test_von_mises_truss(run_deck: Run, tmp_path: Path) -> None:
    """Every increment lies on the closed form, over both limit points, without a failed attempt; the load factor is in every output."""
    done = run_deck(TRUSSES + path_step("0.05, 1., 1e-5, 0.2, 1.", LOAD))
    assert done.returncode == 0, done.stdout
    u, factor = path(tmp_path, 2)
    assert factor == pytest.approx(ridge_force(u), abs=2e-6), "seven digits of u in job.dat"
    assert u[-1] < -2.0
    assert factor.max() > 1.0 > factor[-2], "the increment that reaches the largest factor is the last one"
    limit = ridge_force(np.linspace(-1.0, 0.0, 100001)).max()
    assert turning_points(factor) == pytest.approx([limit, -limit], abs=1e-3), "antisymmetric about the flat truss"
    assert factor[0] == pytest.approx(0.05, rel=0.03), "the first arc is the load factor of a linear structure"
    assert count(done.stdout, "attempts that failed") == 0
    assert count(done.stdout, "Newton iterations") <= 2.2 * len(u)
    lines = [line.split() for line in (tmp_path / "job.sta").read_text().splitlines()[2:]]
    assert [float(line[-1]) for line in lines] == pytest.approx(list(factor), rel=1e-5)
    printed = re.findall(r"Load proportionality factor (\S+)\.\n", done.stdout)
    assert [float(word) for word in printed] == pytest.approx(list(factor), rel=1e-5, abs=5.1e-7), "six decimals"


def test_dead_load(run_deck: Run, tmp_path: Path) -> None:
    """The force of the step before stays, and the factor scales what is new."""
    dead = "*STEP, NLGEOM\n*STATIC\n*CLOAD\n2, 2, -0.125\n*END STEP\n"
    done = run_deck(TRUSSES + dead + path_step("0.05, 1., 1e-5, 0.2, 1.", "*CLOAD\n2, 2, -0.625\n"))
    assert done.returncode == 0, done.stdout
    u, factor = path(tmp_path, 2)
    assert 0.125 + 0.5 * factor[1:] == pytest.approx(ridge_force(u), abs=2e-6)
    assert history(tmp_path, "applied_force")[1:, 1] == pytest.approx(-0.125 - 0.5 * factor[1:], rel=1e-12)


def test_prescribed_displacement(run_deck: Run, tmp_path: Path) -> None:
    """The factor scales prescribed displacements, too."""
    done = run_deck(TRUSSES + path_step("0.05, 1., 1e-5, 0.1, 1.", "*BOUNDARY\n2, 2, 2, -2.5\n"))
    assert done.returncode == 0, done.stdout
    u, factor = path(tmp_path, 2)
    assert u == pytest.approx(-2.5 * factor, rel=1e-6)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        force = file["VTKHDF/PointData/RF"][:].reshape(-1, 3, 3)[1:, 1, 1]
    assert force == pytest.approx(-ridge_force(-2.5 * factor), abs=1e-6)


@pytest.mark.parametrize(
    ("line", "increments", "n"),
    [("0.1, 1., , 0.1, 0.3", 50, 4), ("0.1, 1., , 0.1, , LOADED, 2, -0.3", 50, 5), ("0.1, 1., , 0.1", 7, 7), ("0.1, 1., , 0.1, 9., 2, 2, 9.", 7, 7)],
    ids=["load factor", "displacement", "increments", "none reached"],
)
def test_ends(run_deck: Run, tmp_path: Path, line: str, increments: int, n: int) -> None:
    """The step ends with the increment that reaches the load factor or crosses the displacement, at last with INC, and all is well."""
    done = run_deck(TRUSSES + path_step(line, LOAD, increments))
    assert done.returncode == 0, done.stdout
    u, factor = path(tmp_path, 2)
    assert len(u) == n
    if "LOADED" in line:
        assert u[-1] <= -0.3 < u[-2]
    if "0.3" in line.split(",")[4:5]:
        assert factor[-1] >= 0.3 > factor[-2]


def test_restart(run_deck: Run, tmp_path: Path) -> None:
    """A job cut in two by RESTART continues along the path in the same direction, bitwise, beyond a limit point."""
    assert run_deck(TRUSSES + path_step("0.05, 1., 1e-5, 0.2, 1.", "*RESTART, WRITE\n" + LOAD)).returncode == 0
    u, factor = path(tmp_path, 2)
    assert factor[9] < factor[8], "on the falling branch"
    (tmp_path / "job.res").rename(tmp_path / "old.res")
    done = run_deck("*RESTART, READ, STEP=1, INC=9\n", "oldjob=old")
    assert done.returncode == 0, done.stdout
    again, later = path(tmp_path, 2)
    assert np.array_equal(later[-len(factor[9:]) :], factor[9:])
    assert np.array_equal(again, u[9:])


@pytest.mark.parametrize("line", ["0.05, 1., 1e-8, 0.3, 2.2, LOADED, 2, -95.", "0.1, 1., 1e-8, , 2.2, LOADED, 2, -95."], ids=["short arcs", "cut back"])
def test_lee_frame(run_deck: Run, tmp_path: Path, line: str) -> None:
    """Lee's frame, with snap-back: every point lies within 1 % of the path of extensible beams; published limit load. Arcs that grow without
    a limit are cut back, and their points lie on the same curve.
    """
    done = run_deck(lee_frame(line))
    assert done.returncode == 0, done.stdout
    failed = count(done.stdout, "attempts that failed")
    assert 0 < failed < 10 if ", ," in line else failed == 0
    u, factor = path(tmp_path, 2)
    points = np.array([-u / 50.0, factor])
    beams = LeeFrame()
    for i in range(len(u)):
        along = points[:, min(i + 1, len(u) - 1)] - points[:, max(i - 1, 0)]
        assert beams.distance(-u[i], factor[i], along / np.linalg.norm(along)) < 0.01 * 1.85, f"at {u[i]}"
    if ", ," in line:
        return
    limits = turning_points(factor)
    assert limits[0] == pytest.approx(18.552 * 1440.0 / 120.0**2, rel=0.01), "Lee, Manuel, Rossow 1968"
    assert len(limits) == 2
    assert len(turning_points(u)) == 2, "the path snaps back"


def test_williams_toggle(run_deck: Run, tmp_path: Path) -> None:
    """Williams' toggle: the path of extensible beams, from one clamp to the ridge."""
    done = run_deck(toggle("0.05, 1., 1e-8, 0.1, 2.", 12.943, 0.386, 0.243, 0.753, 1.03e7))
    assert done.returncode == 0, done.stdout
    assert count(done.stdout, "attempts that failed") == 0
    u, factor = path(tmp_path, 2)
    beams = Toggle(12.943, 0.386, (1.03e7 * 0.753 * 0.243**3 / 12.0, 1.03e7 * 0.753 * 0.243))
    assert 40.0 * factor == pytest.approx([beams.load(-x) for x in u], rel=0.01, abs=0.1)
    assert 40.0 * turning_points(factor) == pytest.approx([33.75, 31.3], rel=0.01), "of the beams"


@pytest.mark.parametrize(("thickness", "limits"), [(12.7, [2200.0, None]), (6.35, [585.0, -380.0])])
def test_hinged_roof(run_deck: Run, tmp_path: Path, thickness: float, limits: list[float | None]) -> None:
    """Limit loads of the hinged cylindrical roof of K. Y. Sze, X. H. Liu, S. H. Lo (Finite Elem. Anal. Des. 40 (2004) 1551-1569), within
    what can be read from their curves. The thin roof snaps back.
    """
    done = run_deck(hinged_roof("0.02, 1., 1e-8, 0.1, 1., LOADED, 3, -28.", thickness))
    assert done.returncode == 0, done.stdout
    assert count(done.stdout, "attempts that failed") == 0
    found = 3000.0 * turning_points(history(tmp_path, "load_factor"))
    assert len(found) == 2
    for value, limit in zip(found, limits, strict=True):
        assert limit is None or value == pytest.approx(limit, rel=0.025), found


def test_pressed_arch(run_deck: Run, tmp_path: Path) -> None:
    """A stamp under forces presses an arch through along its path, with friction; the same stamp moved down gives the same curve."""
    forces = pressed_arch()
    start = forces.index("*STEP")
    held = "*BOUNDARY\nARCH_LEFT, 1, 2\nARCH_RIGHT, 1, 2\nSTAMP_TOP, 1\n"
    done = run_deck(forces[:start] + "*STEP, NLGEOM, INC=200\n*STATIC, RIKS\n0.002, 1., 1e-8, 0.01, 0.1\n" + held + "*CLOAD\nSTAMP_TOP, 2, -300.\n*END STEP\n")
    assert done.returncode == 0, done.stdout
    assert count(done.stdout, "attempts that failed") == 0
    assert count(done.stdout, "Newton iterations") <= 4 * len(history(tmp_path, "load_factor"))
    force, down = 1500.0 * history(tmp_path, "load_factor"), heads(tmp_path)
    assert len(turning_points(force)) == 2, "it snaps through"
    assert history(tmp_path, "slave_force")[:, 1] == pytest.approx(force, rel=1e-5), "the contact carries the load"
    done = run_deck(forces[:start] + "*STEP, NLGEOM, INC=500\n*STATIC\n0.005, 1., 1e-8, 0.01\n" + held + f"STAMP_TOP, 2, 2, {down[-1]}\n*END STEP\n")
    assert done.returncode == 0, done.stdout
    moved = -history(tmp_path, "slave_force")[:, 1]
    moved = moved if moved.max() > 0 else -moved
    assert force == pytest.approx(np.interp(-down, -heads(tmp_path), moved), abs=0.02 * force[:8].max())


def heads(folder: Path) -> np.ndarray:
    """Mean displacement down of the upper side of the stamp at the increments."""
    with h5py.File(folder / "job.vtkhdf") as file:
        n = len(file["VTKHDF/Steps/Values"])
        places = file["VTKHDF/Points"][:].reshape(-1, 3)
        places = places[: len(places) // n] if len(places) > len(file["VTKHDF/PointData/U"]) // n else places
        u = file["VTKHDF/PointData/U"][:].reshape(n, -1, 3)[1:]
    stamp = (np.abs(places[:, 0]) < 0.21) & (np.abs(places[:, 1] - places[np.abs(places[:, 0]) < 1e-9, 1].max()) < 1e-6)
    return u[:, stamp, 1].mean(axis=1)
