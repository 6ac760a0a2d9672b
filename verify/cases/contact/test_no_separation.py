"""Surfaces that do not part once they have touched (*SURFACE BEHAVIOR, NO SEPARATION): bodies pressed, pulled and dragged.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks.grids import Body, bodies_deck, grid
from verify.decks.make_decks import Floats
from verify.decks.parts import Part
from verify.decks.sheets import between, fix

Proof = Callable[..., Case]
YOUNG, NU, MU = 1000.0, 0.3, 0.3
KINDS = {"nodes": "NODE TO SURFACE", "surfaces": "SURFACE TO SURFACE"}
COULOMB, ROUGH = f"*FRICTION\n{MU}\n", "*FRICTION, ROUGH\n"
FRICTION = {"smooth": "", "Coulomb": COULOMB, "rough": ROUGH}
SLIDING = {"finite": "", "small": ", SMALL SLIDING"}
BONDED = "*SURFACE BEHAVIOR, NO SEPARATION\n"
ELASTIC = f"*ELASTIC\n{YOUNG}, {NU}\n"
PRESSED, PULLED = 10.0, 20.0


def pair(kind: str, friction: str = "", behavior: str = BONDED, name: str = "I", surfaces: str = "UP_W0, LOW_W1", options: str = "") -> str:
    """An interaction and its pair."""
    return f"*SURFACE INTERACTION, NAME={name}\n{behavior}{friction}*CONTACT PAIR, INTERACTION={name}, TYPE={KINDS[kind]}{options}\n{surfaces}\n"


def blocks(cells: tuple[int, int], height: float = 1.0, gap: float = 0.0, margin: float = 0.0) -> list[Body]:
    """A block of edge 1 over a block that is wider by a margin on each side."""
    wide, narrow = between(-margin, 1 + margin, cells[0]), between(0, 1, cells[1])
    return [grid("LOW", wide, wide, between(-1, 0, 2)), grid("UP", narrow, narrow, between(gap, height + gap, 2))]


def deck(bodies: list[Body], cards: str, elastic: str = ELASTIC, kind: str = "C3D8") -> str:
    """All of it in the abaqus dialect."""
    return "** dialect: abaqus\n" + bodies_deck([(body, elastic) for body in bodies], kind, cards)


def step(cards: str, n: int = 1, words: str = ", NLGEOM", static: str = "") -> str:
    """A step in n increments."""
    return f"*STEP{words}\n*STATIC{static}\n{1 / n:.10g}, 1., 1e-6, {1 / n:.10g}\n{cards}*END STEP\n"


class Answer:
    """Fields of a job by frame, the initial state first, and the nodes of its two bodies."""

    def __init__(self, path: Path, n_low: int) -> None:
        with h5py.File(path) as file:
            data, n = file["VTKHDF/PointData"], len(file["VTKHDF/Points"])
            self.place = np.asarray(file["VTKHDF/Points"])
            self.fields = {name: np.asarray(data[name]).reshape(-1, n, *np.asarray(data[name]).shape[1:])
                           for name in ("U", "RF", "CPRESS", "CSHEAR", "CSTATUS", "S")}
            self.iterations = np.asarray(file["AMONTONS/history/n_iterations"])[1:]
            self.n_failed = int(np.asarray(file["AMONTONS/history/n_cutbacks"]).max())
        self.n_low = n_low
        height = self.place[n_low:, 2]
        self.foot = n_low + np.flatnonzero(height < min(height, default=0.0) + 1e-9)

    def at_foot(self, name: str, frame: int = -1) -> Floats:
        """A field at the slave nodes."""
        return self.fields[name][frame][self.foot]

    def force(self, frame: int = -1) -> Floats:
        """The reaction of the lower block."""
        return self.fields["RF"][frame][: self.n_low].sum(axis=0)


def solved(run_deck: Run, folder: Path, bodies: list[Body], cards: str, **options: str) -> Answer:
    """Runs a deck that has to finish."""
    done = run_deck(deck(bodies, cards, **options))
    assert done.returncode == 0, done.stdout + done.stderr
    return Answer(folder / "job.vtkhdf", len(bodies[0].nodes))


@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("sliding", SLIDING)
@pytest.mark.parametrize("kind", KINDS)
def test_bar(proof: Proof, kind: str, sliding: str, friction: str) -> None:
    """Two blocks, pressed and then pulled, are one bar."""
    case = proof(
        f"no-separation-bar-{kind}-{sliding}-{friction}",
        title=f"Two blocks that do not part are one bar ({kind}, {sliding} sliding, {friction})",
        model=f"Two blocks of edge 1 (E = {YOUNG:g}, nu = {NU:g}) on each other, with planes of symmetry, NO SEPARATION; 3 x 3 x 2 C3D8 each by nodes, the lower "
        f"one 2 x 2 x 2 by surfaces. A pressure of {PRESSED:g} on top in one step, a tension of {PULLED:g} in the next one, without NLGEOM.",
        formula="u = sigma H/E with H = 2; contact pressure -sigma.",
        source="Hooke",
        proves="Nodes that have touched bear any tension, as a bar that is one body.",
    )
    held = fix("LOW_W0, 3, 3", *(f"{b}_{side}, {axis}, {axis}" for b in ("LOW", "UP") for side, axis in (("S0", 1), ("T0", 2))))
    cards = pair(kind, FRICTION[friction], options=SLIDING[sliding])
    cards += step(held + f"*DSLOAD\nUP_W1, P, {PRESSED}\n", words="") + step(f"*DSLOAD\nUP_W1, P, {-PULLED}\n", words="")
    bodies = blocks((3 if kind == "nodes" else 2, 3))
    job = case.run(deck(bodies, cards), requested=2)
    answer = Answer(job.path, len(bodies[0].nodes))
    top = np.abs(answer.place[:, 2] - 1.0) < 1e-9
    for frame, sigma in ((1, -PRESSED), (2, PULLED)):
        words = {"why": "in the space of the elements", "time": f"sigma = {sigma:g}"}
        case.near("displacement of the top", answer.fields["U"][frame, top, 2], 2 * sigma / YOUNG, 1e-9, place="top", **words)
        case.near("contact pressure", answer.at_foot("CPRESS", frame), -sigma, 1e-9, place="all slave nodes", **words)
        case.near("force on the lower block", answer.force(frame)[2], -sigma, 1e-9, place="its floor", **words)
        case.near("stress zz", answer.fields["S"][frame, :, 2], sigma, 1e-9, place="all nodes", **words)
    case.done()


@pytest.mark.parametrize("kind", KINDS)
def test_friction_of_a_dragged_block(proof: Proof, kind: str) -> None:
    """A flat block is dragged over a table under a pressure, then under a tension, then under a pressure again."""
    case = proof(
        f"no-separation-dragged-{kind}",
        title=f"A block that does not part from its table is dragged under pressure and tension ({kind})",
        model=f"A block 1 x 1 x 0.25 (E = {YOUNG:g}, nu = 0, 3 x 3 x 2 C3D8) on a rigid table of other facets, mu = {MU:g}, NO SEPARATION, NLGEOM: its top is dragged by "
        f"0.1 under a pressure of {PRESSED:g}, to 0.5 under a tension of {PULLED:g}, back to 0.3 under {PRESSED:g}; two increments each.",
        formula="The table's reaction is N along z, and mu N along x in compression, against the motion; 0 along x in tension, where u_z = 0 at the foot and the pressure "
        "is uniform.",
        source="equilibrium, Coulomb",
        proves="A node in tension slides without friction on the surface of its master, over its edges, and has friction again when it is pressed.",
    )
    cards = pair(kind, COULOMB)
    path = [(0.0, PRESSED, 0.0), (0.1, PRESSED, -MU * PRESSED), (0.1, -PULLED, 0.0), (0.5, -PULLED, 0.0), (0.5, PRESSED, 0.0), (0.3, PRESSED, MU * PRESSED)]
    for i, (x, p, _) in enumerate(path):
        cards += step((fix("LOW, 1, 3", "UP_W1, 2, 2") if i == 0 else "") + fix(f"UP_W1, 1, 1, {x}") + f"*DSLOAD\nUP_W1, P, {p}\n", 2)
    bodies = blocks((6, 3), 0.25, margin=1.0)
    job = case.run(deck(bodies, cards, f"*ELASTIC\n{YOUNG}, 0.\n"), requested=2 * len(path))
    answer = Answer(job.path, len(bodies[0].nodes))
    case.true("no attempt fails", answer.n_failed == 0, why="where a tension turns into pressure, nodes stick at once", place="whole model", time="whole job")
    for i, (x, p, along) in enumerate(path):
        frame, time = 2 * i + 2, f"dragged to {x:g} under {p:g}"
        case.near("reaction of the table", answer.force(frame), [along, 0.0, p], 2e-6, why="1e-6 of the largest force is the criterion of Newton's method", scale=abs(p),
                  place="table", time=time)  # fmt: skip
        case.near("height of the foot", answer.at_foot("U", frame)[:, 2], 0.0, 1e-9, why="exact contact", scale=1.0, place="foot", time=time)
        if p < 0:
            case.near("pressure in tension", answer.at_foot("CPRESS", frame), p, 1e-4, why="criterion of Newton's method over the nodes of a facet", place="foot", time=time)
    case.done()


@pytest.mark.parametrize("solver", ["", ", SOLVER=CONJUGATE GRADIENTS"], ids=["newton", "gradients"])
@pytest.mark.parametrize("kind", KINDS)
def test_heel_in_tension(run_deck: Run, tmp_path: Path, kind: str, solver: str) -> None:
    """A cube whose top is drawn along pulls with its heel and presses with its toe: each node has the friction of its own pressure."""
    mu = 0.8
    cards = pair(kind, f"*FRICTION\n{mu}\n")
    cards += step(fix("LOW, 1, 3", "UP_W1, 1, 2", "UP_W1, 3, 3, -0.001"), static=solver)
    cards += step(fix("UP_W1, 1, 1, 0.1"), 4, static=solver) + step(fix("UP_W1, 1, 1, -0.1"), 4, static=solver)
    answer = solved(run_deck, tmp_path, blocks((6, 4), margin=1.0), cards)
    for frame in (5, 9):
        p, tau = answer.at_foot("CPRESS", frame), np.linalg.norm(answer.at_foot("CSHEAR", frame), axis=1)
        assert p.min() < -1.0 < 1.0 < p.max()
        assert tau == pytest.approx(mu * np.maximum(p, 0.0), abs=2e-5 * p.max())
        assert np.all(answer.at_foot("CSTATUS", frame) == 2)
        assert np.abs(answer.at_foot("U", frame)[:, 2]).max() < 1e-9
    if not solver:
        assert answer.n_failed == 0
        assert answer.iterations.max() <= 4, answer.iterations   # of semismooth Newton iterations at the kink of the friction


@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_before_first_touch(run_deck: Run, tmp_path: Path, kind: str, friction: str) -> None:
    """A block 0.01 over a table is lifted by 0.01, put on it and lifted again: p = E u/H from where it touched."""
    cards = pair(kind, FRICTION[friction]) + "".join(
        step((fix("LOW, 1, 3", "UP_W1, 1, 2") if i == 0 else "") + fix(f"UP_W1, 3, 3, {z}"), 4, words="") for i, z in enumerate((0.01, -0.02, 0.03)))
    answer = solved(run_deck, tmp_path, blocks((4, 3), gap=0.01, margin=0.5), cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    for frame, pressure, status in ((4, 0.0, {0}), (8, 10.0, {1, 2}), (12, -40.0, {1} if friction == "rough" else {2})):
        assert answer.at_foot("CPRESS", frame) == pytest.approx(pressure, abs=1e-7)
        assert set(answer.at_foot("CSTATUS", frame).tolist()) <= status
    assert answer.at_foot("U", 4)[:, 2] == pytest.approx(0.01, abs=1e-9)
    assert answer.at_foot("U", 12)[:, 2] == pytest.approx(-0.01, abs=1e-12)


@pytest.mark.parametrize(("element", "kind"), [("C3D8", "nodes"), ("C3D8", "surfaces"), ("C3D10", "surfaces"), ("C3D20R", "surfaces")])
def test_rough_is_bonded(run_deck: Run, tmp_path: Path, element: str, kind: str) -> None:
    """ROUGH too: pulled and sheared, two blocks are one body of the same mesh."""
    low = Part("LOW", element, (0.0, 0.0, -1.0), (1.0, 1.0, 0.0), (2, 2, 2))
    up = Part("UP", element, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (2, 2, 2), 1001)
    one = Part("ONE", element, (0.0, 0.0, -1.0), (1.0, 1.0, 1.0), (2, 2, 4))
    loads = step(fix("{}_Z0N, 1, 3", "{}_Z1N, 1, 1, 0.05", "{}_Z1N, 2, 2", "{}_Z1N, 3, 3, 0.02"), 2)
    results = []
    for parts, cards in (((low, up), pair(kind, ROUGH, surfaces="UP_Z0, LOW_Z1") + loads.replace("{}_Z0N", "LOW_Z0N").replace("{}_Z1N", "UP_Z1N")),
                         ((one,), loads.replace("{}", "ONE"))):  # fmt: skip
        sections = "".join(f"*SOLID SECTION, ELSET={part.name}, MATERIAL=M\n" for part in parts)
        done = run_deck("** dialect: abaqus\n" + "".join(part.cards() for part in parts) + f"*MATERIAL, NAME=M\n{ELASTIC}{sections}{cards}")
        assert done.returncode == 0, done.stdout + done.stderr
        results.append(Answer(tmp_path / "job.vtkhdf", len(parts[0].nodes)))
    two, whole = results
    number = [int(np.argmin(np.linalg.norm(whole.place - x, axis=1))) for x in two.place]
    assert two.fields["U"][-1] == pytest.approx(whole.fields["U"][-1][number], abs=1e-7)
    assert two.at_foot("CPRESS").min() < -1.0


@pytest.mark.parametrize("kind", KINDS)
def test_slave_of_a_rigid_body(run_deck: Run, tmp_path: Path, kind: str) -> None:
    """Slave nodes of a rigid body have a penalty K = 100 E/a, in tension too: p = d/(H/E + 1/K), springs in series."""
    n, down = 2, 0.01
    cards = "*NODE\n9001, 0.5, 0.5, 1.\n*RIGID BODY, ELSET=UP, REF NODE=9001\n" + pair(kind)
    cards += step(fix("LOW_W0, 1, 3", "9001, 1, 2", "9001, 4, 6", f"9001, 3, 3, {-down}"), words="") + step(fix(f"9001, 3, 3, {2 * down}"), words="")
    bodies = [grid("LOW", between(0, 1, n), between(0, 1, n), between(-1, 0, n)), grid("UP", between(0, 1, n), between(0, 1, n), between(0, 0.5, 1))]
    answer = solved(run_deck, tmp_path, bodies, cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    for frame, moved in ((1, -down), (2, 2 * down)):
        assert answer.at_foot("CPRESS", frame) == pytest.approx(-moved / (1 / YOUNG + 1 / (100 * YOUNG * n)), rel=1e-8)


@pytest.mark.parametrize("friction", ["smooth", "rough"])
def test_cube_in_a_corner(run_deck: Run, tmp_path: Path, friction: str) -> None:
    """Pulled out of the corner of three walls: the stress is that of the pull, and with ROUGH that of a cube bonded to them."""
    lines, wide, thin = between(0, 1, 3), between(-0.5, 1.5, 2), between(-0.5, 0, 1)
    cube = grid("UP", lines, lines, lines)
    walls = [grid("LOW", wide, wide, thin), grid("WALLX", thin, wide, wide), grid("WALLY", wide, thin, wide)]
    cards = "".join(pair("nodes", FRICTION[friction], name=f"I{wall}", surfaces=f"UP_{side}, {wall}_{face}")
                    for wall, side, face in (("LOW", "W0", "W1"), ("WALLX", "S0", "S1"), ("WALLY", "T0", "T1")))  # fmt: skip
    held = fix("LOW, 1, 3", "WALLX, 1, 3", "WALLY, 1, 3")
    load = f"*DSLOAD\nUP_W1, P, {-PULLED}\nUP_S1, P, {-PULLED}\nUP_T1, P, {-PULLED}\n"
    n = sum(len(wall.nodes) for wall in walls)
    done = run_deck(deck([*walls, cube], cards + step(held + load, words="")))
    assert done.returncode == 0, done.stdout + done.stderr
    answer = Answer(tmp_path / "job.vtkhdf", n)
    assert answer.force() == pytest.approx(-PULLED * np.ones(3), rel=1e-9)
    if friction == "smooth":
        assert answer.fields["S"][-1][n:, :3] == pytest.approx(PULLED, rel=1e-8)
        return
    displacement = answer.fields["U"][-1][n:]
    held = fix("UP_W0, 1, 3", "UP_S0, 1, 3", "UP_T0, 1, 3")
    done = run_deck(deck([cube], step(held + load, words="")))
    assert done.returncode == 0, done.stdout + done.stderr
    assert displacement == pytest.approx(Answer(tmp_path / "job.vtkhdf", 0).fields["U"][-1], abs=1e-9)


def test_both_sides_are_slaves(run_deck: Run, tmp_path: Path) -> None:
    """A symmetric pair: slaves of one side give way, those of the other bear the tension, and the bar is whole."""
    cards = pair("nodes") + "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nLOW_W1, UP_W0\n"
    held = fix("LOW_W0, 1, 3", "UP_W1, 1, 2")
    cards += step(held + fix("UP_W1, 3, 3, -0.01")) + step(fix("UP_W1, 3, 3, 0.02"), 3)
    answer = solved(run_deck, tmp_path, blocks((3, 3)), cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    one = solved(run_deck, tmp_path, [grid("LOW", between(0, 1, 3), between(0, 1, 3), between(-1, 1, 4))],
                 step(fix("LOW_W0, 1, 3", "LOW_W1, 1, 2", "LOW_W1, 3, 3, 0.02")), elastic=f"*ELASTIC\n{YOUNG}, 0.\n")  # fmt: skip
    assert answer.force()[2] == pytest.approx(one.fields["RF"][-1][one.place[:, 2] < -0.9][:, 2].sum(), rel=1e-6)


@pytest.mark.parametrize("behavior", [BONDED, ""], ids=["kept", "free to part"])
def test_friction_from_a_step_on(run_deck: Run, tmp_path: Path, behavior: str) -> None:
    """A block that slipped without friction gets it in a step: it sticks at once. As slipping it had friction in a direction of rounding, so that
    the matrix was singular in all attempts."""
    cards = pair("nodes", "*FRICTION\n0.\n", behavior)
    cards += step(fix("LOW, 1, 3", "UP_W1, 1, 2") + f"*DSLOAD\nUP_W1, P, {PRESSED}\n", 2)
    cards += step(f"*CHANGE FRICTION, INTERACTION=I\n{COULOMB}*DSLOAD\nUP_W1, P, {PULLED}\n", 2)
    answer = solved(run_deck, tmp_path, blocks((6, 3), 0.25, margin=1.0), cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    assert answer.n_failed == 0
    assert set(answer.at_foot("CSTATUS").tolist()) == {1}
    assert answer.force() == pytest.approx([0.0, 0.0, PULLED], abs=1e-5)


def test_self_contact(run_deck: Run, tmp_path: Path) -> None:
    """The faces of both blocks as one surface in contact with itself."""
    low, up = blocks((3, 3))
    faces = [(e + 1, f) for e, f in low.sides["W1"]] + [(len(low.elements) + e + 1, f) for e, f in up.sides["W0"]]
    cards = "*SURFACE, NAME=BOTH\n" + "".join(f"{e}, S{f}\n" for e, f in faces)
    cards += f"*SURFACE INTERACTION, NAME=I\n{BONDED}*CONTACT PAIR, INTERACTION=I\nBOTH,\n"
    cards += step(fix("LOW_W0, 1, 3", "UP_W1, 1, 2", "UP_W1, 3, 3, -0.01")) + step(fix("UP_W1, 3, 3, 0.02"), 2)
    answer = solved(run_deck, tmp_path, [low, up], cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    assert answer.force(1)[2] == pytest.approx(YOUNG * 0.01 / 2, rel=0.01)   # NLGEOM
    assert answer.force()[2] == pytest.approx(-YOUNG * 0.02 / 2, rel=0.02)


@pytest.mark.parametrize("status", ["resumed by a file", "in one run"])
def test_state_is_in_the_restart_file(run: Run, tmp_path: Path, status: str) -> None:
    """That nodes have touched is known to a job that begins with the pull."""
    model = deck(blocks((3, 3)), pair("surfaces", COULOMB), f"*ELASTIC\n{YOUNG}, 0.\n")
    steps = [step(fix("LOW_W0, 1, 3", "UP_W1, 1, 2", "UP_W1, 3, 3, -0.01")), step(fix("UP_W1, 3, 3, 0.02"))]
    if status == "in one run":
        (tmp_path / "new.inp").write_text(model + "".join(steps))
    else:
        (tmp_path / "old.inp").write_text(model + "*RESTART, WRITE\n" + steps[0])
        assert run(["--quiet", "old"], cwd=tmp_path).returncode == 0
        (tmp_path / "new.inp").write_text("*RESTART, READ, STEP=1\n" + steps[1])
    done = run(["--quiet", *(["--oldjob", "old"] if status != "in one run" else []), "new"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert Answer(tmp_path / "new.vtkhdf", len(blocks((3, 3))[0].nodes)).force()[2] == pytest.approx(-YOUNG * 0.01, rel=0.02)


def test_separation_from_a_step_on(run_deck: Run, tmp_path: Path) -> None:
    """A step whose law lets surfaces part releases what hung."""
    cards = pair("nodes") + step(fix("LOW, 1, 3", "UP_W1, 1, 2", "UP_W1, 3, 3, -0.01"), words="") + step(fix("UP_W1, 3, 3, 0.01"), words="")
    cards += step("*CHANGE SURFACE BEHAVIOR, INTERACTION=I\n*SURFACE BEHAVIOR\n", words="")
    answer = solved(run_deck, tmp_path, blocks((3, 3)), cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    assert answer.at_foot("CPRESS", 2) == pytest.approx(-10.0, rel=1e-9)
    assert np.all(answer.at_foot("CPRESS", 3) == 0.0)
    assert answer.at_foot("U", 3)[:, 2] == pytest.approx(0.01, rel=1e-9)


def test_analytic_master(run_deck: Run, tmp_path: Path) -> None:
    """A cube hangs on a rigid plane that is lifted and drawn along: it follows up, and not along."""
    cards = "*NODE\n9001, 0., 0., 0.\n*SURFACE, NAME=TABLE, TYPE=CYLINDER\n0., 0., 0., -1., 0., 0.\n0., 1., 0.\nSTART, 9., 0.\nLINE, -9., 0.\n"
    cards += "*RIGID BODY, ANALYTICAL SURFACE=TABLE, REF NODE=9001\n" + pair("nodes", COULOMB, surfaces="UP_W0, TABLE")
    cards += step(fix("9001, 1, 6", "UP_S0, 1, 1", "UP_T0, 2, 2") + f"*DSLOAD\nUP_W1, P, {PRESSED}\n")
    cards += step(fix("9001, 3, 3, 0.3", "9001, 1, 1, 0.4") + f"*DSLOAD\nUP_W1, P, {-PULLED}\n", 2)
    bodies = [grid("UP", between(0, 1, 2), between(0, 1, 2), between(0, 1, 2))]
    done = run_deck(deck(bodies, cards, f"*ELASTIC\n{YOUNG}, 0.\n"))
    assert done.returncode == 0, done.stdout + done.stderr
    answer = Answer(tmp_path / "job.vtkhdf", 0)
    foot = np.flatnonzero(answer.place[: len(bodies[0].nodes), 2] < 1e-9)
    assert answer.fields["U"][-1][foot] == pytest.approx(np.tile([0.0, 0.0, 0.3], (len(foot), 1)), abs=1e-6)
    assert answer.fields["RF"][-1][len(bodies[0].nodes)] == pytest.approx([0.0, 0.0, -PULLED], abs=2e-4)


def test_general_contact(run_deck: Run, tmp_path: Path) -> None:
    """The property of all faces: a block is lifted off by its neighbour, which hangs on it."""
    cards = f"*SURFACE INTERACTION, NAME=I\n{BONDED}*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PROPERTY ASSIGNMENT\n, , I\n"
    cards += step(fix("UP_W1, 1, 2", "UP_W1, 3, 3, 0.01", "LOW_W0, 1, 3"))
    answer = solved(run_deck, tmp_path, blocks((3, 3)), cards, elastic=f"*ELASTIC\n{YOUNG}, 0.\n")
    assert answer.force()[2] == pytest.approx(-YOUNG * 0.01 / 2, rel=0.01)   # NLGEOM


@pytest.mark.parametrize(("dialect", "words", "sentence"), [
    ("abaqus", ", PRESSURE-OVERCLOSURE=LINEAR\n1000.", "NO SEPARATION is of hard contact"),
    ("abaqus", ", PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n1., 1.", "NO SEPARATION is of hard contact"),
    ("calculix", "", "CalculiX does not know NO SEPARATION"),
])  # fmt: skip
def test_refused(run_deck: Run, dialect: str, words: str, sentence: str) -> None:
    """Laws of pressure have none in tension, as in Abaqus/Standard; CalculiX has no such parameter."""
    behavior = f"*SURFACE BEHAVIOR, NO SEPARATION{words}\n"
    text = deck(blocks((2, 2)), pair("nodes", behavior=behavior) + step(fix("LOW, 1, 3", "UP, 1, 3"))).replace("dialect: abaqus", f"dialect: {dialect}")
    done = run_deck(text)
    assert done.returncode == 3
    assert sentence in done.stdout + done.stderr
