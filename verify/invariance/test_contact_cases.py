"""Cases of the verification, of the manual and of input/, written differently: other units, turned, renumbered, shuffled, two threads, twice,
through the library and resumed in the middle.

Short cases are rewritten in all these ways. Of the others each takes one system of units and one other way, by turns; all of them with
AMONTONS_EVERY_CASE. All fields at all nodes of the deck are compared, at all times, and the iterations of each step.

The deck of a case is taken from the case itself: its first one, before anything is run.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import importlib
import os
import re
from collections.abc import Callable
from functools import partial
from inspect import signature
from pathlib import Path

import pytest
from _pytest.mark import ParameterSet

import amontons
from verify.cases.contact import test_default_settings, test_mortar, test_sliding
from verify.cases.proof import Job
from verify.conftest import ROOT, Run
from verify.invariance.comparison import SYSTEMS, InUnits, View, same
from verify.invariance.scaling import Units, renumbered, rotation, scaled, shuffled, turned
from verify.library import common
from verify.study import contact_table


class TakenError(Exception):
    """The deck was taken."""


def deck_of_case(module: str, function: str, changes: dict[str, object] | None = None, **values: object) -> str:
    """The first deck of a verification case. changes: constants of its module, so that a large case becomes a small one."""
    taken: list[str] = []

    class Thief:
        """A case that runs nothing."""

        def run(self, deck: str, *_: object, **__: object) -> None:
            taken.append(deck)
            raise TakenError

        def __getattr__(self, name: str) -> Callable[..., None]:
            return lambda *_, **__: None

    home = importlib.import_module(f"verify.cases.{module}")
    case = getattr(home, function)
    fixtures = {"proof": lambda *_, **__: Thief(), "run_deck": Thief().run, "tmp_path": None, "run": None}
    values |= {name: fixture for name, fixture in fixtures.items() if name in signature(case).parameters}
    with pytest.MonkeyPatch.context() as patch, pytest.raises(TakenError):
        for name, value in (changes or {}).items():
            patch.setattr(home, name, value)
        case(**values)
    return taken[0]


def deck_of_file(name: str) -> str:
    """A deck of the repository, its mesh put in."""
    path = ROOT / name
    text = path.read_text()
    for line in text.splitlines():
        if line.upper().startswith("*INCLUDE"):
            text = text.replace(line, (path.parent / line.split("=")[1].strip()).read_text().rstrip())
    return text


def default_deck(name: str) -> str:
    """A deck of those that run with default settings."""
    return deck_of_case("contact.test_default_settings", "test_defaults", make=getattr(test_default_settings, name))


def in_dialect(deck: str, text: str) -> str:
    """The same deck written differently, in its dialect: the cards alone were rewritten."""
    return "".join(re.findall(r"^\*\*\s*dialect.*\n", deck, flags=re.M)) + text


def shorter(deck: str, by: float) -> str:
    """The deck with shorter first and largest increments: no attempt fails then, so that all runs have the same increments."""

    def cut(card: re.Match[str]) -> str:
        numbers = [number.strip() for number in card[2].split(",")]
        numbers[::3] = [repr(float(number) / by) for number in numbers[::3]]
        return card[1] + ", ".join(numbers)

    return re.sub(r"(\*STATIC[^\n]*\n)([^\n]*)", cut, deck)


#: Loading and one reversal, in half of the increments.
MINDLIN = [("loaded", (0.023, 5)), ("reversed", (-0.010, 5))]
CASES: dict[str, Callable[[], str]] = {
    "three cubes": lambda: deck_of_file("input/three_cubes.inp"),
    "example contact": lambda: deck_of_file("doc/manual/examples/contact.inp"),
    "example interference": lambda: deck_of_file("doc/manual/examples/interference.inp"),
    "patch": lambda: deck_of_case("contact.test_contact_patch", "test_matching", mu=0.5),
    "patch, 3 on 4": lambda: deck_of_case("contact.test_contact_patch", "test_not_matching", upper=3, lower=4),
    "patch by mortar": lambda: deck_of_case("contact.test_mortar", "test_plane_patch", kinds=("CPE8", "CPE8")),
    "patch of rings": lambda: deck_of_case("contact.test_plane_contact", "test_patch", kind="CAX4", inner=1.0),
    "slope": lambda: test_sliding.slope_deck(0.29, True),
    "slope in the plane": lambda: deck_of_case("contact.test_plane_friction", "test_block_on_a_slope"),
    "drawn slab": lambda: deck_of_case("contact.test_plane_friction", "test_drawn_slab", kind="CPE4"),
    "pull-out of rings": lambda: deck_of_case("contact.test_plane_friction", "test_pull_out"),
    "quarter of a fit": lambda: deck_of_case("contact.test_sliding", "test_shrink_fit_quarter"),
    "chain": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_chain", kind="CPE4", form=""),
    "corner": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_corner", angle=25.0, form=""),
    "symmetric pair": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_symmetric_pair", mu=0.2, is_nlgeom=False),
    "Hertz line": lambda: deck_of_case("contact.test_hertz", "test_nafems_r0094_1"),
    "Hertz line in the plane": lambda: deck_of_case("contact.test_plane_contact", "test_hertz_line", kind="CPE4"),
    "Hertz axisymmetric": lambda: deck_of_case("contact.test_plane_contact", "test_hertz_axisymmetric"),
    "Spence": lambda: deck_of_case("contact.test_partial_slip", "test_spence", nu=0.3, mu=0.3, expected=0.69),
    "Spence in the plane": lambda: deck_of_case("contact.test_plane_contact", "test_flat_punch"),
    "Spence over a circle": lambda: deck_of_case("contact.test_circular_contact", "test_flat_punch", nu=0.3, mu=0.2, kind="C3D8"),
    "flat punch": lambda: deck_of_case("contact.test_partial_slip", "test_flat_punch"),
    "rounded punch": lambda: deck_of_case("contact.test_plane_friction", "test_rounded_punch"),
    "Mindlin in the plane": lambda: deck_of_case("contact.test_plane_contact", "test_cattaneo_mindlin"),
    "Mindlin's balls": lambda: deck_of_case("contact.test_circular_contact", "test_cattaneo_mindlin_balls", {"FINE": 0.4}),
    "reversal": lambda: deck_of_case("contact.test_sliding", "test_reversal"),
    "shrink fit": lambda: deck_of_case("contact.test_sliding", "test_shrink_fit"),
    "turning block": lambda: deck_of_case("contact.test_sliding", "test_stuck_block_turns", degrees=10.0),
    "ironing in the plane": lambda: deck_of_case("contact.test_plane_contact", "test_ironing_equals_solids", mu=0.3),
    "analytic cylinder": lambda: deck_of_case("contact.test_analytic_masters", "test_hertz", kind="CPE4"),
    "analytic ball around an axis": lambda: deck_of_case("contact.test_analytic_masters", "test_hertz", kind="CAX4"),
    "analytic slope": lambda: deck_of_case("contact.test_analytic_masters", "test_block_slides_on_inclined_plane"),
    "analytic table tilts": lambda: shorter(deck_of_case("contact.test_analytic_masters", "test_tilting_table"), 2),
    "analytic roller turns": lambda: deck_of_case("contact.test_analytic_masters", "test_turning_roller"),
    "analytic profile drawn out": lambda: deck_of_case("contact.test_analytic_masters", "test_drawn_equals_flat"),
    "fall in the plane": lambda: deck_of_case("contact.test_free_bodies", "test_fall", dimension=2, gap=0.9),
    "fall in space": lambda: deck_of_case("contact.test_free_bodies", "test_fall", dimension=3, gap=0.01),
    "disc between plates": lambda: deck_of_case("contact.test_free_bodies", "test_disc_between_plates"),
    "pushed to a wall": lambda: deck_of_case("contact.test_free_bodies", "test_pushed_to_a_wall"),
    "rigid indenter": lambda: deck_of_case("contact.test_rigid_masters", "test_indentation_by_a_rigid_body"),
    "rigid body turns": lambda: deck_of_case("contact.test_rigid_masters", "test_turning_rigid_body"),
    "patch by mortar in space": lambda: deck_of_case("contact.test_mortar", "test_patch", name=next(iter(test_mortar.PATCHES))),
    "reversal by mortar": lambda: deck_of_case("contact.test_mortar", "test_reversal"),
    "turning block by mortar": lambda: deck_of_case("contact.test_mortar", "test_stuck_block_turns", degrees=10),
    "Hertz by mortar": lambda: deck_of_case("contact.test_mortar", "test_hertz_point"),
    "bent over an edge by mortar": lambda: deck_of_case("contact.test_mortar", "test_bent_over_edge"),
    "stack": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_stacked_blocks"),
    "corner of three walls": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_corner_of_three_walls"),
    "groove": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_groove", form=""),
    "coarse side first": lambda: deck_of_case("contact.test_shared_slave_nodes", "test_coarse_side_first"),
    "lap of rings": lambda: deck_of_case("contact.test_plane_contact", "test_lap_of_rings"),
    "capstan": lambda: deck_of_case("contact.test_sliding", "test_capstan"),
    "no separation": lambda: deck_of_case("contact.test_no_separation", "test_friction_of_a_dragged_block", kind="surfaces"),
    "heel in tension": lambda: deck_of_case("contact.test_no_separation", "test_heel_in_tension", kind="nodes", solver=""),
    "block dragged at once": lambda: deck_of_case("contact.test_sliding", "test_dragged_at_once", what="block", make=contact_table.drag, mu=0.3, steps=2),
    "cylinder dragged at once": lambda: deck_of_case("contact.test_sliding", "test_dragged_at_once", what="cylinder", make=contact_table.cylinder, mu=1.0, steps=3),
    "cubes under a law": lambda: deck_of_case("contact.test_sliding", "test_cubes_under_a_law", slope=1e8, stick=1e7),
    "Prandtl's punch": lambda: deck_of_case("inelastic.test_plasticity_and_creep", "test_prandtl_punch"),
    "prescribed motion": lambda: deck_of_case("contact.test_sliding", "test_prescribed_motion_of_slaves"),
    "Mindlin in space": lambda: deck_of_case("contact.test_partial_slip", "test_cattaneo_mindlin", {"TURNS": MINDLIN}),
    **{f"defaults, {name}": partial(default_deck, name) for name in ("pin_in_bush", "cold_fit", "gaskets", "in_a_corner", "wedge")},
}
#: Without contact, the examples of the manual, and a larger deck of input/: in other units only. Its shear block and ironing are "three cubes" and
#: "ironing in the plane" on more elements.
EXAMPLES = ("assembly", "bar", "bolt", "constraints", "changes", "grid", "inelastic", "layers", "parts", "plane_bending", "rate_dependent", "rubber", "sector", "springs")
OTHERS: dict[str, Callable[[], str]] = {
    **{f"example {name}": partial(deck_of_file, f"doc/manual/examples/{name}.inp") for name in EXAMPLES},
    "Hertz octant": lambda: deck_of_file("input/hertz_octant.inp"),
    "thick cylinder": lambda: deck_of_case("elastic.test_elasticity_benchmarks", "test_thick_cylinder", kind="C3D20R", tolerance=1.0, order=1.0),
    "LE10": lambda: deck_of_case("elastic.test_elasticity_benchmarks", "test_le10", kind="C3D10", tolerance=1.0),
    "LE11": lambda: deck_of_case("elastic.test_thermal_stress", "test_le11", kind="CAX8", cells=(2, 4), tolerance=1.0),
    "points on faces edge on edge": lambda: deck_of_case("contact.test_contact_integration_points", "test_what_nodes_show", order=20),
    "spring to the end of its table": lambda: deck_of_case("elastic.test_nonlinear_springs", "test_tables", kind="SPRING1", force=20.0, expected=0.15),
    "rigid end under a moment": lambda: deck_of_case("constraints.test_multipoint_constraints", "test_rigid_body_in_equilibrium"),
    "mean rotation": lambda: deck_of_case("constraints.test_multipoint_constraints", "test_mean_rotation"),
    "Cook": lambda: deck_of_case("elastic.test_elasticity_benchmarks", "test_cook"),
}


def said(case: str, units: Units | None = None) -> str:
    """The deck of a case in some units, with tight controls."""
    return scaled((CASES | OTHERS)[case](), units or Units())


@pytest.fixture(scope="module")
def plain(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Job]:
    """The case as it is, run once."""
    done: dict[str, Job] = {}

    def find(name: str) -> Job:
        if name not in done:
            done[name] = solve(run, tmp_path_factory.mktemp("plain"), said(name))
        return done[name]

    return find


def solve(run: Run, folder: Path, deck: str, threads: int = 1) -> Job:
    """A job that has to finish."""
    folder.mkdir(exist_ok=True)
    (folder / "job.inp").write_text(deck)
    done = run(["--quiet", "--threads", threads, "job"], cwd=folder, threads=threads)
    assert done.returncode == 0, done.stdout + done.stderr
    return Job(folder / "job.vtkhdf", "job")


SHORT = {"three cubes", "example contact", "example interference", "patch, 3 on 4", "patch by mortar", "slope in the plane",
         "pull-out of rings", "stack", "corner of three walls", "defaults, in_a_corner"}  # fmt: skip
ALL = [pytest.param(case, marks=[] if case in SHORT else [pytest.mark.slow]) for case in CASES]
WITH_OTHERS = [*ALL, *(pytest.param(case, marks=[] if case.startswith("example") else [pytest.mark.slow]) for case in OTHERS)]


EVERY = bool(os.environ.get("AMONTONS_EVERY_CASE"))


def case_and_system() -> list[ParameterSet]:
    """Each case in one of the systems of units, by turns; with AMONTONS_EVERY_CASE in all of them."""
    chosen = ((case, system) for i, case in enumerate(WITH_OTHERS) for j, system in enumerate(SYSTEMS) if EVERY or i % len(SYSTEMS) == j)
    return [pytest.param(*case.values, system, marks=case.marks) for case, system in chosen]


def by_turns(turn: int) -> list[ParameterSet]:
    """The short cases, and each third of the others; with AMONTONS_EVERY_CASE all of them."""
    return [case for i, case in enumerate(ALL) if EVERY or not case.marks or i % 3 == turn]


@pytest.mark.parametrize(("case", "system"), case_and_system())
def test_units(run: Run, tmp_path: Path, plain: Callable[[str], Job], case: str, system: str) -> None:
    """N and mm as N and m, kN and m, pound and inch: 1e-8."""
    units = SYSTEMS[system]
    same(solve(run, tmp_path, said(case, units)), plain(case), 1e-8, InUnits(units))


@pytest.mark.parametrize("case", by_turns(0))
def test_shuffled_threads_twice(run: Run, tmp_path: Path, plain: Callable[[str], Job], case: str) -> None:
    """The cards of the model in another order: 1e-8; two threads: 1e-10, or 1e-9 over the sixty increments of the capstan, whose friction
    remembers the rounding of each (1.1e-10 of CPRESS was seen); the same run again: bitwise."""
    deck, wanted = said(case), plain(case)
    threaded = 1e-9 if case == "capstan" else 1e-10
    for name, text, threads in (("shuffled", in_dialect(deck, shuffled(deck, 3)), 1), ("threads", deck, 2), ("again", deck, 1)):
        job = solve(run, tmp_path / name, text, threads)
        same(job, wanted, {"shuffled": 1e-8, "threads": threaded, "again": 0.0}[name])


@pytest.mark.parametrize("case", by_turns(1))
def test_turned_and_renumbered(run: Run, tmp_path: Path, plain: Callable[[str], Job], case: str) -> None:
    """Turned in space, with supports along the turned axes; nodes in another order with other labels: 1e-8."""
    deck, wanted = said(case), plain(case)
    text, label = renumbered(deck, 7)
    same(solve(run, tmp_path / "renumbered", in_dialect(deck, text)), wanted, 1e-8, View(label=label))
    if "CAX" not in deck:
        same(solve(run, tmp_path / "turned", in_dialect(deck, turned(deck))), wanted, 1e-8, View(turn=rotation(deck)))


@pytest.mark.parametrize("case", by_turns(2))
def test_library_and_restart(run: Run, tmp_path: Path, plain: Callable[[str], Job], case: str) -> None:
    """The library takes the job to the middle and drops it, the program resumes it: all of the result file is the same bit by bit.

    But for the count of factorisations: a resumed job makes its factor again.
    """
    deck, wanted = tmp_path / "job.inp", plain(case)
    deck.write_text(said(case))
    job = amontons.Job(deck, checkpoint=True)
    for _ in range((len(wanted.times) - 1) // 2):
        job.advance()
    job.close()
    done = run(["--quiet", "--resume", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    other = set(common.same_results(tmp_path / "job.vtkhdf", wanted.path))
    assert other <= {"AMONTONS/history/n_factorisations"}
