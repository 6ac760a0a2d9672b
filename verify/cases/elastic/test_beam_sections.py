"""Cross-sections of beams: a cantilever of each bent about both axes, pulled, twisted and under its weight, against closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Case, Job
from verify.conftest import Run
from verify.decks.beams import LENGTH, MODULUS, RATIO, Section, beam, box, circle, pipe, rectangle
from verify.decks.shells import Floats
from verify.readers.dat_frd_files import read_dat

Proof = Callable[..., Case]

SECTIONS = {
    "circ": circle(0.3),
    "pipe": pipe(0.3, 0.05),
    "thick-pipe": pipe(0.3, 0.2),
}
BEAM_THEORY = "S. Timoshenko, Strength of Materials, part I, 3rd edition, Van Nostrand 1955"


def step(load: str) -> str:
    """A clamped end and one linear step."""
    return f"*BOUNDARY\n1, ENCASTRE\n*STEP\n*STATIC\n{load}*END STEP\n"


def at(job: Job, x: float) -> Floats:
    """The displacement of the node of the deck on the axis."""
    return job.last("U")[int(np.argmin(np.abs(job.points - np.array([x, 0.0, 0.0])).sum(axis=1)))]


def bend(job: Job, axis: int) -> float:
    """The second difference of the deflection at x = 3, 5, 7: free of what the ends do within a diameter."""
    return float(at(job, 7.0)[axis] - 2 * at(job, 5.0)[axis] + at(job, 3.0)[axis])


def twist(job: Job, x: float) -> float:
    """The rotation about x of a cross-section, by the displacements of the corners around it."""
    places, u = job.points, job.last("U")
    corners = np.flatnonzero((np.abs(places[:, 0] - x) < 1e-9) & (np.abs(places[:, 1]) > 1e-6) & (np.abs(places[:, 2]) > 1e-6))
    r, v = places[corners], u[corners]
    return float(np.mean((r[:, 1] * v[:, 2] - r[:, 2] * v[:, 1]) / (r[:, 1] ** 2 + r[:, 2] ** 2)))


@pytest.mark.parametrize("kind", ["B31", "B32"])
@pytest.mark.parametrize("name", list(SECTIONS))
def test_cantilever(proof: Proof, name: str, kind: str) -> None:
    """Tip deflection along both directions, stretch, twist and weight."""
    section = SECTIONS[name]
    case = proof(
        f"beam-{name}-{kind.lower()}",
        title=f"A cantilever of {kind} with a section {section.word} {section.data}",
        model=f"Length 10, twenty elements, E = 2.1e5, nu = 0.3, direction 1 along y, clamped; five jobs: a unit force at the end along each axis, a unit moment about "
        "x, and a weight of 1 per volume along -y.",
        formula="w'' = F (L - x) / (E I), u' = F / (E A), turn' = T / (G J), w'' = q (L - x)^2 / (2 E I) by differences between x = 3 and 7; F L^3 / (3 E I) at the end; "
        "A, I, J of the circle or the pipe in closed form.",
        source=BEAM_THEORY,
        proves="The points of the section have its area, moments of inertia and torsion constant; B31 with a middle node of its own.",
    )
    shear = MODULUS / (2 * (1 + RATIO))
    loads = {"along y": "*CLOAD\nEND, 2, 1.\n", "along z": "*CLOAD\nEND, 3, 1.\n", "along x": "*CLOAD\nEND, 1, 1.\n", "about x": "*CLOAD\nEND, 4, 1.\n",
             "weight": "*DLOAD\nE, GRAV, 1., 0., -1., 0.\n"}  # fmt: skip
    jobs = {load: case.run(beam(kind, section, n=20) + step(rows), load) for load, rows in loads.items()}
    why, place = "what the ends do has decayed", "x = 3 to 7"
    case.near("bending along y", bend(jobs["along y"], 1), 4 * 5 / (MODULUS * section.inertia_1), 1e-3, why=why, place=place, time="the end")
    case.near("bending along z", bend(jobs["along z"], 2), 4 * 5 / (MODULUS * section.inertia_2), 1e-3, why=why, place=place, time="the end")
    tip = LENGTH**3 / (3 * MODULUS * section.inertia_1)
    case.near("deflection", float(at(jobs["along y"], LENGTH)[1]), tip, 0.01, why="a clamp acts on the corners around the section: stiff by part of an element, "
              "beside shear", place="the end", time="the end")  # fmt: skip
    stretch = float(at(jobs["along x"], 7.0)[0] - at(jobs["along x"], 3.0)[0])
    case.near("stretch", stretch, 4 / (MODULUS * section.area), 1e-3, why=why, place=place, time="the end")
    turn = twist(jobs["about x"], 7.0) - twist(jobs["about x"], 3.0)
    case.near("twist", turn, 4 / (shear * section.torsion), 1e-3, why=why, place=place, time="the end")
    weight = -section.area * (4 * 12.5 + 16 / 12) / (MODULUS * section.inertia_1) + 4 / shear  # w'' = M / (E I) - q / (G A)
    case.near("under its weight", bend(jobs["weight"], 1), weight, 1e-3, why=why, place=place, time="the end")
    case.done()

DIRECTIONS = {
    "in a plane": np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]),
    "in space": np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3,
}


@pytest.mark.parametrize("is_finite", [False, True], ids=["linear", "nlgeom"])
@pytest.mark.parametrize("kind", ["B31", "B32"])
@pytest.mark.parametrize("section", [rectangle(0.3, 0.2), circle(0.3), pipe(0.3, 0.05)], ids=["rect", "circ", "pipe"])
def test_moment_on_a_beam_in_any_direction(run_deck: Run, tmp_path: Path, section: Section, kind: str, is_finite: bool) -> None:
    """Cross-sections turn by T x / (G J), M x / (E I): 1 %, of products of the angles. In other directions they do to the digits of the table."""
    stiffness = np.array([MODULUS / (2 * (1 + RATIO)) * section.torsion, MODULUS * section.inertia_2, MODULUS * section.inertia_1])
    angles = np.array([0.002, 0.003, 0.005])  # about the axis, direction 1 and direction 2
    turns = {}
    for name, axes in {"along x": np.eye(3), **DIRECTIONS}.items():
        places = np.outer(np.linspace(0, LENGTH, 21), axes[:, 0])
        moment = axes @ (stiffness * angles / LENGTH)
        elements = [(i, i + 1) for i in range(1, 21)] if kind == "B31" else [(i, i + 1, i + 2) for i in range(1, 21, 2)]
        deck = "*NODE, NSET=N\n" + "".join(f"{i + 1}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(places))
        deck += f"*NSET, NSET=END\n21\n*ELEMENT, TYPE={kind}, ELSET=E\n" + "".join(f"{i + 1}, {', '.join(map(str, nodes))}\n" for i, nodes in enumerate(elements))
        deck += f"*MATERIAL, NAME=M\n*ELASTIC\n{MODULUS}, {RATIO}\n*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION={section.word}\n{section.data}\n"
        deck += ", ".join(f"{a:.15g}" for a in axes[:, 1]) + "\n" + step("*CLOAD\n" + "".join(f"END, {4 + k}, {moment[k]:.15g}\n" for k in range(3))
                                                                      + "*NODE PRINT, NSET=N\nUR\n")  # fmt: skip
        done = run_deck(deck.replace("*STEP", "*STEP, NLGEOM") if is_finite else deck)
        assert done.returncode == 0, done.stdout + done.stderr
        rows = next(table for table in read_dat(tmp_path / "job.dat") if table.title.startswith("rotations")).rows
        turns[name] = np.array([rows[(21,)], np.subtract(rows[(15,)], rows[(7,)])]) @ axes
    assert np.abs(turns["along x"][1] - 0.4 * angles).max() <= 0.01 * 0.4 * angles.max(), turns["along x"]
    for name in DIRECTIONS:
        assert np.abs(turns[name] - turns["along x"]).max() <= 2e-6 * angles.max(), (name, turns)


@pytest.mark.parametrize("section", [rectangle(0.4, 0.3), circle(0.25), pipe(0.25, 0.1)], ids=["rect", "circ", "pipe"])
@pytest.mark.parametrize("along", [(1.0, 0.0, 0.0), (0.48, 0.6, 0.64)], ids=["x", "oblique"])
def test_twist_of_turned_ends(run_deck: Run, tmp_path: Path, along: tuple[float, float, float], section: Section) -> None:
    """A short B32 whose ends turn by prescribed rotations has its torque on coarse meshes and fine ones: it enters at the sides of the cross-section, too.
    By its corners alone it would fall with each refinement, from 0.7 to 6 % below. The ends stay plane; a rectangle warps as f(x) y z between them, with
    E Iw f'' = G J f - r T, r = (I2 - I1)/(I1 + I2), Iw = a^3 b^3/144, so that theta = T L/(G J) (1 - r^2 tanh(L/(2 l)) 2 l/L), l^2 = E Iw/(G J)."""
    axis, length, angle = np.array(along), 2.7, 1e-3
    across = np.cross(axis, [0.0, 0.0, 1.0])
    for n in (3, 6, 24):
        places = np.outer(np.linspace(0.0, length, 2 * n + 1), axis)
        deck = "*NODE\n" + "".join(f"{i + 1}, {x:.15g}, {y:.15g}, {z:.15g}\n" for i, (x, y, z) in enumerate(places))
        deck += "*ELEMENT, TYPE=B32, ELSET=E\n" + "".join(f"{e + 1}, {2 * e + 1}, {2 * e + 2}, {2 * e + 3}\n" for e in range(n))
        deck += f"*MATERIAL, NAME=M\n*ELASTIC\n{MODULUS}, {RATIO}\n*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION={section.word}\n{section.data}\n"
        deck += ", ".join(f"{v:.15g}" for v in across) + f"\n*BOUNDARY\n1, ENCASTRE\n{2 * n + 1}, 1, 3\n*STEP\n*STATIC\n*BOUNDARY\n"
        deck += "".join(f"{2 * n + 1}, {k + 4}, {k + 4}, {angle * axis[k]:.15g}\n" for k in range(3)) + "*EL PRINT, ELSET=E\nSM\n*END STEP\n"
        done = run_deck(deck)
        assert done.returncode == 0, done.stdout + done.stderr
        torque = [row[2] for row in read_dat(tmp_path / "job.dat")[0].rows.values()]
        one, two = section.inertia_1, section.inertia_2
        decay = np.sqrt(2 * (1 + RATIO) * (0.4 * 0.3) ** 3 / 144 / section.torsion)
        warping = ((two - one) / (one + two)) ** 2 * np.tanh(length / (2 * decay)) * 2 * decay / length  # 0.7 %; 0 where both moments are equal
        wanted = MODULUS / (2 * (1 + RATIO)) * section.torsion * angle / length / (1 - warping)
        assert np.array(torque) == pytest.approx(wanted, rel=0.002), f"{n} elements"


@pytest.mark.parametrize("load", ["*CLOAD\n2, 5, 1.\n", "*BOUNDARY\n2, 5, 5, 0.01\n", "*CLOAD\n2, 2, 1.\n"], ids=["moment", "rotation", "force"])
@pytest.mark.parametrize("kind", ["B31", "S4"])
def test_oblique_moments_of_the_calculix_dialect(run_deck: Run, kind: str, load: str) -> None:
    """A warning where moments turn about another axis, too, as in CalculiX; none along an axis, by a force, or in the abaqus dialect."""
    for word, slope in (("calculix", 0.0), ("calculix", 0.75), ("abaqus", 0.75)):
        deck = f"** dialect: {word}\n*NODE\n1, 0., 0., 0.\n2, 1., 0., {slope}\n3, 1., 1., {slope}\n4, 0., 1., 0.\n"
        deck += f"*ELEMENT, TYPE={kind}, ELSET=E\n" + ("1, 1, 2\n" if kind == "B31" else "1, 1, 2, 3, 4\n") + f"*MATERIAL, NAME=M\n*ELASTIC\n{MODULUS}, {RATIO}\n"
        deck += "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n0.4, 0.2\n0., 1., 0.\n" if kind == "B31" else "*SHELL SECTION, ELSET=E, MATERIAL=M\n0.1\n"
        done = run_deck(deck + f"*BOUNDARY\n1, 1, 6\n4, 1, {6 if kind == 'S4' else 0}\n".replace("4, 1, 0\n", "") + f"*STEP\n*STATIC\n{load}*END STEP\n")
        assert done.returncode == 0, done.stdout
        assert ("Node 2: moments and rotations of beams and shells" in done.stdout) == (word == "calculix" and slope > 0 and "2, 5" in load), done.stdout


def general(deck: str, third: str, parameters: str = "") -> str:
    """The deck with BEAM GENERAL SECTION: its third line gives the elasticity that *MATERIAL had."""
    head, section = deck.split("*MATERIAL", 1)
    card, dimensions, direction = section[section.index("*BEAM SECTION") :].splitlines()[:3]
    return head + card.replace("BEAM SECTION", "BEAM GENERAL SECTION").replace(" MATERIAL=M,", "") + f"{parameters}\n{dimensions}\n{direction}\n{third}\n"


@pytest.mark.parametrize("section", [rectangle(0.3, 0.2), circle(0.3), pipe(0.3, 0.05)], ids=["rect", "circ", "pipe"])
def test_general_section(run: Run, tmp_path: Path, section: Section) -> None:
    """E, G, expansion and density by BEAM GENERAL SECTION give the beam of BEAM SECTION and MATERIAL, but for the rounding of E/(2 G) - 1."""
    load = "*CLOAD\nEND, 2, 1.\nEND, 4, 1.\n*DLOAD\nE, GRAV, 1., 0., -1., 0.\n*TEMPERATURE\nN, 30.\n"
    plain = beam("B31", section).replace("*DENSITY", "*EXPANSION, ZERO=5.\n1e-5\n*DENSITY")
    start = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nN, 10.\n"
    shear = MODULUS / (2 * (1 + RATIO))
    decks = {
        "plain": plain,
        "general": general(plain, f"{MODULUS:.17g}, {shear:.17g}, 1e-5", ", DENSITY=1., ZERO=5., POISSON=0.3"),
        "named": plain.replace("BEAM SECTION", "BEAM GENERAL SECTION"),
    }
    fields = {}
    for name, deck in decks.items():
        (tmp_path / f"{name}.inp").write_text(deck + start + step(load))
        done = run(["--quiet", name], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        fields[name] = Job(tmp_path / f"{name}.vtkhdf", name).last("U")
    assert np.abs(fields["general"] - fields["plain"]).max() <= 1e-9 * np.abs(fields["plain"]).max()
    assert (fields["named"] == fields["plain"]).all()


@pytest.mark.parametrize(("third", "says"), [
    ("", "needs a third data line with Young's modulus and the shear modulus."),
    ("2.1e5, 7e4", "The shear modulus must be more than a third of Young's modulus"),
    ("2.1e5", "shear modulus"),
    ("2.1e5, 8e4, 0.\n2.1e5, 8e4, 0., 20.", "Constants over the temperature are not supported"),
], ids=["missing", "incompressible", "half", "table"])  # fmt: skip
def test_general_section_is_refused(run_deck: Run, third: str, says: str) -> None:
    """What the third line must hold."""
    done = run_deck(general(beam("B31", circle(0.3)), third) + step("*CLOAD\nEND, 2, 1.\n"))
    assert done.returncode == 3
    assert says in re.sub(r"\s+", " ", done.stdout + done.stderr)


@pytest.mark.parametrize("kind", ["B21", "B22"])
def test_plane_frame(proof: Proof, kind: str) -> None:
    """A right angle of plane beams, loaded at its end."""
    step_size = 2 if kind == "B22" else 1
    n = 8
    count = step_size * n
    case = proof(
        f"plane-frame-{kind.lower()}",
        title=f"A bent cantilever of {kind}",
        model="A column of 4 along y and an arm of 4 along x, eight elements each, RECT 0.2 across the plane and 0.1 in it, E = 2.1e5, nu = 0; clamped below, a "
        "force of 1 down at the end of the arm; nodes have no supports out of the plane.",
        formula="The end sinks by F a^3 / (3 E I) + F a^2 h / (E I) + F h / (E A).",
        source=BEAM_THEORY,
        proves="Beams in the plane need no supports out of it; a knot carries their moment.",
    )
    places = [(0.0, 4 * i / count) for i in range(count + 1)] + [(4 * i / count, 4.0) for i in range(1, count + 1)]
    rows = "*NODE, NSET=N\n" + "".join(f"{i + 1}, {x:.15g}, {y:.15g}\n" for i, (x, y) in enumerate(places))
    rows += f"*ELEMENT, TYPE={kind}, ELSET=E\n"
    rows += "".join(f"{e + 1}, {', '.join(str(step_size * e + 1 + k) for k in range(step_size + 1))}\n" for e in range(2 * n))
    rows += "*MATERIAL, NAME=M\n*ELASTIC\n2.1e5, 0.\n*BEAM SECTION, ELSET=E, MATERIAL=M, TEMPERATURE=GRADIENTS, SECTION=RECT\n.2, .1\n"  # as Abaqus/CAE writes it
    job = case.run(rows + "*BOUNDARY\n1, ENCASTRE\n*STEP\n*STATIC\n*CLOAD\n" + f"{len(places)}, 2, -1.\n*END STEP\n", kind)
    bending = 2.1e5 * 0.2 * 0.1**3 / 12
    expected = 4**3 / (3 * bending) + 4**2 * 4 / bending + 4 / (2.1e5 * 0.02)
    u = job.last("U")[len(places) - 1]
    case.near("sinking", float(-u[1]), expected, 0.01, why="the corner is rigid over half a height, shear", place="end of the arm", time="the end")
    case.near("out of the plane", float(abs(u[2])), 0.0, 1e-9, why="it is held", place="end of the arm", time="the end")
    case.done()


BOX: Section = box(0.6, 0.4, (0.02, 0.04, 0.03, 0.02))


def test_box(proof: Proof) -> None:
    """A box with four different walls, in the calculix dialect."""
    case = proof(
        "beam-box",
        title="A cantilever with a section BOX",
        model="The cantilever of B32R in the calculix dialect with a box 0.6 x 0.4 with walls 0.02, 0.04, 0.03, 0.02: a unit force at the end along y, z.",
        formula="w'' = F (L - x) / (E I) about axes through the centre of the middle lines.",
        source=BEAM_THEORY,
        proves="The walls stand on their sides of the box.",
    )
    for load, axis, inertia in (("along y", 1, BOX.inertia_1), ("along z", 2, BOX.inertia_2)):
        deck = beam("B32R", BOX, n=20) + "*BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n" + f"*CLOAD\nEND, {axis + 1}, 1.\n*END STEP\n"
        job = case.run("** dialect: calculix\n" + deck, load)
        case.near(f"bending {load}", bend(job, axis), 4 * 5 / (MODULUS * inertia), 3e-3, why="the product of inertia", place="x = 3 to 7", time="the end")
    case.done()


@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("kind", ["B31", "B32"])
def test_hinged_beam(proof: Proof, kind: str, dialect: str) -> None:
    """A straight beam on two hinges turns about its axis: that motion is held, and does no harm."""
    case = proof(
        f"hinged-beam-{kind.lower()}-{dialect}",
        title=f"A hinged beam of {kind}, {dialect} dialect",
        model="Length 10, twenty elements of a rectangle 0.4 x 0.6 (0.4 along y), E = 2.1e5, nu = 0.3; one end held in x, y, z, the other in y, z; forces 1 along y and 2 along z at "
        "the middle.",
        formula="w = F L^3/(48 E I) + F L/(4 k G A), k = 5/6, at the middle, in both directions; the ends turn by F L^2/(16 E I).",
        source=BEAM_THEORY,
        proves="A beam that may turn about its axis is held by the mean rotation of a cross-section, without a force and without a rotation.",
    )
    section = rectangle(0.4, 0.6)
    per = 2 if kind == "B32" else 1
    middle, last = 10 * per + 1, 20 * per + 1
    load = f"*CLOAD\n{middle}, 2, 1.\n{middle}, 3, 2.\n"
    deck = f"** dialect: {dialect}\n" + beam(kind, section, n=20) + f"*BOUNDARY\n1, 1, 3\n{last}, 2, 3\n*STEP\n*STATIC\n{load}*END STEP\n"
    job = case.run(deck, "two hinges")
    shear = MODULUS / (2 * (1 + RATIO))
    for axis, force, inertia in ((1, 1.0, section.inertia_1), (2, 2.0, section.inertia_2)):
        wanted = force * LENGTH**3 / (48 * MODULUS * inertia) + force * LENGTH / (4 * 5 / 6 * shear * section.area)
        case.near(f"deflection along {'xyz'[axis]}", float(at(job, 5.0)[axis]), wanted, 5e-3, why="twenty elements; local effects of the load and of the hinges", place="the middle",
                  time="the end")  # fmt: skip
    turns = job.last("UR")[0]
    slopes = [0.0, -2 * LENGTH**2 / (16 * MODULUS * section.inertia_2), LENGTH**2 / (16 * MODULUS * section.inertia_1)]
    case.near("rotation of the end", turns, slopes, 1e-2, why="the same", place="x = 0", time="the end")
    case.near("reactions", float(job.last("RF").sum(axis=0)[2]), -2.0, 1e-9, why="the equation has no force", place="both ends", time="the end")
    case.done()


def test_hinged_beam_with_torque(run_deck: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    """A moment about the axis of a hinged beam finds no resistance: the job says so."""
    deck = beam("B31", rectangle(0.4, 0.6), n=4) + "*BOUNDARY\n1, 1, 3\n5, 2, 3\n*STEP\n*STATIC\n*CLOAD\n3, 4, 1.\n*END STEP\n"
    done = run_deck(deck)
    assert done.returncode != 0
    assert "can turn about x" in " ".join((done.stdout + done.stderr).split())


@pytest.mark.parametrize("kind", ["B31", "B32"])
def test_pretension(proof: Proof, kind: str) -> None:
    """A beam as a bolt between two walls."""
    case = proof(
        f"pretension-beam-{kind.lower()}",
        title=f"Pre-tension of a beam of {kind}",
        model="Length 10, ten elements of a rectangle 0.4 x 0.6, E = 2.1e5, nu = 0.3, clamped at both ends; a pre-tension section in the fifth element with the force 100, then held and "
        "a force 10 along x in the middle.",
        formula="The section closes by F L/(E A); SF1 = 100 everywhere, then 100 + 5 before and 100 - 5 behind the force.",
        source="R. C. Juvinall, K. M. Marshek, Fundamentals of Machine Component Design: springs in series",
        proves="Pre-tension sections of beams: force, displacement of the pre-tension node, fixed length.",
    )
    section = rectangle(0.4, 0.6)
    per = 2 if kind == "B32" else 1
    middle, last = 5 * per + 1, 10 * per + 1
    deck = beam(kind, section, n=10) + f"*NODE\n999, 0., 5., 0.\n*PRE-TENSION SECTION, ELEMENT=5, NODE=999\n*BOUNDARY\n1, ENCASTRE\n{last}, ENCASTRE\n"
    deck += "*STEP\n*STATIC\n*CLOAD\n999, 1, 100.\n*EL PRINT, ELSET=E\nSF\n*END STEP\n"
    deck += f"*STEP\n*STATIC\n*CLOAD, OP=NEW\n{middle}, 1, 10.\n*BOUNDARY, FIXED\n999, 1\n*EL PRINT, ELSET=E\nSF\n*END STEP\n"
    job = case.run(deck, "the bolt")
    node = int(np.argmin(np.abs(job.points - np.array([0.0, 5.0, 0.0])).sum(axis=1)))
    closed = float(job.field("U")[job.frame(1.0), node, 0])
    case.near("the section closes by", closed, 100 * LENGTH / (MODULUS * section.area), 0.02, why="Poisson's strain is held at both clamps", place="the pre-tension node", time="t = 1")
    blocks = [block for block in read_dat(job.path.with_suffix(".dat")) if block.title.startswith("section forces")]
    forces = [np.array([block.rows[key][0] for key in sorted(block.rows)]) for block in blocks]
    case.near("SF1", forces[0], np.full(10, 100.0), 1e-6, why="statics", place="all elements", time="t = 1")
    jump = np.r_[np.full(5, 105.0), np.full(5, 95.0)]
    case.near("SF1 with the force", forces[1], jump, 2e-3, why="both halves are alike but for the place of the section", place="all elements", time="t = 2")
    case.done()


TURNS = {"moment": ("*CLOAD\nEND, 6, 1.\n", lambda i: LENGTH / (MODULUS * i), True), "rotation": ("*BOUNDARY\nEND, 6, 6, .01\n", lambda _: 0.01 * LENGTH / 2, False),
         "guided": ("*BOUNDARY\nEND, 6, 6\n*CLOAD\nEND, 2, 1.\n", lambda i: LENGTH**3 / (12 * MODULUS * i), False)}  # fmt: skip


@pytest.mark.parametrize("load", TURNS)
@pytest.mark.parametrize("n", [10, 40])
@pytest.mark.parametrize(("kind", "name"), [("B31", "rect"), ("B31", "circ"), ("B31", "pipe"), ("B32", "rect"), ("B32", "circ"), ("B22", "rect")])
def test_ends_that_turn(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, kind: str, name: str, n: int, load: str) -> None:
    """A moment turns the end by M L / (E I), a prescribed rotation deflects it by turn L / 2, and an end that may not turn deflects by
    F L^3 / (12 E I), on any mesh: the cross-section at which rotations or moments are given stays plane. Limit: 1 %, shear and the clamp.
    """
    section = {"rect": rectangle(0.4, 0.6), "circ": circle(0.3), "pipe": pipe(0.3, 0.05)}[name]
    deck = beam(kind, section, ".6, .4" if kind == "B22" else "", n=n)
    if kind == "B22":
        deck = deck.replace("0., 1., 0.\n", "")
    cards, closed_form, is_rotation = TURNS[load]
    done = run_deck(deck + step(cards).replace("*END", "*NODE PRINT, NSET=END\nU, UR\n*END"))
    assert done.returncode == 0, done.stdout + done.stderr
    moved, turned = (list(block.rows.values())[0] for block in read_dat(tmp_path / "job.dat")[:2])
    assert (turned[2] if is_rotation else moved[1]) == pytest.approx(closed_form(section.inertia_1), rel=0.01)
