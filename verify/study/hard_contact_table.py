"""Hard contact problems by class with default settings: what finishes, at what cost, and what checks it. Prints a table.

    python -m verify.study.hard_contact_table [--classes a b c] [--only clip] [--second 5] [--seconds 120] [--runs runs.csv]
        [--forms nodes faces] [--ccx 20] [--finer 10] [--program bin/amontons]
    python -m verify.study.hard_contact_table --show runs.csv


Each problem runs by nodes and by faces, for some seconds of a processor at most. --second N runs a second set, with parameters at random: N seeds of
each problem; nothing is tuned to it. Where statics has no answer a problem of the classes a, b, d and f runs again with STABILIZE, then by inertia
(QUASI-STATIC). The check is the balance of loads, reactions and the contact forces on each body, Coulomb's limit at each slave node, and a reaction in
closed form where there is one. With --ccx CalculiX runs each problem too, for so many seconds, with a contact stiffness of 50 E and a stick slope of
5 E; where it ends, the problem runs here once more with CalculiX's laws of materials (its dialect) but exact contact, and the largest difference of
the reactions of a body at the end, over the largest reaction of the job, stands beside its iterations. --finer N: increments N times as short, of both. The last table has the shares of the time by
phase: contact is search, rows, their evaluation and derivatives; factor and krylov are the linear systems, those of the contact subproblem included;
assembly is the bulk.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np

from verify.decks.hard_contact import Draw, Problem, problems
from verify.decks.loose_bodies import by_inertia
from verify.independent.results import point_data
from verify.study.ironing_table import ROOT, count_rows
from verify.study.runs import execute, read_runs, run_limited, write_runs

FORMS = {"nodes": "", "faces": ", TYPE=SURFACE TO SURFACE"}
REMEDIES = {"": lambda deck: deck, "STABILIZE": lambda deck: deck.replace("*STATIC\n", "*STATIC, STABILIZE\n"),
            "QUASI-STATIC": lambda deck: by_inertia(deck, "1e-3, 1., 1e-9, 0.05")}
PHASES = ("contact", "factor", "krylov", "assembly")
DAMPING = 1e-3  #: the same where STABILIZE or inertia act on a body that still moves
TOLERANCE = 1e-4  #: of a balance, over the sum of absolute forces: Newton's tolerance is 1e-6 of the largest


@dataclass(frozen=True)
class Run:
    """One run, as it stands in the file of runs."""

    group: str
    problem: str
    seed: int  #: 0: the first set
    form: str
    by: str  #: the remedy, empty: statics
    outcome: str  #: finished, or why not
    made: int  #: increments
    failed: int  #: attempts
    iterations: int  #: those of failed attempts included
    seconds: float  #: of the processor
    check: str
    peer: str = "-"  #: CalculiX: its iterations and the difference of the reactions, or why not
    phases: str = ""  #: seconds of PHASES and of the whole job

    @property
    def case(self) -> tuple[str, str, int, str]:
        """What is run."""
        return self.group, self.problem, self.seed, self.form


def check(problem: Problem, by: str, file: Path) -> str:
    """What the last state of a result file violates; `balance`, or `closed form`, if it is right; with the forces of damping, if there are any."""
    with h5py.File(file) as results:
        grid = results["VTKHDF"]
        reaction, normal, shear = (point_data(grid, name)[-1] for name in ("RF", "CNORMF", "CSHEARF"))
    loads = np.zeros(3)
    loads[: len(problem.loads)] = problem.loads
    scale = np.abs(reaction).sum() + np.nansum(np.abs(loads)) + np.abs(normal).sum()
    if not scale > 0.0:
        return "NO FORCE"
    rest = np.nanmax(np.abs(reaction.sum(axis=0) + loads)[: len(problem.loads)])
    if rest > (DAMPING if by else TOLERANCE) * scale:
        return "FORCES"
    p, t = np.linalg.norm(normal, axis=1), np.linalg.norm(shear, axis=1)
    if (t - problem.mu * p).max() > TOLERANCE * p.max():
        return "FRICTION"
    if problem.reaction is None:
        return f"balance, damping {100 * rest / scale:.2g} %" if rest > TOLERANCE * scale else "balance"
    name, direction, value, tolerance = problem.reaction
    members = [int(label) - 1 for label in re.findall(r"\d+", _node_set(problem.deck, name))]
    return "closed form" if abs(reaction[members, direction - 1].sum() / value - 1) <= tolerance else "CLOSED FORM"


def peer_deck(deck: str, form: str) -> str:
    """The deck for CalculiX: a contact stiffness of 50 E of the stiffest body, a stick slope of 5 E, the reactions of each body."""
    young = max([3.0, *(float(value) for value in re.findall(r"\*ELASTIC\n([^,]+),", deck))])
    behavior = f"{50 * young:g}" + (f", {1e-3 * young:g}, 1e-3" if form == "nodes" else "")
    deck = re.sub(r"(\*SURFACE INTERACTION, NAME=\S+\n)", rf"\1*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{behavior}\n", deck)
    deck = re.sub(r"\*FRICTION\n(\S+)\n", rf"*FRICTION\n\1, {5 * young:g}\n", deck)
    if form == "nodes":
        deck = re.sub(r"(\*CONTACT PAIR, INTERACTION=\S+)", r"\1, TYPE=NODE TO SURFACE", deck)
    prints = "".join(f"*NODE PRINT, NSET={name}, TOTALS=ONLY, FREQUENCY=1000\nRF\n" for name in re.findall(r"\*NODE, NSET=(\S+)", deck))
    return deck.replace("*END STEP", f"{prints}*END STEP")


def compare(program: Path, problem: Problem, form: str, file: Path, seconds: float) -> str:
    """CalculiX on the same problem: its iterations, and the difference from a run here with its laws of materials."""
    if "*RIGID BODY" in problem.deck:   # CalculiX turns a rigid body by a further node and has its reaction at the nodes of the body
        return "-"
    folder = file.with_suffix("")
    folder.mkdir(exist_ok=True)
    (folder / "job.inp").write_text(peer_deck(problem.deck, form))
    ccx = shutil.which("ccx")
    assert ccx is not None, "ccx is not in the path"
    _, spent = run_limited([ccx, "-i", "job"], seconds, folder, timeout=20 * seconds)
    rows = [line.split() for line in (folder / "job.sta").read_text().splitlines()[2:]] if (folder / "job.sta").exists() else []
    ended = {row[0]: float(row[5]) for row in rows}
    if len(ended) < problem.deck.count("*STEP") or any(abs(time - 1) > 1e-6 for time in ended.values()):
        return f"no end in {seconds:g} s" if spent >= seconds - 1 else "ends early"
    words = ", TYPE=NODE TO SURFACE" if form == "nodes" else ""
    deck = "** dialect: calculix\n" + re.sub(r"(\*CONTACT PAIR, INTERACTION=\S+)", rf"\1{words}", problem.deck)
    is_done, _ = execute(program, folder, "ours", deck, seconds)
    return f"{sum(int(row[3]) for row in rows)} iterations, {difference(problem.deck, folder) if is_done else 'no end here'}"


def difference(deck: str, folder: Path) -> str:
    """The largest difference of the reactions of a body at the end, over the largest of the job."""
    found = re.findall(r"for set (\S+) and time\s+\S+\s+(\S+)\s+(\S+)\s+(\S+)", (folder / "job.dat").read_text())
    theirs = {name: np.array([float(value) for value in values]) for name, *values in found}  # the last of each set
    with h5py.File(folder / "ours.vtkhdf") as results:
        reaction = np.array(point_data(results["VTKHDF"], "RF"))
    (folder / "ours.vtkhdf").unlink()
    first = [int(label) for label in re.findall(r"\*NODE, NSET=\S+\n(\d+)", deck)]
    labels = [int(label) for part in re.findall(r"\*NODE, NSET=\S+\n([^*]+)", deck) for label in re.findall(r"^(\d+),", part, re.MULTILINE)]
    bounds = [*(labels.index(label) for label in first), len(labels)]
    ours = {name.upper(): reaction[:, bounds[i] : bounds[i + 1]].sum(axis=1) for i, name in enumerate(re.findall(r"\*NODE, NSET=(\S+)", deck))}
    largest = max(float(np.linalg.norm(value, axis=1).max()) for value in ours.values())
    return f"{100 * max(float(np.linalg.norm(theirs[name] - value[-1])) for name, value in ours.items()) / max(largest, 1e-30):.1f} %"


def _node_set(deck: str, name: str) -> str:
    """The labels of a node set of the deck, one by one."""
    body = re.search(rf"\*NSET, NSET={name}(, GENERATE)?\n([^*]*)", deck)
    assert body is not None
    if body[1]:
        first, last = re.findall(r"\d+", body[2])[:2]
        return " ".join(str(k) for k in range(int(first), int(last) + 1))
    return body[2]


def reason(folder: Path, name: str, spent: float, seconds: float) -> str:
    """Why a run did not finish."""
    if spent >= seconds - 1:
        return f"no end in {seconds:g} s"
    text = (folder / f"{name}.log").read_text() if (folder / f"{name}.log").exists() else ""
    found = re.search(r"\*ERROR: .*?: ([A-Z ]{6,}):", text)
    return found[1] if found else "error"


def refine(deck: str, finer: int) -> str:
    """The same deck with increments so many times as short."""
    return re.sub(r"(?<=\*STATIC\n)(\S+), 1\., 1e-6, \1", lambda found: "{0:.10g}, 1., 1e-6, {0:.10g}".format(float(found[1]) / finer), deck)


def run(program: Path, folder: Path, case: tuple[str, str, int, str], seconds: float, peer_seconds: float, finer: int = 1) -> Run:
    """Runs one problem; classes a, b and d by their remedies too. CalculiX runs it if it is given time."""
    group, title, seed, form = case
    problem = problems()[group][title](Draw(f"{title} {seed}" if seed else ""), FORMS[form])
    problem = replace(problem, deck=refine(problem.deck, finer))
    n_steps = problem.deck.count("*STEP")
    for by in REMEDIES if group in "abdf" else [""]:
        name = re.sub(r"\W+", "_", f"{group} {title} {seed} {form} {by}").strip("_").lower()
        is_done, spent = execute(program, folder, name, REMEDIES[by](problem.deck), seconds, is_logged=True)
        counts = count_rows(folder / f"{name}.sta", n_steps, is_done)
        outcome = "finished" if is_done else reason(folder, name, spent, seconds)
        file = folder / f"{name}.vtkhdf"
        made = Run(*case, by, outcome, counts.made, counts.failed, counts.iterations, round(spent, 1), check(problem, by, file) if is_done else "-",
                   compare(program, problem, form, file, peer_seconds) if is_done and peer_seconds else "-", phases(file) if is_done else "")
        (folder / f"{name}.vtkhdf").unlink(missing_ok=True)
        if is_done:
            break
    return made


def phases(file: Path) -> str:
    """The seconds of PHASES and of the whole job."""
    with h5py.File(file) as results:
        spent = dict(zip(results["AMONTONS/phases"].asstr()[()], results["AMONTONS/history/seconds"][()].sum(axis=0), strict=True))
    return " ".join(f"{value:.3g}" for value in [*(spent[name] for name in PHASES), sum(spent.values())])


def head(*words: str) -> Iterator[str]:
    """The first two lines of a table in Markdown."""
    yield "| " + " | ".join(words) + " |"
    yield "|---" * len(words) + "|"


def show(runs: list[Run]) -> str:
    """The tables of both sets, and how many of each class finish with a right check."""
    lines = []
    for is_second in (False, True):
        made = [r for r in runs if (r.seed > 0) == is_second]
        if not made:
            continue
        lines += ["", "The second set" if is_second else "The first set", ""]
        lines += head("class", "problem", "contact by", "outcome", "increments", "failed attempts", "iterations", "seconds", "check", "CalculiX")
        for r in made:
            title = f"{r.problem}, seed {r.seed}" if r.seed else r.problem
            outcome = r.outcome + (f" by {r.by}" if r.by and r.outcome == "finished" else "")
            lines.append(f"| {r.group} | {title} | {r.form} | {outcome} | {r.made} | {r.failed} | {r.iterations} | {r.seconds:g} | {r.check} | {r.peer} |")
        lines += ["", *head("class", "contact by", "finished and right", "failed attempts", "iterations where both finish", "seconds where both finish")]
        for group in dict.fromkeys(r.group for r in made):
            lines += _sums([r for r in made if r.group == group])
        if len({r.form for r in made}) > 1:
            lines += ["", *ratios(made)]
        lines += ["", *shares(made)]
    return "\n".join(lines)


def _sums(runs: list[Run]) -> Iterator[str]:
    """A line for each formulation of a class."""
    right = {r.case for r in runs if r.outcome == "finished" and r.check == r.check.lower()}
    both = {case[:3] for case in right if all((*case[:3], form) in right for form in FORMS)}
    for form in dict.fromkeys(r.form for r in runs):
        own = [r for r in runs if r.form == form]
        shared = [r for r in own if r.case[:3] in both]
        yield (f"| {own[0].group} | {form} | {sum(r.case in right for r in own)} of {len(own)} | {sum(r.failed for r in own)} "
               f"| {sum(r.iterations for r in shared)} | {sum(r.seconds for r in shared):.0f} |")


def ratios(runs: list[Run]) -> Iterator[str]:
    """Faces over nodes, of each class: the sums of iterations and seconds where both finish, and the largest ratio of a problem that takes seconds, with its name."""
    yield from head("class", "problems", "iterations, faces over nodes", "seconds, faces over nodes", "largest ratio of iterations", "of seconds, from 1 s by faces on")
    by_case = {r.case: r for r in runs if r.outcome == "finished" and r.check == r.check.lower()}
    both = [(r, by_case[*r.case[:3], "faces"]) for r in by_case.values() if r.form == "nodes" and (*r.case[:3], "faces") in by_case]
    for group in [*dict.fromkeys(n.group for n, _ in both), *(["all"] if both else [])]:
        own = [(n, f) for n, f in both if group in (n.group, "all")]
        iterations = [f.iterations / max(n.iterations, 1) for n, f in own]
        seconds = [(f.seconds / max(n.seconds, 0.1), n.problem) for n, f in own if f.seconds >= 1]
        yield (f"| {group} | {len(own)} | {sum(f.iterations for _, f in own) / max(sum(n.iterations for n, _ in own), 1):.2f} "
               f"| {sum(f.seconds for _, f in own) / max(sum(n.seconds for n, _ in own), 0.1):.2f} | {max(iterations):.2f} "
               f"| {'{:.2f}, {}'.format(*max(seconds)) if seconds else '-'} |")


def shares(runs: list[Run]) -> Iterator[str]:
    """The share of each phase in the time of a class, by formulation."""
    yield from head("class", "contact by", *(f"{name} [%]" for name in PHASES))
    for group, form in dict.fromkeys((r.group, r.form) for r in runs if r.phases):
        *parts, whole = np.sum([[float(word) for word in r.phases.split()] for r in runs if r.phases and (r.group, r.form) == (group, form)], axis=0)
        yield f"| {group} | {form} | " + " | ".join(f"{100 * part / whole:.0f}" for part in parts) + " |"


def main() -> int:
    """Runs the requested problems, or shows the tables of a file of runs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--classes", nargs="+", choices=list(problems()), default=list(problems()))
    parser.add_argument("--only", default="", help="problems whose name contains this")
    parser.add_argument("--forms", nargs="+", choices=list(FORMS), default=list(FORMS))
    parser.add_argument("--second", type=int, default=0, metavar="N", help="the second set: N seeds of each problem")
    parser.add_argument("--seconds", type=float, default=120.0, help="most time of a processor for one run")
    parser.add_argument("--ccx", type=float, default=0.0, metavar="SECONDS", help="run CalculiX too, so long at most")
    parser.add_argument("--finer", type=int, default=1, metavar="N", help="increments N times as short")
    parser.add_argument("--runs", type=Path, help="file in which the runs are kept; runs made again take the place of the old ones")
    parser.add_argument("--show", type=Path, metavar="FILE", help="print the tables of a file of runs")
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--outdir", type=Path)
    options = parser.parse_args()
    if options.show:
        print(show(read_runs(options.show, Run)))
        return 0
    folder = options.outdir or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    kept = {r.case: r for r in read_runs(options.runs, Run)} if options.runs and options.runs.exists() else {}
    made = {}
    for group in options.classes:
        for title in problems()[group]:
            for seed in range(1, options.second + 1) if options.second else [0]:
                for form in options.forms:
                    if options.only not in title:
                        continue
                    r = made[group, title, seed, form] = run(options.program.resolve(), folder, (group, title, seed, form), options.seconds, options.ccx,
                                                        options.finer)
                    print(*r.case, r.by, r.outcome, r.made, r.failed, r.iterations, f"{r.seconds:g} s", r.check, "CalculiX:", r.peer, file=sys.stderr, flush=True)
                    if options.runs:
                        write_runs(options.runs, (kept | made).values())
    print(show(list(made.values())))
    return 0


if __name__ == "__main__":
    sys.exit(main())
