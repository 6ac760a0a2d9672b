"""The same results on the dense interface and by the contact skin: two plates, pressed and dragged, under all laws and formulations;
then small decks of everything else that contact does.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import amontons
from verify.benchmark.wide_contact import Model, deck_of, timed
from verify.cases.contact import test_dependent_slaves
from verify.cases.contact.test_gap_of_quadratic_bodies import two_blocks
from verify.cases.proof import Job
from verify.cases.solution import test_failure_report
from verify.conftest import Run
from verify.decks import behaviour_decks, feature_decks, joint_decks, loose_bodies
from verify.decks.feature_decks import SOFT, bodies, sections, step
from verify.decks.parts import Part
from verify.decks.sheets import fix
from verify.invariance.scaling import cards, keyword
from verify.invariance.test_contact_cases import CASES
from verify.library import test_user_contact as user

MODELS = {
    "hard": Model(8, increments=4, dome=0.0),
    "hard, surface to surface": Model(8, kind="surface", increments=4, dome=0.0),
    "hard, NLGEOM": Model(8, is_nlgeom=True, increments=4, dome=0.0),
    "hard, thick": Model(6, thickness=0.5, mu=0.8, increments=4, dome=0.0),
    "hard, domed without friction": Model(8, mu=0.0, increments=4),
    "surface to surface, domed without friction": Model(8, kind="surface", mu=0.0, increments=4),
    "hard, domed": Model(8, increments=5),
    "hard, domed, surface to surface": Model(8, kind="surface", increments=5),
    "hard, domed, NLGEOM": Model(8, is_nlgeom=True, increments=5),
    "hard, blocks": Model(5, is_block=True, increments=5),
    "linear": Model(8, law="linear", increments=4, criteria=1e-7),
    "linear, domed": Model(10, law="linear", increments=5, criteria=1e-7),
    "linear, integration points": Model(5, law="linear", kind="surface", increments=10, criteria=1e-7),
}


@pytest.mark.parametrize("name", MODELS)
def test_both_interfaces(run: Run, tmp_path: Path, name: str) -> None:
    """The statuses are the same and no attempt fails; fields agree to 1e-6 of the largest, Newton's tolerance. Nodes that close
    within an increment have the same origin of slip on both."""
    jobs = []
    for interface in ("DENSE", "SKIN"):
        (tmp_path / f"{interface}.inp").write_text(deck_of(MODELS[name], interface))
        done = run([interface], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        jobs.append(Job(tmp_path / f"{interface}.vtkhdf", interface))
        assert not jobs[-1].history["n_cutbacks"].any()
    dense, skin = jobs
    assert skin.history["n_krylov"].sum() > 2 * dense.history["n_krylov"].sum(), "the second job did not use the skin"
    assert (skin.last("CSTATUS") == dense.last("CSTATUS")).all()
    for field, scale in (("U", "U"), ("CNORMF", "CNORMF"), ("CSHEARF", "CNORMF")):
        largest = np.abs(dense.last(scale)).max()
        assert np.abs(skin.last(field) - dense.last(field)).max() <= 1e-6 * largest, field


BY_FACES = ", TYPE=SURFACE TO SURFACE"
TAUMAX = "*SURFACE INTERACTION, NAME=I\n*FRICTION, TAUMAX=2.\n0.3\n"
FLIGHT = 1e-5  #: blocks touch down where rounding says, and friction remembers it (test_every_case)


def test_memory_does_not_grow_with_the_increments(program: Path, tmp_path: Path) -> None:
    """Ten times the increments take at most 4 MB more, tables of the result file included (8 MB where an iteration lost its vectors)."""
    peaks = []
    for increments in (4, 40):
        folder = tmp_path / str(increments)
        folder.mkdir()
        (folder / "job.inp").write_text(deck_of(Model(6, increments=increments, is_nlgeom=True), "SKIN"))
        cost = timed([str(program), "--no-checkpoint", "job.inp"], folder, 1, 600.0)
        assert cost.ended == 0
        peaks.append(cost.megabytes)
    assert peaks[1] - peaks[0] < 4.0


def theirs(text: str) -> str:
    """A deck in CalculiX's dialect."""
    return "** dialect: calculix\n" + text


