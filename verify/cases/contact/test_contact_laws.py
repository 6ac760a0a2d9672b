"""One cube on another, rigid one: each law of contact, and what a step changes of it, against its closed form.

The lower cube is held everywhere. All nodes of the upper one follow prescribed displacements along x; along z it is
loaded by a pressure, or its top is moved. Poisson's ratio is zero, so that every slave node sees the same pressure.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run

MODULUS = 1000.0
HEAD = """** dialect: calculix
*NODE, NSET=ALL
{nodes}
*ELEMENT, TYPE=C3D8
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 11, 12, 13, 14, 15, 16, 17, 18
*ELSET, ELSET=BOTH
1, 2
*NSET, NSET=LOWER
1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=UPPER
11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=FOOT
11, 12, 13, 14
*NSET, NSET=TOP
15, 16, 17, 18
*MATERIAL, NAME=M
*ELASTIC
{modulus}, 0.
*SOLID SECTION, ELSET=BOTH, MATERIAL=M
*SURFACE, NAME=MASTER
1, S2
*SURFACE, NAME=SLAVE
2, S1
*SURFACE INTERACTION, NAME=I
{law}
*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE{pair}
SLAVE, MASTER
{model}
*BOUNDARY
LOWER, 1, 3
UPPER, 2, 2
"""
CORNERS = [(0, 0), (1, 0), (1, 1), (0, 1)]


@dataclass
class Answer:
    """Fields of the slave nodes, frame by frame, the initial state first."""

    pressure: np.ndarray  # (frames, 4)
    gap: np.ndarray
    shear: np.ndarray  # along x
    status: np.ndarray
    displacement: np.ndarray  # (frames, 4, 3)
    history: dict[str, np.ndarray]


class Bench:
    """Runs decks of the two cubes."""

    def __init__(self, run: Run, folder: Path) -> None:
        self.run, self.folder = run, folder

    def solve(self, law: str, steps: str, gap: float = 0.0, pair: str = "", model: str = "", dialect: str = "calculix") -> Answer:
        """The answer of one deck; gap is that of the mesh."""
        rows = [f"{10 * b + 4 * k + i + 1}, {x + 0.0}, {y + 0.0}, {k + b * (1 + gap)}" for b in (0, 1) for k in (0, 1)
                for i, (x, y) in enumerate(CORNERS)]
        head = HEAD.format(nodes="\n".join(rows), modulus=MODULUS, law=law, pair=pair, model=model)
        (self.folder / "job.inp").write_text(head.replace("calculix", dialect, 1) + steps)
        done = self.run(["--quiet", "job.inp"], cwd=self.folder)
        assert done.returncode == 0, done.stdout + done.stderr
        with h5py.File(self.folder / "job.vtkhdf") as file:
            data, history = file["VTKHDF/PointData"], file["AMONTONS/history"]
            n = len(file["VTKHDF/Points"])

            def slaves(name: str) -> np.ndarray:
                values = np.asarray(data[name])
                return values.reshape(-1, n, *values.shape[1:])[:, 8:12]

            return Answer(slaves("CPRESS"), slaves("COPEN"), slaves("CSHEAR")[..., 0], slaves("CSTATUS"), slaves("U"),
                          {k: np.asarray(v) for k, v in history.items() if k != "reason"})


@pytest.fixture
def bench(run: Run, tmp_path: Path) -> Bench:
    """A bench in a folder of its own."""
    return Bench(run, tmp_path)


def step(cards: str, static: str = "1., 1.", nlgeom: str = "") -> str:
    """A step with tight tolerances."""
    return f"*STEP{nlgeom}\n*STATIC\n{static}\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9,,, 1e-9\n{cards}\n*END STEP\n"


def pressed(p: float, x: float = 0.0) -> str:
    """Pressure on the upper cube, its nodes moved along x."""
    return f"*BOUNDARY\nUPPER, 1, 1, {x}\n*DLOAD\n2, P2, {p}"


def test_linear(bench: Bench) -> None:
    """p = K h (1/2 + atan(h/eps)/pi)."""
    stiffness, tension = 2.0e4, 3.0
    answer = bench.solve(f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{stiffness}, {tension}, 1.", step(pressed(10.0)))
    h = -answer.gap[-1]
    eps = np.pi * tension / stiffness
    assert answer.pressure[-1] == pytest.approx(10.0, rel=1e-7)
    assert stiffness * h * (0.5 + np.arctan(h / eps) / np.pi) == pytest.approx(10.0, rel=1e-7)


def test_linear_without_tension(bench: Bench) -> None:
    """No tension is allowed by default under the abaqus dialect: K h, and nothing at a gap within CalculiX's reach of 0.001 sqrt(A)."""
    lifted = step("*BOUNDARY, OP=NEW\nLOWER, 1, 3\nUPPER, 1, 2\nUPPER, 3, 3, 2e-4\n*DLOAD, OP=NEW")
    answer = bench.solve("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n2.e4", step(pressed(10.0)) + lifted, dialect="abaqus")
    assert answer.pressure[1] == pytest.approx(10.0, rel=1e-7)
    assert -2.0e4 * answer.gap[1] == pytest.approx(10.0, rel=1e-7)
    assert answer.gap[-1] == pytest.approx(2e-4, rel=1e-7)
    assert np.all(answer.pressure[-1] == 0)
    assert np.all(answer.status[-1] == 0)


