"""An angle bracket near its plastic limit load: bounds of limit analysis, and what the way there costs.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

from verify.benchmark.plastic_cube import compressed_cube
from verify.conftest import Run
from verify.decks.brackets import Bracket, limit_pressures
from verify.readers.sta_cvg_files import read_cvg, read_sta

HARDENING = "300., 0.\n310., 0.2\n"


def failed_and_iterations(folder: Path) -> tuple[int, int]:
    """Attempts that failed, and the iterations of all."""
    attempts = read_sta(folder / "job.sta")
    return sum(attempt.is_failed for attempt in attempts), sum(attempt.iterations for attempt in attempts)


def test_limit_load_between_hinges(run_deck: Run, tmp_path: Path) -> None:
    """Perfect plasticity, small displacements: the last pressure lies between the hinge in plane stress and that in plane strain, and the
    job ends with LIMIT POINT or a load that does not converge, never with exit 0."""
    low, high = limit_pressures()
    assert run_deck(Bracket(pressure=low).deck()).returncode == 0
    done = run_deck(Bracket(pressure=1.3 * high).deck())
    assert done.returncode == 5, done.stdout
    reached = 1.3 * high * max(attempt.time for attempt in read_sta(tmp_path / "job.sta") if not attempt.is_failed)
    assert low < reached < high


def test_way_to_the_limit_load(run_deck: Run, tmp_path: Path) -> None:
    """NLGEOM with slight hardening to 0.97 of the load at which the tangent first loses its sign in iterates: few attempts fail."""
    for kind, counts, pressure, most_failed, most_iterations in (
        ("C3D10", (2, 5, 10), 2.3, 2, 80),
        ("C3D20R", (2, 4, 8), 2.45, 3, 100),
        ("C3D8I", (3, 5, 12), 2.25, 2, 85),
    ):
        done = run_deck(Bracket(kind, *counts, hardening=HARDENING, pressure=pressure, is_nlgeom=True).deck())
        assert done.returncode == 0, done.stdout
        failed, iterations = failed_and_iterations(tmp_path)
        assert failed <= most_failed and iterations <= most_iterations, f"{kind}: {failed}, {iterations}"


def test_line_search_where_a_cube_yields(run_deck: Run, tmp_path: Path) -> None:
    """A clamped cube most of which begins to yield in one increment: Newton's third full step passes the minimum of the energy and AUTO
    shortens it. TYPE=NONE takes eight iterations, and diverges on a finer mesh (verify.benchmark.plastic_cube)."""
    assert run_deck(compressed_cube(24, 200.0)).returncode == 0
    iterations = [row for row in read_cvg(tmp_path / "job.cvg") if row.increment == 2]
    assert len(iterations) == 7
    assert [row.iteration for row in iterations if row.step_length < 1] == [3]