def joined_bodies() -> str:
    """A half of a block of two parts, tied, on a half of a wider one: one motion of the top along z by equations, a symmetry plane."""
    low = Part("A", "C3D8", (0, -0.3, -0.6), (1.5, 1.4, 0), (3, 4, 2))
    middle, top = Part("B", "C3D8", (0, 0, 0), (1, 1, 0.5), (2, 3, 2), 1001), Part("C", "C3D8", (0, 0, 0.5), (1, 1, 1), (3, 2, 1), 2001)
    first, *others = top.nodes_on("Z1")
    text = bodies(low, middle, top) + SOFT + sections("A", "B", "C") + "*TIE, NAME=T1\nC_Z0, B_Z1\n"
    text += "*EQUATION\n" + "".join(f"2\n{node}, 3, 1., {first}, 3, -1.\n" for node in others)
    text += "*SURFACE INTERACTION, NAME=SI\n*FRICTION\n.3\n*CONTACT PAIR, INTERACTION=SI\nB_Z0, A_Z1\n"
    text += fix("A_Z0N, 1, 3", "A_X0N, 1", "B_X0N, 1", "C_X0N, 1", "C_Z1N, 2")
    return text + step(f"*CLOAD\n{first}, 3, -40.\n", static="*STATIC\n.5, 1.\n") + step(fix("C_Z1N, 2, 2, .01"), static="*STATIC\n.25, 1.\n")


def stabilized() -> str:
    """Plates of which the upper one is damped, so that the bulk changes with the length of the increment."""
    return deck_of(Model(5, increments=4)).replace("*STATIC\n", "*STATIC, STABILIZE\n")


def dependent(by: str, kind: str) -> str:
    """Slave nodes that depend on others."""
    held = fix("FLOOR, 1, 3", "PLATE, 1, 2" if by == "equations" else "9001, 1, 2", *([] if by == "equations" else ["9001, 4, 6"]), "9001, 3, 3, -0.01")
    text = test_dependent_slaves.equations(4) if by == "equations" else test_dependent_slaves.BY[by]
    return test_dependent_slaves.deck(4, text, "*STEP\n*STATIC\n1., 1.\n" + held + "*END STEP\n", 0.0, kind)