def test_exponential(bench: Bench) -> None:
    """p = p0 exp(ln(100) h/c0): the surfaces never meet under a pressure below p0."""
    answer = bench.solve("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n0.1, 20.", step(pressed(10.0), "0.5, 1."))
    assert 20 * np.exp(-np.log(100) * answer.gap[-1] / 0.1) == pytest.approx(10.0, rel=1e-7)
    assert np.all(answer.gap[-1] > 0)


def test_exponential_ends_gently(bench: Bench) -> None:
    """Less than a hundredth of p0 is borne too, along the tangent at c0: p = 0.01 p0 (1 - ln(100) (g - c0)/c0)."""
    answer = bench.solve("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n0.1, 20.", step(pressed(0.1), "0.5, 1."))
    assert answer.pressure[-1] == pytest.approx(0.1, rel=1e-7)
    assert answer.gap[-1] == pytest.approx(0.1 * (1 + 0.5 / np.log(100)), rel=1e-7)


@pytest.mark.parametrize("dialect", ["calculix", "abaqus"])
def test_steep_law_is_in_balance(bench: Bench, dialect: str) -> None:
    """A cube whose top is moved on into a steep law: its pressure is that of a bar, p = E (u - gap - h)/L, with u the displacement of the top and h the overclosure.

    Each increment begins with the predictor from the last velocity, some twenty c0 deep: the law has 1e10 p0 there. That is no force by which a
    equilibrium may be measured: it ended with 52.3 in place of 44.6. 5e-4 is the tolerance of the calculix dialect.
    """
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n0.0005, 1."
    moved = "*STEP, INC=1000\n*STATIC\n0.2, 1., , 0.2\n*BOUNDARY\nUPPER, 1, 1\nTOP, 3, 3, -0.05\n*END STEP\n"
    answer = bench.solve(law, moved, gap=0.005, dialect=dialect)
    h = -answer.gap[-1]
    assert h == pytest.approx(0.0005 * np.log(answer.pressure[-1]) / np.log(100), rel=1e-7)
    assert answer.pressure[-1] == pytest.approx(MODULUS * (0.05 - 0.005 - h), rel=5e-4)


