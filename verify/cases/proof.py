"""What a verification case is made of: a job, checks that say all about themselves, and a page of the manual.

A case is a test. It says its model in words, runs one or more jobs, compares with theory by `near`, `within` and `order`,
and ends with `done`, which keeps its page (if `make verify` requests pages) and fails if a check failed. A test with several sets of values
makes one page, that of its first set; the other sets stand below it, with what is another in them:

    case = proof("name", title=..., model=..., formula=..., source=..., proves=...)
    job = case.run(deck, "coarse")
    case.near("peak pressure", value, expected, 0.03, why="ten elements over the half width")
    case.done()

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from verify.independent.results import Floats, Results, read_field, read_history, read_results

Run = Callable[..., subprocess.CompletedProcess[str]]
MAX_OVER_ALL = 6.0  #: the same over all cases together
#: Chapters of the index, in their order, by the file of the tests.
CHAPTERS = {
    "Patches, rigid motions, heat, joined bodies": ("test_patch_and_rigid_motion", "test_submodels"),
    "Elastic bodies": ("test_elasticity_benchmarks", "test_plane_incompatible_modes", "test_membranes", "test_thermal_stress", "test_balanced_loads"),
    "Shells and beams": ("test_shells", "test_composite_shells", "test_axisymmetric_shells", "test_beam_sections", "test_beam_benchmarks", "test_membrane_elements", "test_section_forces"),
    "Imperfections": ("test_imperfections",),
    "Plasticity, creep, damage": ("test_plasticity_and_creep", "test_rate_dependent_yield", "test_cohesive_layers",),
    "Rubber and foam": ("test_hyperelasticity",),
    "Contact: pressure and partial slip": (
        "test_contact_patch", "test_hertz", "test_plane_contact", "test_partial_slip", "test_plane_friction", "test_circular_contact",
    ),
    "Contact: sliding, free bodies, several pairs": (
        "test_sliding", "test_free_bodies", "test_loose_bodies", "test_shared_slave_nodes", "test_dependent_slaves", "test_no_separation",
    ),
    "Rigid masters": ("test_analytic_masters", "test_rigid_masters", "test_rigid_elements"),
    "Surface-to-surface contact": ("test_mortar",),
    "Default settings": ("test_default_settings",),
}  # fmt: skip
TRUE = "true"  #: what is expected of something that is so or not
EFFORT = "Newton iterations per increment"  #: quantity of the checks without a result
MAX_ITERATIONS = 8.0  #: mean of the Newton iterations per increment, failed attempts included, that a case may take


@dataclass(frozen=True)
class Check:
    """One number against another: what, where, when, how near, and why so near."""

    quantity: str
    place: str
    time: str
    reference: str  #: what is expected, as text
    ours: float
    error: float  #: difference over the scale of the quantity, or outside a band
    tolerance: float
    why: str
    order: str = ""  #: observed order of convergence, where two meshes were run

    @property
    def holds(self) -> bool:
        """Whether the check passes; a NaN or an infinite number fails."""
        return bool(self.error <= self.tolerance)

    def cells(self) -> list[str]:
        """What is expected, what came out, how far off it is and how far it may be: as the tables show it."""
        if self.reference == TRUE:
            return [TRUE, "true" if self.ours else "false", "", ""]
        if self.tolerance == 0.0:
            return [self.reference, f"{self.ours:.6g}", "inside" if self.holds else f"outside by {self.error:.1e}", ""]
        return [self.reference, f"{self.ours:.6g}", f"{self.error:.1e}", f"{self.tolerance:.0e}"]

    def sentence(self) -> str:
        """All of it, for the one who has to find out."""
        where = f" {self.place}" if self.place else ""
        when = f" at {self.time}" if self.time else ""
        return (
            f"{self.quantity}{where}{when}: {self.ours:.6g}, expected {self.reference}, "
            f"error {self.error:.2e}, allowed {self.tolerance:.0e} ({self.why})"
        )


@dataclass
class Job:
    """The results of one finished job."""

    path: Path
    name: str

    @cached_property
    def results(self) -> Results:
        """Points, times, displacements."""
        return read_results(self.path)

    @cached_property
    def history(self) -> dict[str, NDArray]:
        """One row per attempt at an increment."""
        rows = read_history(self.path)
        keep = rows["increment"] > 0
        return {name: column[keep] for name, column in rows.items()}

    @property
    def points(self) -> Floats:
        """(n, 3) nodes."""
        return self.results.points

    @property
    def times(self) -> Floats:
        """Total time of each frame, 0 first."""
        return self.results.times

    def field(self, name: str) -> Floats:
        """(frames, nodes, ...) of one field."""
        return read_field(self.path, name)

    def last(self, name: str) -> Floats:
        """(nodes, ...) of one field at the end."""
        return self.field(name)[-1]

    def integration_points(self, name: str) -> Floats:
        """(frames, points, ...) at the integration points."""
        with h5py.File(self.path) as file:
            values = file[f"AMONTONS/integration_points/{name}"][:]
        return values.reshape(len(self.times), -1, *values.shape[1:])

    def frame(self, time: float) -> int:
        """The frame at a total time."""
        found = int(np.argmin(np.abs(self.times - time)))
        assert abs(self.times[found] - time) < 1e-9 * max(1.0, time), f"there is no frame at time {time}"
        return found

    @property
    def n_increments(self) -> int:
        """Converged increments."""
        rows = self.history
        return len(set(zip(rows["step"].tolist(), rows["increment"].tolist(), strict=True)))

    @property
    def n_iterations(self) -> int:
        """Newton iterations, those of failed attempts included."""
        return int(self.history["n_iterations"].sum())

    @property
    def n_failed(self) -> int:
        """Attempts that did not converge."""
        return len(self.history["step"]) - self.n_increments

    def effort(self) -> str:
        """In words."""
        counts = {"increment": self.n_increments, "iteration": self.n_iterations, "failed attempt": self.n_failed}
        return ", ".join(f"{n} {name}{'' if n == 1 else 's'}" for name, n in counts.items())


@dataclass
class Case:
    """One page of the verification manual."""

    name: str
    title: str
    model: str  #: in words, with load and increments
    formula: str
    source: str
    proves: str
    runner: Run
    work: Path  #: where the jobs run
    pages: Path | None  #: where the page goes
    file: str = ""  #: of the test, without its suffix
    test: str = ""  #: how pytest calls it: verify/cases/contact/test_x.py::test_y[z]
    values: tuple[int, ...] = ()  #: place of its values in the tables of the test; all 0 for the first set
    checks: list[Check] = field(default_factory=list)
    jobs: list[Job] = field(default_factory=list)
    figures: list[tuple[str, str]] = field(default_factory=list)
    wanted: dict[str, int] = field(default_factory=dict)  #: increments that the decks request, by job; 0: unknown

    def run(self, deck: str, name: str = "job", requested: int = 0, threads: int = 1) -> Job:
        """Runs a deck that has to finish within the iterations allowed. requested: increments that the deck requests."""
        folder = self.work / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "job.inp").write_text(deck)
        done = self.runner(["--quiet", "job"], cwd=folder, threads=threads)
        assert done.returncode == 0, f"{name}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        job = Job(folder / "job.vtkhdf", name)
        self.jobs.append(job)
        self.wanted[job.name] = requested
        increments = requested or job.n_increments
        self.within(
            f"{EFFORT} ({name})",
            job.n_iterations / increments,
            (0.0, MAX_ITERATIONS),
            why="failed attempts are counted, and the increments are those that the deck requests",
            place="whole model",
            time="whole job",
        )
        return job

    def near(
        self,
        quantity: str,
        value: float | Floats,
        expected: float | Floats,
        tolerance: float,
        *,
        why: str,
        place: str,
        time: str,
        scale: float | None = None,
        order: str = "",
    ) -> None:
        """|value - expected| / scale at its worst place; scale is the largest expected value if none is given."""
        found, wanted = np.asarray(value, dtype=float), np.asarray(expected, dtype=float)
        size = scale or max(float(np.abs(wanted).max()), 1e-300)
        differences = np.abs(found - wanted) / size
        worst = int(np.argmax(np.where(np.isnan(differences), np.inf, differences)))
        reference, ours = (np.broadcast_to(v, differences.shape).ravel()[worst] for v in (wanted, found))
        error = float(differences.ravel()[worst])
        self.checks.append(
            Check(quantity, place, time, f"{reference:.6g}", float(ours), error, tolerance, why, order)
        )

    def within(self, quantity: str, value: float, band: tuple[float, float], *, why: str, place: str, time: str) -> None:
        """low <= value <= high; the error is how far outside it is."""
        low, high = band
        outside = max(low - value, value - high, 0.0) if math.isfinite(value) else math.inf
        reference = f"{low:.4g} to {high:.4g}" if low > 0 else f"at most {high:.4g}"
        self.checks.append(Check(quantity, place, time, reference, float(value), outside, 0.0, why))

    def true(self, quantity: str, holds: bool, *, why: str, place: str, time: str) -> None:
        """Something that is so or not."""
        self.checks.append(
            Check(quantity, place, time, TRUE, float(holds), 0.0 if holds else math.inf, 0.0, why)
        )

    def figure(self, draw: Callable[[], object], caption: str) -> None:
        """A matplotlib figure, drawn only if pages are requested."""
        if self.pages is None:
            return
        file = f"{self.name}-{len(self.figures) + 1}.png"
        self.save(draw(), self.pages / file)
        self.figures.append((file, caption))

    def save(self, figure: object, path: Path) -> None:
        """As a PNG of 128 colours: there are many of them, and they are kept."""
        import io

        from PIL import Image

        store = io.BytesIO()
        figure.savefig(store, dpi=90, bbox_inches="tight", metadata={"Software": None})
        Image.open(store).convert("RGB").quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)

    def done(self) -> None:
        """Keeps what the pages need, with a picture of the last job if the case drew none and begins a page, and judges."""
        if self.pages is not None:
            if self.jobs and not self.figures and not any(self.values):
                from verify.tools import picture

                figure, caption = picture.shape(self.jobs[-1].path)
                self.figure(lambda: figure, f"Job \"{self.jobs[-1].name}\": {caption}" if len(self.jobs) > 1 else caption)
            (self.pages / f"{self.name}.json").write_text(json.dumps(self.facts(), indent=1) + "\n")
        failed = [check.sentence() for check in self.checks if not check.holds]
        assert not failed, "\n".join(failed)

    def facts(self) -> dict:
        """What page and index show."""
        words = {name: getattr(self, name) for name in ("name", "title", "model", "formula", "source", "proves", "file", "test", "figures", "values")}
        effort = {"effort": [(job.n_increments, job.n_iterations, job.n_failed) for job in self.jobs],
                  "requested": [self.wanted.get(job.name) or job.n_increments for job in self.jobs],
                  "said": "; ".join(f"{job.name}: {job.effort()}" for job in self.jobs)}  # fmt: skip
        return words | effort | {"checks": [asdict(check) for check in self.checks]}


def found(case: dict) -> list[str]:
    """Checks, pictures and effort of a case."""
    checks = [Check(**c) for c in case["checks"]]
    parts = [check_table([c for c in checks if not (c.quantity.startswith(EFFORT) and c.holds)])]
    parts += [f"![{caption}]({file})\n\n*{caption}*" for file, caption in case["figures"]]
    return [*parts, f"Effort: {case['said']}."] if case["said"] else parts


def page(cases: Sequence[dict]) -> str:
    """The page of a test in Markdown: its first case, then of each other one what differs."""
    first = cases[0]
    parts = [f"# {first['title']}", first["model"], "## What is expected", first["formula"], f"Source: {first['source']}"]
    parts += ["## What was found", *found(first)]
    if first["said"]:
        parts += [f"More than {MAX_ITERATIONS:g} iterations for each increment that the deck requests, failed attempts included, would fail the case."]
    parts += ["## What it proves", first["proves"]]
    if first["test"]:
        parts += [f"`make verify` writes this page; `.venv/bin/python -m pytest '{first['test']}'` runs this case alone."]
    if len(cases) > 1:
        parts += ["## The same with other values"]
    titles = [case["title"] for case in cases]
    for case in cases[1:]:
        values = case["test"].partition("[")[2].removesuffix("]").replace("\n", " ")
        parts += [f"### {case['title']}" + (f": {values}" if titles.count(case["title"]) > 1 and values else "")]
        parts += [case[name] for name in ("model", "formula", "proves") if case[name] != first[name]] + found(case)
    return "\n\n".join(parts) + "\n"


def write_pages(pages: Path, cases: Sequence[dict]) -> None:
    """A page for each test, named after its first case; every case learns its page. What cases without a page of their own left before goes."""
    tests: dict[str, list[dict]] = {}
    for case in cases:
        tests.setdefault(case["test"].partition("[")[0] or case["name"], []).append(case)
    for group in tests.values():
        group.sort(key=lambda case: (case["values"], case["name"]))
        for case in group:
            case["page"] = group[0]["name"]
            (pages / f"{case['name']}.md").unlink(missing_ok=True)
        (pages / f"{group[0]['name']}.md").write_text(page(group))
    kept = {file for case in cases for file, _ in case["figures"]}
    for case in cases:
        for picture in pages.glob(f"{case['name']}-*.png"):
            if re.fullmatch(r"\d+", picture.stem.removeprefix(f"{case['name']}-")) and picture.name not in kept:
                picture.unlink()


def check_table(checks: Sequence[Check]) -> str:
    """A row per check."""
    rows = [
        "| quantity | place | time | expected | ours | error | allowed | order | why this tolerance |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for c in checks:
        rows.append("| " + " | ".join([c.quantity, c.place, c.time, *c.cells(), c.order, c.why]) + " |")
    return "\n".join(rows)


def observed_order(errors: Sequence[float], ratio: float = 2.0) -> float:
    """From the errors of two meshes, the second `ratio` times finer."""
    return math.log(errors[0] / errors[1]) / math.log(ratio)


def effort_table(cases: Sequence[dict]) -> list[str]:
    """A row per case: requested increments, iterations, failed attempts; and the mean over all cases."""
    lines = ["| case | requested increments | Newton iterations | failed attempts | iterations per increment |", "|---|---|---|---|---|"]
    rows = []
    for case in cases:
        if not case["effort"]:
            continue
        requested, iterations, failed = sum(case["requested"]), sum(e[1] for e in case["effort"]), sum(e[2] for e in case["effort"])
        rows.append((requested, iterations, failed))
        lines.append(f"| [{case['title']}]({case['page']}.md) | {requested} | {iterations} | {failed} | {iterations / max(requested, 1):.1f} |")
    requested, iterations, failed = (sum(row[i] for row in rows) for i in range(3))
    return [*lines, f"| all | {requested} | {iterations} | {failed} | {iterations / max(requested, 1):.1f} |"]


def mean_effort(cases: Sequence[dict]) -> float:
    """Newton iterations per requested increment, failed attempts included, over all cases."""
    requested, iterations = sum(sum(case["requested"]) for case in cases), sum(e[1] for case in cases for e in case["effort"])
    return iterations / max(requested, 1)


def chapter_of(case: dict) -> str:
    """Where a case stands in the index."""
    return next((chapter for chapter, files in CHAPTERS.items() if case.get("file") in files), "Other cases")


def index_rows(case: dict) -> list[str]:
    """A row of the index for each quantity of a case: the check that is nearest to what is allowed. The effort has a table of its own."""
    worst: dict[str, dict] = {}
    for c in case["checks"]:
        name = c["quantity"]
        if name.startswith(EFFORT):
            continue
        near = c["error"] / c["tolerance"] if c["tolerance"] else c["error"]
        if name not in worst or near > worst[name]["near"]:
            worst[name] = c | {"near": near, "order": c["order"] or worst.get(name, {}).get("order", "")}
        elif c["order"]:
            worst[name]["order"] = c["order"]
    rows, title = [], f"[{case['title']}]({case['page']}.md)"
    for name, c in worst.items():
        mark = "" if all(o["error"] <= o["tolerance"] for o in case["checks"] if o["quantity"] == name) else " **fails**"
        reference, ours, error, allowed = Check(**{key: value for key, value in c.items() if key != "near"}).cells()
        rows.append(f"| {title} | {name}, {c['place']} | {reference} | {ours} | {error}{mark} | {allowed} | {c['order']} |")
        title = ""
    return rows


def chapter_table(chapters: dict[str, list[dict]]) -> list[str]:
    """A row per chapter: cases, checks, and how many of the checks are against a number that is known to 1 % or better."""
    lines = ["| chapter | cases | checks | of them to 1 % or better |", "|---|---|---|---|"]
    for chapter, cases in chapters.items():
        checks = [c for case in cases for c in case["checks"] if not c["quantity"].startswith(EFFORT)]
        anchor = re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", chapter).strip().lower())
        if cases:
            lines.append(f"| [{chapter}](#{anchor}) | {len(cases)} | {len(checks)} | {sum(0.0 < c['tolerance'] <= 0.01 for c in checks)} |")
    return [*lines, ""]


def write_index(pages: Path) -> float:
    """Pages and index.md from the .json files of the cases, which it takes away; a row per check. Gives the mean effort."""
    files = sorted(pages.glob("*.json"))
    cases = [json.loads(file.read_text()) for file in files]
    write_pages(pages, cases)
    has_decks = (pages / "calculix-decks.md").exists()
    n_increments, n_iterations, n_failed = (sum(e[i] for c in cases for e in c["effort"]) for i in range(3))
    failing = sum(c["error"] > c["tolerance"] for case in cases for c in case["checks"])
    lines = [
        "# Verification",
        "",
        "Written by `make verify`; each case is a test in `verify/cases`. A test has a page: the model in words, the formula and its source,",
        "every check with its place, time, tolerance and why, a picture, and what it proves; then the checks of its other cases, with other",
        "elements, meshes or numbers. Below, for each quantity of a case the check that is",
        "nearest to what is allowed. Error: the difference over the largest expected value, or whether a number is inside its band. Order: of",
        "convergence, observed on two or more meshes.",
        "",
        f"{len(cases)} cases, {sum(len(c['checks']) for c in cases)} checks, of which {failing or 'none'} fail{'' if failing > 1 else 's'}; {n_increments} increments, {n_iterations} Newton",
        f"iterations ({n_iterations / max(n_increments, 1):.2f} per increment), {n_failed} failed attempt{'' if n_failed == 1 else 's'}. An",
        "iteration linearises the bodies once; contact and friction are solved within it ([theory](../theory/newton.md#contact-subproblem-contact_subproblem-solve_contact_subproblem)), so that elastic bodies at small",
        "displacements often need one.",
        "",
        *(["The decks of CalculiX's own suite have [a page of their own](calculix-decks.md).", ""] * has_decks),
    ]
    chapters = {chapter: [case for case in cases if chapter_of(case) == chapter] for chapter in [*CHAPTERS, "Other cases"]}
    lines += chapter_table(chapters)
    for chapter, within in chapters.items():
        rows = [row for case in within for row in index_rows(case)]
        if rows:
            head = ["| case | quantity | reference | ours | error | allowed | order |", "|---|---|---|---|---|---|---|"]
            lines += [f"## {chapter}", "", *head, *rows, ""]
    lines += ["## Effort", "", *effort_table(cases)]
    (pages / "index.md").write_text("\n".join(lines) + "\n")
    for file in files:
        file.unlink()
    return mean_effort(cases)