BEHAVIOUR, JOINTS, FEATURES = behaviour_decks.cases(), joint_decks.cases(), dict(feature_decks.contact_cases())
DECKS: dict[str, Callable[[], str]] = {
    **{f"quadratic faces, {kind}, {form.lower()}": partial(two_blocks, kind, form) for kind in ("C3D10", "C3D20") for form in ("NODE TO SURFACE", "SURFACE TO SURFACE")},
    **{f"quadratic faces, {name}": partial(theirs, FEATURES[name]) for name in ("contact-C3D10-s", "contact-C3D20-n", "contact-C3D20-m")},
    **{f"faces, {name}": partial(theirs, JOINTS[name]) for name in ("dome-C3D8-s", "lap-moved-s", "warming-s")},
    **{f"mortar, {name}": partial(theirs, BEHAVIOUR[name]) for name in ("drag-C3D8I-m", "gaps-m", "table-m")},
    **{f"several pairs, {name}": partial(theirs, JOINTS[name]) for name in ("stack-n", "stack-hard-s")},
    **{f"several pairs, {name}": partial(theirs, BEHAVIOUR[name]) for name in ("chain-up-n", "chain-down-s")},
    "shared nodes, both sides": partial(theirs, BEHAVIOUR["both-sides-n"]),
    **{f"shared nodes, {name}": CASES[name] for name in ("chain", "corner", "corner of three walls", "groove", "symmetric pair")},
    **{f"TAUMAX{word}": partial(user.rubbed, TAUMAX, nlgeom=bool(word), dialect="abaqus") for word in ("", ", NLGEOM")},
    **{f"FRIC{word}": partial(user.rubbed, user.SOFT_FRIC, nlgeom=bool(word)) for word in ("", ", NLGEOM")},
    "UINTER": partial(user.rubbed, user.UINTER),
    "FRIC, exact contact": partial(user.rubbed, user.HARD_FRIC, dialect="abaqus"),
    "ties, equations, symmetry planes": joined_bodies,
    **{f"dependent slaves, {by}, {kind}": partial(dependent, by, word) for by in ("equations", "rigid body") for kind, word in test_dependent_slaves.KINDS.items()},
    "symmetry planes, quarter of a fit": CASES["quarter of a fit"],
    "symmetry planes, punch with a rigid head": partial(theirs, JOINTS["punch-tilted-n"]),
    **{f"loose bodies, {name}": CASES[name] for name in ("fall in the plane", "fall in space", "disc between plates", "pushed to a wall")},
    **{f"loose bodies, stack of {n}{form.lower()}": lambda n=n, form=form: loose_bodies.stack(n, 0.1, options=form).deck for n in (2, 4, 8) for form in ("", BY_FACES)},
    **{f"portions, {name}": CASES[name] for name in ("block dragged at once", "cylinder dragged at once")},
    "STABILIZE": stabilized,
    "creep": partial(theirs, JOINTS["relaxing-n"]),
    "plasticity": CASES["Prandtl's punch"],
    "pairs out and in": partial(theirs, JOINTS["out-and-in-n"]),
}
SHAKY = {"FRIC, exact contact": "the stiffness of Coulomb friction without elastic slip, mu p / |slip|, has no bound: rounding decides whether the iterations of the skin end"}


def with_interface(deck: str, interface: str, tight: float = 0.0) -> str:
    """The deck with an interface in each step, and with tight criteria or its own."""
    lines = [line for line in deck.splitlines() if re.match(r"\*\*\s*dialect", line, flags=re.I)]
    for card in cards(deck):
        if tight > 0 and keyword(card) == "CONTROLS" and "FIELD" in card[0].upper():
            continue
        if keyword(card) == "END STEP":
            lines.append(f"*LINE SEARCH, TYPE=AUTO, INTERFACE={interface}")
        lines += card
        if tight > 0 and keyword(card) in ("STATIC", "VISCO"):
            lines += ["*CONTROLS, PARAMETERS=FIELD", f"{tight:g}, {tight:g}, , , {tight:g}"]
    return "\n".join(lines) + "\n"


def solve(run: Run, folder: Path, deck: str, most_failed: int = 0) -> Job:
    """A job that has to finish, mostly without a failed attempt."""
    folder.mkdir(parents=True)
    (folder / "job.inp").write_text(deck)
    routine = [f"user={user.ROUTINES}"] if ", USER" in deck else []
    done = run(["--quiet", "--no-checkpoint", "job", *routine], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    job = Job(folder / "job.vtkhdf", folder.name)
    assert job.n_failed <= most_failed
    return job


def same_fields(skin: Job, dense: Job, tolerance: float) -> None:
    """All times; statuses at the end."""
    assert np.allclose(skin.times, dense.times, rtol=1e-12), "other increments"
    for field, scales in (("U", ["U"]), ("CNORMF", ["CNORMF", "CSHEARF"]), ("CSHEARF", ["CNORMF", "CSHEARF"])):
        largest = max(np.abs(dense.field(name)).max() for name in scales)
        assert np.abs(skin.field(field) - dense.field(field)).max() <= tolerance * largest, field
    assert (skin.last("CSTATUS") == dense.last("CSTATUS")).all()


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.xfail(strict=False, reason=SHAKY[name]) if name in SHAKY else []) for name in DECKS])
def test_both_interfaces_of(run: Run, tmp_path: Path, name: str) -> None:
    """With criteria of 1e-10 fields at all times agree to 1e-6 of the largest, statuses at the end are the same; with the deck's own
    criteria the skin takes at most half more iterations, and two, unless an attempt of a loose stack fails."""
    deck = DECKS[name]()
    dense, skin = (solve(run, tmp_path / f"tight {interface}", with_interface(deck, interface, 1e-10)) for interface in ("DENSE", "SKIN"))
    assert skin.history["n_krylov"].sum() > 2 * skin.n_iterations, "the second job did not use the skin"
    is_loose = "stack of" in name      # rounding decides whether bodies that contact alone holds converge at once
    same_fields(skin, dense, FLIGHT if is_loose else 1e-6)
    dense, skin = (solve(run, tmp_path / interface, with_interface(deck, interface), int(is_loose)) for interface in ("DENSE", "SKIN"))
    assert skin.n_failed > 0 or skin.n_iterations <= 1.5 * dense.n_iterations + 2


