"""Every deck of every case of the verification in three systems of units: fields to 1e-8, iterations of each step within one.

The cases run as they are, but for their jobs: each deck is run with tight controls in its own units and in the other ones, and with its own
controls in inch and pound, where the iterations are compared. All cases take half an hour, so every twentieth of them runs, and with one of
the systems by turns, unless AMONTONS_EVERY_CASE is set.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import importlib
import itertools
import os
from collections.abc import Callable, Iterator, Sequence
from inspect import signature
from pathlib import Path
from types import SimpleNamespace

import pytest

from verify.cases.proof import Case, Job
from verify.conftest import Run
from verify.invariance.comparison import SYSTEMS, InUnits, same, same_counts
from verify.invariance.scaling import Units, scaled

HERE = Path(__file__).resolve().parent


EVERY = bool(os.environ.get("AMONTONS_EVERY_CASE"))
#: What Newton's method may leave, where 1e-10 of the largest force is too much: of nearly incompressible sheets it moves the tip by 1e-8.
TIGHT = {"cook-incompressible": 1e-12}
#: What rounding leaves of a slender body, where it is more than 1e-8: seven systems of units scatter this beam's stresses and reactions by 1.4e-8, and the
#: residual is 1e-14 of the largest internal force.
ROUNDED = {"macneal-harder-curved-b32": 1e-7}


class Compared(Case):
    """A case whose jobs are compared, and whose own checks are not judged again."""

    turn = 0  #: which system of units it takes, unless it takes all

    def run(self, deck: str, name: str = "job", requested: int = 0, threads: int = 1) -> Job:
        """A deck in all systems of units; the job in its own."""
        del requested, threads
        tight = TIGHT.get(self.name, 1e-10)
        plain = self.solve(scaled(deck, Units(), tight), self.work / name)
        names = list(SYSTEMS)
        for system in names if EVERY else [names[self.turn % len(names)]]:
            units = SYSTEMS[system]
            job = self.solve(scaled(deck, units, tight), self.work / f"{name} {system}")
            same(job, plain, ROUNDED.get(self.name, 1e-8), InUnits(units))
        same_counts(self.solve(scaled(deck, SYSTEMS["inch-pound"], 0), self.work / f"{name} own inch"), self.solve(deck, self.work / f"{name} own"))
        return plain

    def solve(self, deck: str, folder: Path) -> Job:
        """A job that has to finish."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "job.inp").write_text(deck)
        done = self.runner(["--quiet", "--no-checkpoint", "job"], cwd=folder)
        assert done.returncode == 0, done.stdout + done.stderr
        return Job(folder / "job.vtkhdf", folder.name)

    def done(self) -> None:
        """Nothing: verify/cases judges the case."""


def cases() -> Iterator[object]:
    """All tests of verify/cases that make a page, with each of their sets of values."""
    for file in sorted((HERE.parent / "cases").glob("*/test_*.py")):
        module = importlib.import_module(f"verify.cases.{file.parent.name}.{file.stem}")
        for name, function in vars(module).items():
            if name.startswith("test_") and callable(function) and "proof" in signature(function).parameters:
                for values in sets_of_values(function):
                    words = "-".join(getattr(value, "__name__", str(value)) for value in values.values())
                    yield pytest.param(function, values, id=f"{file.stem}-{name}[{words}]")


def sets_of_values(function: Callable[..., None]) -> Iterator[dict[str, object]]:
    """What pytest.mark.parametrize would call it with."""
    tables: list[list[dict[str, object]]] = []
    for mark in (mark for mark in getattr(function, "pytestmark", []) if mark.name == "parametrize"):
        names: Sequence[str] = mark.args[0].replace(" ", "").split(",") if isinstance(mark.args[0], str) else mark.args[0]
        rows = (row.values if hasattr(row, "marks") else row if len(names) > 1 else (row,) for row in mark.args[1])
        tables.append([dict(zip(names, row, strict=True)) for row in rows])
    for chosen in itertools.product(*tables):
        yield {name: value for row in chosen for name, value in row.items()}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("turn", "case", "values"),
    [pytest.param(turn, *chosen.values, id=chosen.id) for turn, chosen in enumerate(list(cases())[:: 1 if EVERY else 20])],
)
def test_case(
    run: Run, tmp_path: Path, turn: int, case: Callable[..., None], values: dict[str, object], request: pytest.FixtureRequest
) -> None:
    """N and mm as N and m, kN and m, pound and inch."""
    if case.__name__ in ("test_stack", "test_wall"):
        reason = "S differs by 1e-7 to 1e-5 of the largest: blocks in flight touch down where rounding says, and friction remembers it"
        request.applymarker(pytest.mark.xfail(reason=reason, strict=False))
    if case.__name__ == "test_twisted_beam" and 0.001754 in values.values():
        reason = "the residual is 1e-15 after one iteration, so that rounding ends the job: after 4 iterations in SI units for 2, with the same results"
        request.applymarker(pytest.mark.xfail(reason=reason, strict=False))

    def proof(name: str, **words: str) -> Case:
        compared = Compared(name, runner=run, work=tmp_path, pages=None, **words)
        compared.turn = turn
        return compared

    fixtures = {"proof": proof, "run": run, "tmp_path": tmp_path, "request": SimpleNamespace()}
    case(**values, **{name: fixture for name, fixture in fixtures.items() if name in signature(case).parameters})