def test_tabular(bench: Bench) -> None:
    """Linear between the points."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n8., 0.01\n12., 0.02"
    answer = bench.solve(law, step(pressed(10.0)), gap=-0.001)
    assert -answer.gap[-1] == pytest.approx(0.015, rel=1e-7)


def test_table_that_begins_before_touch(bench: Bench) -> None:
    """Under the calculix dialect its pressure jumps where bodies touch: the deck's reader says so, and says nothing of a table that begins at 0."""
    for first, is_reported in (("0., -0.01\n4., 0.", True), ("0., 0.", False)):
        bench.solve(f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n{first}\n12., 0.02", step(pressed(10.0)), gap=-0.001)
        done = bench.run(["--check", "job.inp"], cwd=bench.folder)
        assert ("The table begins before bodies touch" in done.stdout + done.stderr) == is_reported, done.stdout + done.stderr


def test_tied_pulls(bench: Bench) -> None:
    """A spring in tension and compression, from where the surfaces were; it shears with the stick slope and never slips."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.e4\n*FRICTION\n0.1, 500."
    answer = bench.solve(law, step(pressed(-10.0, 0.02)), gap=0.001)
    assert answer.gap[-1] == pytest.approx(0.001, rel=1e-6)
    assert answer.displacement[-1, :, 2] == pytest.approx(0.001, rel=1e-6)
    assert answer.pressure[-1] == pytest.approx(-10.0, rel=1e-6)
    assert answer.shear[-1] == pytest.approx(-10.0, rel=1e-6)


@pytest.mark.parametrize(("dialect", "friction", "slope"), [("calculix", "*FRICTION\n0.1", 0.5 * MODULUS), ("calculix", "", 1e4), ("abaqus", "*FRICTION\n0.1", 1e4)])
def test_tied_without_a_stick_slope(bench: Bench, dialect: str, friction: str, slope: float) -> None:
    """FRICTION without one means half of Young's modulus in CalculiX for TIED as for any law (without FRICTION it refuses TIED); else shear is as stiff as pressure."""
    law = f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.e4\n{friction}".rstrip()
    answer = bench.solve(law, step(pressed(10.0, 0.02)), dialect=dialect)
    assert answer.shear[-1] == pytest.approx(-0.02 * slope, rel=1e-6)


def test_hard_of_calculix(bench: Bench) -> None:
    """HARD is LINEAR with 50 times Young's modulus under the calculix dialect."""
    answer = bench.solve("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD", step(pressed(10.0)))
    assert -answer.gap[-1] == pytest.approx(10 / (50 * MODULUS), rel=2e-3)


def test_stick_slope(bench: Bench) -> None:
    """Shear is lambda times the displacement up to mu p, back on the same slope; the loop's area is what friction took."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.e5, 1., 1.\n*FRICTION\n0.2, 100."
    drag = "*BOUNDARY\nUPPER, 1, 1, {}"
    steps = step(pressed(10.0)) + step(drag.format(0.01)) + step(drag.format(0.05), "0.2, 1., , 0.2") + step(drag.format(0.02), "0.2, 1., , 0.2")
    answer = bench.solve(law, steps)
    assert answer.shear[2] == pytest.approx(-1.0, rel=1e-6)
    assert np.all(answer.status[2] == 1)
    assert answer.shear[7] == pytest.approx(-2.0, rel=1e-6)
    assert np.all(answer.status[7] == 2)
    assert answer.shear[-1] == pytest.approx(-2.0 + 100 * 0.03, rel=1e-6)
    assert answer.history["friction_work"][-1] == pytest.approx(2.0 * 0.03, rel=1e-6)


@pytest.mark.parametrize("law", ["", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.e5, 1., 1.\n"])
def test_shear_limit(bench: Bench, law: str) -> None:
    """TAUMAX cuts the friction, exact or compliant."""
    answer = bench.solve(law + "*FRICTION, TAUMAX=1.5\n0.2, 1.e4", step(pressed(10.0)) + step("*BOUNDARY\nUPPER, 1, 1, 0.05"))
    assert answer.pressure[-1] == pytest.approx(10.0, rel=1e-6)


def test_shear_limit_of_a_free_foot(bench: Bench) -> None:
    """Exact contact gives force only where no support does: the top drags the foot along, which slips at TAUMAX."""
    steps = step("*BOUNDARY\nTOP, 1, 1\n*DLOAD\n2, P2, 30.") + step("*BOUNDARY\nTOP, 1, 1, 0.05", "0.25, 1.")
    answer = bench.solve("*FRICTION, TAUMAX=1.5\n0.2", steps)
    assert np.mean(answer.shear[-1]) == pytest.approx(-1.5, rel=1e-6)
    assert np.all(answer.status[-1] == 2)


def test_rough_never_slips(bench: Bench) -> None:
    """ROUGH: the foot stays where it is under any drag, as long as it is pressed."""
    steps = step("*BOUNDARY\nTOP, 1, 1\n*DLOAD\n2, P2, 100.") + step("*BOUNDARY\nTOP, 1, 1, 0.01", "0.25, 1.")
    answer = bench.solve("*FRICTION, ROUGH", steps)
    assert np.all(answer.status[-1] == 1)
    assert np.abs(answer.displacement[-1, :, 0]).max() < 1e-9
    assert np.mean(answer.shear[-1]) < -1.0


@pytest.mark.parametrize("words", ["SLIP TOLERANCE=0.005", "ELASTIC SLIP=1e-3", "LAGRANGE"])
def test_sticking_is_exact(bench: Bench, words: str) -> None:
    """Whatever slip the deck would allow: below mu p the foot does not move at all, and bitwise as without the word; beyond, it transmits mu p."""
    steps = step("*BOUNDARY\nTOP, 1, 1\n*DLOAD\n2, P2, 100.") + step("*BOUNDARY\nTOP, 1, 1, 0.01", "0.25, 1.")
    plain, answer = bench.solve("*FRICTION\n0.2", steps), bench.solve(f"*FRICTION, {words}\n0.2", steps)
    assert np.all(answer.status[-1] == 1)
    assert np.abs(answer.displacement[-1, :, 0]).max() < 1e-12
    assert np.array_equal(answer.displacement, plain.displacement)
    slipped = bench.solve(f"*FRICTION, {words}\n0.2", steps.replace("1, 1, 0.01", "1, 1, 0.1"))
    assert np.mean(slipped.shear[-1]) == pytest.approx(-20.0, rel=1e-6)


def test_change_friction(bench: Bench) -> None:
    """The shear of a sliding foot follows the new coefficient."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.e5, 1., 1.\n*FRICTION\n0.2, 1.e4"
    change = "*CHANGE FRICTION, INTERACTION=I\n*FRICTION\n0.1, 1.e4\n*BOUNDARY\nUPPER, 1, 1, 0.002"
    answer = bench.solve(law, step(pressed(10.0, 0.001)) + step(change))
    assert answer.shear[1] == pytest.approx(-2.0, rel=1e-6)
    assert answer.shear[2] == pytest.approx(-1.0, rel=1e-6)


def test_change_surface_behavior(bench: Bench) -> None:
    """The penetration follows the new stiffness."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n100., 0.1"
    change = "*CHANGE SURFACE BEHAVIOR, INTERACTION=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n100., 0.05"
    answer = bench.solve(law, step(pressed(10.0)) + step(change), gap=-0.001)
    assert -answer.gap[1] == pytest.approx(0.01, rel=1e-6)
    assert -answer.gap[2] == pytest.approx(0.005, rel=1e-6)


def moved(z: float) -> str:
    """The top of the upper cube moved along z."""
    return f"*BOUNDARY\nUPPER, 1, 1\nTOP, 3, 3, {z}"


def test_pair_removed_and_added(bench: Bench) -> None:
    """Without the pair the cubes pass through each other; with it again the overlap is pressed out."""
    steps = step(moved(0.0) + "\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nSLAVE, MASTER")
    steps += step(moved(-0.01)) + step("*MODEL CHANGE, TYPE=CONTACT PAIR, ADD\nSLAVE, MASTER")
    answer = bench.solve("", steps)
    assert answer.displacement[2, :, 2] == pytest.approx(-0.01, rel=1e-9)
    assert answer.pressure[2] == pytest.approx(0.0, abs=1e-9)
    assert answer.gap[3] == pytest.approx(0.0, abs=1e-9)
    assert answer.pressure[3] == pytest.approx(MODULUS * 0.01, rel=1e-6)


def test_clearance(bench: Bench) -> None:
    """The gap at the start is the CLEARANCE, whatever the mesh says."""
    answer = bench.solve("", step(moved(-0.01)), gap=0.2, model="*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=0.004")
    assert answer.displacement[-1, :, 2] == pytest.approx(-0.004, rel=1e-6)
    assert answer.pressure[-1] == pytest.approx(MODULUS * 0.006, rel=1e-6)


def test_interference_shrinks(bench: Bench) -> None:
    """An overclosure of the mesh is pressed out over the step, in proportion to the time."""
    cards = moved(0.0) + "\n*CONTACT INTERFERENCE, SHRINK\nSLAVE, MASTER"
    answer = bench.solve("", step(cards, "0.25, 1., , 0.25"), gap=-0.01)
    assert answer.pressure[1:, 0] == pytest.approx(MODULUS * 0.01 * np.array([0.25, 0.5, 0.75, 1.0]), rel=1e-6)


def test_interference_allowed(bench: Bench) -> None:
    """A given interference ends at nothing."""
    cards = moved(0.0) + "\n*CONTACT INTERFERENCE\nSLAVE, MASTER, 0.02"
    answer = bench.solve("", step(cards, "0.25, 1., , 0.25"), gap=-0.01)
    assert answer.pressure[1:, 0] == pytest.approx(MODULUS * np.array([0.0, 0.0, 0.005, 0.01]), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("adjust", ["0.003", "FOOT"])
def test_adjust(bench: Bench, adjust: str) -> None:
    """The slave nodes begin on the master, without stress."""
    answer = bench.solve("", step(moved(-0.01)), gap=0.002, pair=f", ADJUST={adjust}")
    assert answer.displacement[-1, :, 2] == pytest.approx(0.0, abs=1e-12)
    assert answer.pressure[-1] == pytest.approx(MODULUS * 0.01 / 1.002, rel=1e-6)


def test_small_sliding(bench: Bench) -> None:
    """SMALL SLIDING under NLGEOM: the foot goes far beyond the master and keeps its weights and its normal."""
    answer = bench.solve("*FRICTION\n0.2", step(pressed(10.0)) + step("*BOUNDARY\nUPPER, 1, 1, 3.", nlgeom=", NLGEOM"),
                         pair=", SMALL SLIDING")
    assert answer.gap[-1] == pytest.approx(0.0, abs=1e-9)
    assert answer.pressure[-1] == pytest.approx(10.0, rel=1e-6)


def test_symmetric_pairs(bench: Bench) -> None:
    """Each surface slave of the other, under a compliant law: both share the load."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n100., 0.1"
    back = "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nMASTER, SLAVE"
    answer = bench.solve(law, step(pressed(10.0)), gap=-0.001, model=back)
    assert -answer.gap[-1] == pytest.approx(0.005, rel=1e-6)
    assert answer.pressure[-1] == pytest.approx(5.0, rel=1e-6)


def test_free_body_is_named(bench: Bench) -> None:
    """A body that is pulled off its only contact: the reason says so, in the results, in .cvg and on the terminal."""
    with pytest.raises(AssertionError, match="FREE BODY|LINEAR SOLVER"):
        bench.solve("", step(pressed(-10.0)))
    assert "** FREE BODY" in (bench.folder / "job.cvg").read_text() or "** LINEAR" in (bench.folder / "job.cvg").read_text()


def test_energies(bench: Bench) -> None:
    """What loads and supports put into a linear system is in the elements and in the springs of the contact."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.e4\n*FRICTION\n0.1, 500."
    history = bench.solve(law, step(pressed(-10.0, 0.02), "0.25, 1."), gap=0.001).history
    contact = 0.5 * 10.0**2 / 1.0e4 + 0.5 * 500 * 0.02**2
    assert history["contact_energy"][-1] == pytest.approx(contact, rel=1e-6)
    assert history["strain_energy"][-1] == pytest.approx(0.5 * 10.0**2 / MODULUS, rel=1e-6)
    assert history["friction_work"][-1] == pytest.approx(0.0, abs=1e-12)
    stored = history["contact_energy"] + history["strain_energy"]
    assert history["external_work"] == pytest.approx(stored, rel=1e-6, abs=1e-12)


def test_friction_takes_work(bench: Bench) -> None:
    """A slipping foot: mu p times the slip is lost, the rest is stored."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n2.e4, 3., 1.\n*FRICTION\n0.1, 500."
    steps = step(pressed(10.0)) + step(pressed(10.0, 0.05), "1., 1.")
    history = bench.solve(law, steps).history
    assert history["friction_work"][-1] == pytest.approx(1.0 * (0.05 - 1.0 / 500), rel=1e-5)


def test_contact_print_of_some(bench: Bench) -> None:
    """CONTACT PRINT of a node set and of a pair."""
    law = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.e4"
    back = "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nMASTER, SLAVE\n*NSET, NSET=TWO\n11, 13"
    prints = "*CONTACT PRINT, NSET=TWO\nCSTR\n*CONTACT PRINT, SLAVE=MASTER, MASTER=SLAVE\nCSTR, CF\n"
    bench.solve(law, step(pressed(10.0) + "\n" + prints), model=back)
    lines = (bench.folder / "job.dat").read_text().splitlines()
    starts = [i for i, line in enumerate(lines) if "contact stress" in line]
    assert len(starts) == 2
    labels = [[int(line.split()[0]) for line in lines[i + 2 : i + 7] if line.strip() and line.split()[0].isdigit()] for i in starts]
    assert labels[0] == [11, 13]
    assert labels[1] == [5, 6, 7, 8]
    heads = [line for line in lines if "statistics for slave set" in line]
    assert len(heads) == 1 and "slave set MASTER, master set SLAVE" in heads[0]
    place = next(i for i, line in enumerate(lines) if "total surface force" in line)
    force = [float(v) for v in lines[place + 2].split()]
    assert force[:3] == pytest.approx([0.0, 0.0, -5.0], abs=1e-6)


@pytest.mark.parametrize("wrong", ["NSET=NONE", "SLAVE=NONE", "MASTER=NONE"])
def test_contact_print_of_nothing(bench: Bench, wrong: str) -> None:
    """Undefined names are reported."""
    with pytest.raises(AssertionError, match="There is no .* 'NONE'"):
        bench.solve("", step(pressed(10.0) + f"\n*CONTACT PRINT, {wrong}\nCSTR"))