def test_both_interfaces_under_forces_of_the_library() -> None:
    """A program presses the plate with friction by forces that it sets, then moves its side."""
    results = []
    for interface in ("DENSE", "SKIN"):
        deck = deck_of(Model(5, increments=4, criteria=1e-9), interface)
        text = re.sub(r"\*DLOAD\n[^*]*", "*CLOAD\nUPPER_TOP, 3, 0.\n", deck)
        with amontons.Job(text=text) as job:
            for k in range(1, 4):
                job.set("CF3", "UPPER_TOP", -0.5 * k)
                job.set("U1", "SIDE", 2e-5 * (k - 1))
                job.try_step(0.25)
                job.commit()
            results.append({name: job.get(name) for name in ("U", "CNORMF", "CSHEARF", "CSTATUS")})
    dense, skin = results
    assert np.abs(dense["CNORMF"]).max() > 0
    assert (skin["CSTATUS"] == dense["CSTATUS"]).all()
    for name, scale in (("U", "U"), ("CNORMF", "CNORMF"), ("CSHEARF", "CNORMF")):
        assert np.abs(skin[name] - dense[name]).max() <= 1e-6 * np.abs(dense[scale]).max(), name


def verdicts(text: str) -> list[str]:
    """What a job says of attempts that failed and of bodies that it moved into contact; the last digits of the work are left out."""
    said = re.findall(r"This attempt failed: ([A-Z]+ [A-Z]+:[^.]*\.)|(Unsupported bodies were moved[^\n]*)|(A smaller increment[^.]*\.)", text)
    return [re.sub(r"work (\d+\.?\d{0,3})[^ ]*", r"work \1", "".join(words)) for words in said]


FREE_BODIES: dict[str, Callable[[], str]] = {
    "falls": CASES["fall in the plane"],
    "falls from afar": CASES["fall in space"],
    "between plates": CASES["disc between plates"],
    "dragged off its table": test_failure_report.dragged_off,
    "tips over": partial(test_failure_report.tipping, ""),
}


@pytest.mark.parametrize("name", FREE_BODIES)
def test_free_bodies_are_reported_in_the_same_words(run: Run, tmp_path: Path, name: str) -> None:
    """A body that nothing holds: the same verdict on each attempt, the same number of attempts and exit code."""
    results = []
    for interface in ("DENSE", "SKIN"):
        (tmp_path / f"{interface}.inp").write_text(with_interface(FREE_BODIES[name](), interface))
        done = run(["--progress=plain", interface], cwd=tmp_path)
        results.append((done.returncode, len(Job(tmp_path / f"{interface}.vtkhdf", name).history["step"]), verdicts(done.stdout)))
    dense, skin = results
    assert dense[2], "nothing was free"
    assert skin == dense


def test_body_that_tips_over_without_end(run: Run, tmp_path: Path) -> None:
    """Nothing converges here, so that the tolerance of GMRES decides the way and with it which sentence fits: both say that a body is free."""
    for interface in ("DENSE", "SKIN"):
        (tmp_path / f"{interface}.inp").write_text(with_interface(test_failure_report.tipping(", DIRECT"), interface))
        done = run(["--progress=plain", interface], cwd=tmp_path)
        assert done.returncode == 5
        assert "This attempt failed: FREE BODY: " in done.stdout


