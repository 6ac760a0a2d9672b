"""Contact cases of the verification and of the manual, said otherwise: other units, another order, two threads, run twice.

The deck of a case is taken from the case itself: its first one, before anything is run.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Run

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "decks"), str(HERE.parent / "verification"), str(HERE)]

from proof import Job  # noqa: E402
from scaling import Units, scaled, shuffled  # noqa: E402

SYSTEMS = {"SI": Units(1e-3, 1.0), "m-kN": Units(1e-3, 1e-3), "inch-pound": Units(1 / 25.4, 0.22480894387096)}
FIELDS = {"U": "L", "S": "S", "CPRESS": "S", "CNORMF": "F", "CSHEARF": "F"}


class TakenError(Exception):
    """The deck was taken."""


def deck_of_case(module: str, function: str, **values: object) -> str:
    """The first deck of a verification case."""
    taken: list[str] = []

    class Thief:
        """A case that runs nothing."""

        def run(self, deck: str, *_: object, **__: object) -> None:
            taken.append(deck)
            raise TakenError

        def __getattr__(self, name: str) -> Callable[..., None]:
            return lambda *_, **__: None

    test = getattr(importlib.import_module(module), function)
    with pytest.raises(TakenError):
        test(proof=lambda *_, **__: Thief(), **values)
    return taken[0]


def deck_of_file(name: str) -> str:
    """A deck of the repository, its mesh put in."""
    path = ROOT / name
    text = path.read_text()
    for line in text.splitlines():
        if line.upper().startswith("*INCLUDE"):
            text = text.replace(line, (path.parent / line.split("=")[1].strip()).read_text().rstrip())
    return text


CASES: dict[str, Callable[[], str]] = {
    "three cubes": lambda: deck_of_file("input/three_cubes.inp"),
    "example contact": lambda: deck_of_file("doc/manual/examples/contact.inp"),
    "example interference": lambda: deck_of_file("doc/manual/examples/interference.inp"),
    "patch": lambda: deck_of_case("test_contact_patch", "test_matching", mu=0.5),
    "patch, 3 on 4": lambda: deck_of_case("test_contact_patch", "test_not_matching", upper=3, lower=4),
    "Hertz line": lambda: deck_of_case("test_hertz", "test_nafems_r0094_1"),
    "Spence": lambda: deck_of_case("test_partial_slip", "test_spence", nu=0.3, mu=0.3, expected=0.69),
    "flat punch": lambda: deck_of_case("test_partial_slip", "test_flat_punch"),
    "reversal": lambda: deck_of_case("test_sliding", "test_reversal"),
    "shrink fit": lambda: deck_of_case("test_sliding", "test_shrink_fit"),
    "turning block": lambda: deck_of_case("test_sliding", "test_stuck_block_turns", degrees=10.0),
}


@pytest.fixture(scope="module")
def plain(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Job]:
    """The case as it is, run once."""
    done: dict[str, Job] = {}

    def find(name: str) -> Job:
        if name not in done:
            done[name] = solve(run, tmp_path_factory.mktemp("plain"), scaled(CASES[name](), Units()))
        return done[name]

    return find


def solve(run: Run, folder: Path, deck: str, threads: int = 1) -> Job:
    """A job that has to finish."""
    (folder / "job.inp").write_text(deck)
    done = run(["--quiet", "job"], cwd=folder, threads=threads)
    assert done.returncode == 0, done.stdout + done.stderr
    return Job(folder / "job.vtkhdf", "job")


def same(job: Job, wanted: Job, tolerance: float, units: Units | None = None) -> None:
    """Fields of all frames, and iterations per step within one."""
    units = units or Units()
    assert np.allclose(job.times, wanted.times, rtol=1e-12), "other increments"
    for name, letter in FIELDS.items():
        expected = wanted.field(name)
        largest = max(np.abs(wanted.field(other)).max() for other in (["CNORMF", "CSHEARF"] if letter == "F" else [name]))
        worst = np.abs(job.field(name) / units.of(letter) - expected).max()
        assert worst <= tolerance * largest, f"{name} differs by {worst / largest:.1e} of its largest value, allowed {tolerance:.0e}"
    for number in np.unique(wanted.history["step"]):
        counts = [int(j.history["n_iterations"][j.history["step"] == number].sum()) for j in (job, wanted)]
        assert abs(counts[0] - counts[1]) <= 1, f"iterations of step {number}: {counts[0]}, of the plain case {counts[1]}"


SHORT = {"three cubes", "example contact", "example interference", "patch", "patch, 3 on 4"}
ALL = [pytest.param(case, marks=[] if case in SHORT else [pytest.mark.slow]) for case in CASES]
SLOPE = "its compliant law has no stick slope, and the one that is taken then (half of E, with a warning) is a number without its unit"
IN_UNITS = [pytest.param("example contact", marks=pytest.mark.xfail(reason=SLOPE, strict=True)),
            *(entry for entry in ALL if entry.values[0] != "example contact")]  # fmt: skip


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("case", IN_UNITS)
def test_units(run: Run, tmp_path: Path, plain: Callable[[str], Job], case: str, system: str) -> None:
    """N and mm as N and m, kN and m, pound and inch: 1e-8."""
    units = SYSTEMS[system]
    same(solve(run, tmp_path, scaled(CASES[case](), units)), plain(case), 1e-8, units)


@pytest.mark.parametrize("case", ALL)
def test_shuffled_threads_twice(run: Run, tmp_path: Path, plain: Callable[[str], Job], case: str) -> None:
    """The cards of the model in another order and two threads: 1e-10 of each other; the same run again: bitwise."""
    deck, wanted = scaled(CASES[case](), Units()), plain(case)
    for name, text, threads in (("shuffled", shuffled(deck, 3), 1), ("threads", deck, 2), ("again", deck, 1)):
        folder = tmp_path / name
        folder.mkdir()
        job = solve(run, folder, text, threads)
        same(job, wanted, {"shuffled": 1e-8, "threads": 1e-10, "again": 0.0}[name])
