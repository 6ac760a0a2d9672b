"""Checks the contact of a finished job without believing its contact output.

    python -m verify.tools.contact_check job.vtkhdf [--deck job.inp] [--json report.json]

From the mesh, the deck and the displacements alone it recomputes, increment by increment, the internal forces (own
element), from them the contact force of every slave node, its distance to the master facets, and judges: Coulomb's
limit, friction against slip, penetration, tension, forces at a distance, equilibrium of every node, and the balance of
forces and moments between the surfaces and on each body. Exit code 0: all of it holds; 1: something fails; 2: usage.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from verify.independent.contact import ContactCheck, IncrementCheck
from verify.independent.deck import DeckError, read_deck
from verify.independent.results import read_results

HEADER = (
    "step    time  open stick  slip    normal     shear  friction    unused  penetrat   tension  openforc"
    "   balance    moment   equilib  bodies"
)


def check_file(path: Path, deck: Path | None = None) -> list[IncrementCheck]:
    """All increments of one result file."""
    results = read_results(path)
    text, folder = results.deck_text, path.parent
    if deck is not None:
        text, folder = deck.read_text(), deck.parent
    if text is None:
        raise DeckError("the result file holds no deck text: give --deck")
    return list(ContactCheck(read_deck(text, folder), results).run())


def print_table(checks: list[IncrementCheck]) -> None:
    """One row per increment and pair; failures below their row."""
    print(HEADER)
    for check in checks:
        for pair in check.pairs:
            counts = f"{check.step:4d} {check.time:7.4g} {pair.n_open:5d} {pair.n_stick:5d} {pair.n_slip:5d}"
            forces = f" {pair.normal_force:9.3e} {pair.shear_force:9.3e}"
            worst = [pair.friction, pair.unused, pair.penetration, pair.tension, pair.open_force]
            worst += [pair.force_balance, pair.moment_balance, check.equilibrium]
            bodies = max(check.body_force, check.body_moment)
            print(counts + forces + "".join(f" {v:9.1e}" for v in worst) + f" {bodies:7.0e}")
        for failure in check.failures:
            print(f"     FAILS: {failure}")


def summary(checks: list[IncrementCheck]) -> str:
    """One sentence."""
    failed = sum(bool(check.failures) for check in checks)
    mixed = sum(any(p.n_stick and p.n_slip for p in check.pairs) for check in checks)
    verdict = "all of it holds" if not failed else f"{failed} of them FAIL"
    return f"{len(checks)} increments checked, {mixed} with sticking and slipping nodes side by side: {verdict}."


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="Check the contact of a finished job from its displacements alone.")
    parser.add_argument("result", type=Path, help="job.vtkhdf")
    parser.add_argument("--deck", type=Path, help="the deck; default: the text stored in the result file")
    parser.add_argument("--json", type=Path, help="write all numbers to this file")
    options = parser.parse_args(arguments)
    try:
        checks = check_file(options.result, options.deck)
    except (DeckError, OSError, KeyError) as problem:
        print(f"contact_check: {problem}", file=sys.stderr)
        return 2
    print_table(checks)
    print(summary(checks))
    if options.json:
        options.json.write_text(json.dumps([check.as_dict() for check in checks], indent=1))
    return 1 if not checks or any(check.failures for check in checks) else 0


if __name__ == "__main__":
    sys.exit(main())