def test_dense_interface_is_announced(run: Run, tmp_path: Path) -> None:
    """Where the skin finds no direction, one line a step says what replaces it; the dense interface from the start says nothing."""
    for interface, lines in (("SKIN", 2), ("DENSE", 0)):
        (tmp_path / f"{interface}.inp").write_text(with_interface(DECKS["FRIC, exact contact"](), interface))
        done = run(["--progress=plain", interface, f"user={user.ROUTINES}"], cwd=tmp_path)
        assert done.stdout.count("No direction was found with the contact skin; in this step the dense interface replaces it.") == lines


def stepped_strip(interface: str) -> str:
    """A strip of S8R, half of it thinner, clamped at x = 0; a block of C3D8 pushes its end down by a fifth of its length. Where the
    thickness changes the nodes are rigid bodies, whose equations change as they rotate."""
    n, length, width = 8, 10.0, 1.0
    number = {}
    text = "** dialect: calculix\n*NODE\n"
    for i in range(2 * n + 1):
        for j in range(3):
            if i % 2 and j == 1:
                continue
            number[i, j] = len(number) + 1
            text += f"{number[i, j]}, {length * i / (2 * n)}, {width * j / 2}, 0.\n"
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    for name, elements in (("THICK", range(n // 2)), ("THIN", range(n // 2, n))):
        text += f"*ELEMENT, TYPE=S8R, ELSET={name}\n"
        text += "".join(f"{e + 1}, " + ", ".join(str(number[2 * e + i, j]) for i, j in around) + "\n" for e in elements)
    clamped = ", ".join(str(number[0, j]) for j in range(3))
    tool = Part("TOOL", "C3D8", (8.5, -0.2, 0.2), (9.5, 1.2, 0.7), (2, 2, 1), 1001)
    text += f"*NSET, NSET=CLAMP\n{clamped}\n" + bodies(tool) + "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
    text += "*SHELL SECTION, ELSET=THICK, MATERIAL=M\n.5\n*SHELL SECTION, ELSET=THIN, MATERIAL=M\n.3\n"
    text += "*SOLID SECTION, ELSET=TOOL, MATERIAL=M\n*SURFACE, NAME=TOP\nTHIN, SPOS\n"
    text += "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E4\n"
    text += "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nTOOL_Z0, TOP\n*BOUNDARY\nCLAMP, 1, 6\n"
    text += "*STEP, NLGEOM\n*STATIC\n.5, 1.\n*CONTROLS, PARAMETERS=FIELD\n1.E-8, 1.E-6\n"
    return text + f"*LINE SEARCH, TYPE=AUTO, INTERFACE={interface}\n*BOUNDARY\nTOOL_Z1N, 1, 2\nTOOL_Z1N, 3, 3, -2.\n*END STEP\n"


def test_rotating_equations(run: Run, tmp_path: Path) -> None:
    """A factor of the bulk is exact for the equations at its factorisation alone: a direction takes at most eight Krylov iterations
    with an earlier factor of so few unknowns, and one with its own. The skin, which needs no exact factor, finds the same."""
    jobs = []
    for interface in ("DENSE", "SKIN"):
        (tmp_path / f"{interface}.inp").write_text(stepped_strip(interface))
        done = run([interface], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        jobs.append(Job(tmp_path / f"{interface}.vtkhdf", interface))
    dense, skin = jobs
    rows = [line.split() for line in (tmp_path / "DENSE.cvg").read_text().splitlines() if re.match(r" +\d", line)]
    assert sum(int(row[18]) for row in rows) == dense.history["n_krylov"].sum()
    assert all(int(row[18]) <= 9 * (1 + int(row[-1])) for row in rows)
    assert np.abs(dense.last("CNORMF")).max() > 0
    for field in ("U", "CNORMF"):
        assert np.abs(skin.last(field) - dense.last(field)).max() <= 1e-5 * np.abs(dense.last(field)).max(), field
