"""Submodels: linear fields are reproduced, a history is followed over two steps, a hole against Kirsch, restarts, bad input.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.cases.proof import Case
from verify.conftest import Run
from verify.decks.solids import KINDS, Solids, node_set, prescribed
from verify.decks.submodels import CARD, GRADIENT, LAW, REMOTE, block, homogeneous_global, plate_global, plate_submodel, submodel
from verify.independent.results import read_field, read_results

Proof = Callable[..., Case]
LOW, HIGH = np.zeros(3), np.array([4.0, 3.0, 2.0])
STEP = "*STEP\n*STATIC\n{}*END STEP\n"
DRIVEN = STEP.format("*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n")
FOLLOWED = "*STEP, NLGEOM\n*STATIC, DIRECT\n0.25, 1.\n{}*END STEP\n"
EXACT = 1e-10  #: of a field that all elements represent, over its size


def run_job(run: Run, folder: Path, name: str, deck: str, *options: str) -> str:
    """Runs a deck, which must end well; returns what it prints, in one line."""
    (folder / f"{name}.inp").write_text(deck)
    done = run([*options, name], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return re.sub(r"\s+", " ", done.stdout)


def small_block(kind: str) -> Solids:
    """The submodel: a block within the global one whose faces are on none of its."""
    return block(kind, (2, 2, 2), np.array([0.7, 0.4, 0.3]), np.array([3.1, 2.2, 1.9]), shake=0.2 if kind in ("C3D8", "C3D4") else 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_linear_field(run: Run, tmp_path: Path, kind: str) -> None:
    """Patch test: a linear field in a shaken global mesh of each kind is that of the submodel to rounding."""
    mesh = block(kind, (3, 2, 2), LOW, HIGH, shake=0.2)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, STEP))
    text = run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), CARD.format("global.vtkhdf"), DRIVEN))
    assert "outside" not in text
    results = read_results(tmp_path / "sub.vtkhdf")
    expected = results.points @ GRADIENT.T
    assert np.abs(results.displacements[-1] - expected).max() <= EXACT * np.abs(expected).max()


@pytest.mark.parametrize("name", ["CUT", "I.CUT"])
def test_card_in_the_assembly(run: Run, tmp_path: Path, name: str) -> None:
    """*SUBMODEL between *ASSEMBLY and *END ASSEMBLY, as Abaqus/CAE writes it, with a set of the assembly or of an instance."""
    run_job(run, tmp_path, "global", homogeneous_global(block("C3D8", (3, 2, 2), LOW, HIGH, shake=0.2), STEP))
    mesh = small_block("C3D8")
    deck = "*PART, NAME=P\n" + mesh.cards() + "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n" + node_set("CUT", mesh.boundary_nodes()) + "*END PART\n"
    deck += "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*NSET, NSET=CUT\nI.CUT\n"
    deck += CARD.format("global.vtkhdf").replace("\nCUT", f"\n{name}") + "*END ASSEMBLY\n" + LAW[:LAW.index("*SOLID")] + DRIVEN
    run_job(run, tmp_path, "sub", deck)
    results = read_results(tmp_path / "sub.vtkhdf")
    expected = results.points @ GRADIENT.T
    assert np.abs(results.displacements[-1] - expected).max() <= EXACT * np.abs(expected).max()


@pytest.mark.parametrize("partitions", ["", "3"])
def test_partitions(run: Run, tmp_path: Path, partitions: str) -> None:
    """A global file of several parts gives the same."""
    mesh = block("C3D10", (4, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, STEP), *([f"--partitions={partitions}"] if partitions else []))
    run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), "*SUBMODEL\nCUT\n", DRIVEN), "globalmodel=global.vtkhdf")
    results = read_results(tmp_path / "sub.vtkhdf")
    assert np.abs(results.displacements[-1] - results.points @ GRADIENT.T).max() <= EXACT


def amplitude(time: np.ndarray) -> np.ndarray:
    """The factor of the global motion over the two steps."""
    return np.interp(time, [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0], [0.0, 0.1, 0.5, 1.0, 2.0, 2.2, 3.0, 2.0, 1.0])


GLOBAL_STEPS = (
    "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., .25, .1, .5, .5, .75, 1.\n1., 2., 1.25, 2.2, 1.5, 3., 1.75, 2.\n2., 1.\n"
    + FOLLOWED + FOLLOWED.format("")
)  # fmt: skip


@pytest.mark.parametrize("ending", ["vtkhdf", "frd"])
def test_history(run: Run, tmp_path: Path, ending: str) -> None:
    """Two steps of finite displacements: the submodel follows all increments of each global step, linear between them.

    The state is homogeneous, so that the exact solution of the submodel is the field itself at every time.
    """
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    deck = homogeneous_global(mesh, GLOBAL_STEPS).replace("*BOUNDARY\n", "*BOUNDARY, AMPLITUDE=A\n")
    run_job(run, tmp_path, "global", deck, "--frd")
    steps = "".join(f"*STEP, NLGEOM\n*STATIC, DIRECT\n0.2, 1.\n*BOUNDARY, SUBMODEL, STEP={i}\nCUT, 1, 3\n*END STEP\n" for i in (1, 2))
    steps += "*STEP, NLGEOM\n*STATIC\n1., 1.\n*END STEP\n"
    text = run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), CARD.format(f"global.{ending}"), steps))
    assert "follow 4 increments of step 2" in text
    results = read_results(tmp_path / "sub.vtkhdf")
    factors = amplitude(np.minimum(results.times, 2.0))  # the third step keeps what it has
    expected = factors[:, None, None] * (results.points @ GRADIENT.T)
    tolerance = EXACT * np.abs(expected).max() if ending == "vtkhdf" else 1e-5 * np.abs(expected).max()  # six digits
    assert len(results.times) == 12
    assert np.abs(results.displacements - expected).max() <= tolerance


def test_timescale(run: Run, tmp_path: Path) -> None:
    """TIMESCALE: the global step of length 1 is spread over the step of length 4; without it the end is reached at 1."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, FOLLOWED))
    for word, factors in (("", [0.0, 1.0, 1.0, 1.0, 1.0]), (", TIMESCALE", [0.0, 0.25, 0.5, 0.75, 1.0])):
        steps = f"*STEP, NLGEOM\n*STATIC, DIRECT\n1., 4.\n*BOUNDARY, SUBMODEL, STEP=1{word}\nCUT, 1, 3\n*END STEP\n"
        run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), CARD.format("global.vtkhdf"), steps))
        results = read_results(tmp_path / "sub.vtkhdf")
        expected = np.array(factors)[:, None, None] * (results.points @ GRADIENT.T)
        assert np.abs(results.displacements - expected).max() <= EXACT


def test_calculix_takes_the_last_increment(run: Run, tmp_path: Path) -> None:
    """The calculix dialect goes linearly to the end of the global step."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, GLOBAL_STEPS).replace("*BOUNDARY\n", "*BOUNDARY, AMPLITUDE=A\n"))
    steps = "*STEP, NLGEOM\n*STATIC, DIRECT\n0.25, 1.\n*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n*END STEP\n"
    run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), CARD.format("global.vtkhdf"), steps), "--dialect=calculix")
    results = read_results(tmp_path / "sub.vtkhdf")
    expected = 2.0 * results.times[:, None, None] * (results.points @ GRADIENT.T)
    assert np.abs(results.displacements - expected).max() <= EXACT


def test_reactions_and_release(run: Run, tmp_path: Path) -> None:
    """Driven nodes carry reactions that balance; OP=NEW releases them."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, STEP))
    sub = small_block("C3D8")
    a, b, c = (1 + int(np.argmin(np.abs(sub.nodes - [0.7, y, z]).sum(axis=1))) for y, z in ((0.4, 0.3), (2.2, 0.3), (0.4, 1.9)))
    steps = DRIVEN + STEP.format(f"*BOUNDARY, OP=NEW\n{a}, 1, 3\n{b}, 1\n{b}, 3\n{c}, 1\n")
    run_job(run, tmp_path, "sub", submodel(sub, CARD.format("global.vtkhdf"), steps))
    results = read_results(tmp_path / "sub.vtkhdf")
    assert results.reactions is not None
    assert np.abs(results.reactions[1]).max() > 1.0
    assert np.abs(results.reactions[1].sum(axis=0)).max() < 1e-9 * np.abs(results.reactions[1]).max()
    stress = read_field(tmp_path / "sub.vtkhdf", "S_mises")
    assert np.abs(stress[2]).max() < 1e-9 * np.abs(stress[1]).max()  # free of forces


def test_temperatures(run: Run, tmp_path: Path) -> None:
    """A linear field of temperatures comes to all nodes, in both dialects; a later step starts from it."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    field = np.array([1.0, -2.0, 0.5])
    rows = "".join(f"{i}, {20 + x @ field:.15g}\n" for i, x in enumerate(mesh.nodes, start=1))
    law = "*EXPANSION\n1e-5\n*SOLID"
    deck = homogeneous_global(mesh, "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n" + STEP.replace("{}", "{}*TEMPERATURE\n" + rows))
    run_job(run, tmp_path, "global", deck.replace("*SOLID", law))
    sub = small_block("C3D8")
    steps = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n*STEP\n*STATIC, DIRECT\n0.5, 1.\n*TEMPERATURE, SUBMODEL, STEP=1\nNODES\n*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n*END STEP\n"
    steps += "*STEP\n*STATIC, DIRECT\n0.5, 1.\n*TEMPERATURE\nNODES, 100.\n*END STEP\n"
    card = "*SUBMODEL, INPUT=global.vtkhdf\nNODES\n"
    for dialect, options in (("abaqus", ()), ("calculix", ("--dialect=calculix",))):
        run_job(run, tmp_path, dialect, submodel(sub, card, steps).replace("*SOLID", law), *options)
        results = read_results(tmp_path / f"{dialect}.vtkhdf")
        temperatures = read_field(tmp_path / f"{dialect}.vtkhdf", "NT")
        end = 20 + results.points @ field
        for time, expected in ((1.0, end), (2.0, 100.0)):
            assert np.abs(temperatures[np.argmin(np.abs(results.times - time))] - expected).max() < 1e-9
        for time, expected in ((0.5, 20 + 0.5 * (end - 20)), (1.5, 0.5 * (end + 100.0))):
            if np.abs(results.times - time).min() < 1e-9:  # a linear calculix step has one increment
                assert np.abs(temperatures[np.argmin(np.abs(results.times - time))] - expected).max() < 1e-9


def test_global_element_set(run: Run, tmp_path: Path) -> None:
    """Two global bodies at one place with different motions: GLOBAL ELSET chooses, by numbers of the deck or a set of the file."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    n, m = len(mesh.nodes), len(mesh.elements)
    both = type(mesh)("C3D8", np.concatenate([mesh.nodes, mesh.nodes]), np.concatenate([mesh.elements, mesh.elements + n]))
    deck = homogeneous_global(mesh, "").replace(mesh.cards(), both.cards()) + f"*ELSET, ELSET=SECOND, GENERATE\n{m + 1}, {2 * m}\n"
    moved = (both.nodes @ GRADIENT.T) * np.repeat([[1.0], [3.0]], n, axis=0)
    run_job(run, tmp_path, "global", deck + STEP.format(prescribed(range(2 * n), moved)))
    numbers = f"*ELSET, ELSET=SECOND\n{', '.join(str(e) for e in range(m + 1, 2 * m + 1))}\n"
    for card, factor in (("", 1.0), (", GLOBAL ELSET=SECOND", 3.0)):
        for extra in ("", numbers if factor > 1 else ""):
            run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), f"*SUBMODEL, INPUT=global.vtkhdf{card}\nCUT\n{extra}", DRIVEN))
            results = read_results(tmp_path / "sub.vtkhdf")
            assert np.abs(results.displacements[-1] - factor * (results.points @ GRADIENT.T)).max() <= EXACT
    own = "*ELSET, ELSET=SECOND\n1, 2\n"  # of this deck: the set of the file counts, unless the dialect is calculix
    for options, factor in (((), 3.0), (("--dialect=calculix",), 1.0)):
        run_job(run, tmp_path, "sub", submodel(small_block("C3D8"), f"*SUBMODEL, INPUT=global.vtkhdf, GLOBAL ELSET=SECOND\nCUT\n{own}", DRIVEN), *options)
        results = read_results(tmp_path / "sub.vtkhdf")
        at = np.flatnonzero(np.all(results.points < [2.0, 1.5, 1.0], axis=1) & (results.points[:, 0] < 0.71))  # in element 1
        assert np.abs(results.displacements[-1] - factor * (results.points @ GRADIENT.T))[at].max() <= EXACT


def test_shells_and_planes(run: Run, tmp_path: Path) -> None:
    """A bent shell is a solid in its results, in which a solid submodel finds its place; a plane submodel of a plane model."""
    shell = "*NODE, NSET=N\n1, 0., 0., 0.\n2, 4., 0., 0.\n3, 4., 2., 0.\n4, 0., 2., 0.\n*ELEMENT, TYPE=S4, ELSET=ALL\n1, 1, 2, 3, 4\n"
    shell += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SHELL SECTION, ELSET=ALL, MATERIAL=M\n1.\n"
    shell += "*STEP\n*STATIC\n*BOUNDARY\n" + "".join(f"{n}, 1, 1, {0.01 * x}\n{n}, 2, 2, 0.\n{n}, 3, 3, 0.\n{n}, 4, 4, 0.\n{n}, 5, 5, {0.02 * x}\n" for n, x in ((1, 0), (2, 4), (3, 4), (4, 0)))
    run_job(run, tmp_path, "global", shell + "*END STEP\n")
    sub = block("C3D8", (2, 2, 2), np.array([1.0, 0.5, -0.4]), np.array([3.0, 1.5, 0.3]))
    run_job(run, tmp_path, "sub", submodel(sub, CARD.format("global.vtkhdf"), DRIVEN))
    results = read_results(tmp_path / "sub.vtkhdf")
    x, _, z = results.points.T
    cut = sub.boundary_nodes()
    assert np.abs(results.displacements[-1][cut, 0] - (0.01 * x + 0.02 * x * z)[cut]).max() < 1e-6
    plane = "*NODE, NSET=N\n{}*ELEMENT, TYPE=CPE4, ELSET=ALL\n1, 1, 2, 3, 4\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n1.\n"
    corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)]
    rows = "".join(f"{i}, 1, 1, {0.01 * x + 0.02 * y}\n{i}, 2, 2, {0.03 * y}\n" for i, (x, y) in enumerate(corners, start=1))
    run_job(run, tmp_path, "global", plane.format("".join(f"{i}, {x}, {y}\n" for i, (x, y) in enumerate(corners, start=1))) + STEP.format("*BOUNDARY\n" + rows))
    inner = [(1.0, 0.5), (3.0, 0.6), (2.8, 1.5), (1.2, 1.4)]
    deck = plane.format("".join(f"{i}, {x}, {y}\n" for i, (x, y) in enumerate(inner, start=1))) + "*SUBMODEL, INPUT=global.vtkhdf\nN\n"
    run_job(run, tmp_path, "sub", deck + STEP.format("*BOUNDARY, SUBMODEL, STEP=1\nN, 1, 2\n"))
    results = read_results(tmp_path / "sub.vtkhdf")
    x, y, _ = results.points.T
    assert np.abs(results.displacements[-1] - np.stack([0.01 * x + 0.02 * y, 0.03 * y, 0 * x], axis=1)).max() <= EXACT
    (tmp_path / "solid.inp").write_text(submodel(sub, CARD.format("global.vtkhdf"), DRIVEN))
    done = run(["solid"], cwd=tmp_path)
    assert done.returncode == 4
    assert "of plane or axisymmetric elements" in re.sub(r"\s+", " ", done.stdout + done.stderr)


def test_plate_with_hole(proof: Proof) -> None:
    """The region around a hole, cut out of a coarse plate."""
    case = proof(
        "submodel-of-a-hole",
        title="Submodel of a hole",
        model="A quarter of a plate with a hole of radius 1 in plane strain, 6 by 6 elements C3D20R out to radius 8, where Kirsch's "
              "displacements are prescribed; a submodel of 10 by 16 elements out to radius 2.5 is driven by its results.",
        formula="sigma_theta = 3 S at the hole, across the tension S",
        source="S. Timoshenko, J. N. Goodier, Theory of elasticity, 3rd ed., section 35",
        proves="`*SUBMODEL` and `*BOUNDARY, SUBMODEL`: location, interpolation, results of a .vtkhdf file; the submodel is nearer to the "
               "closed form than the global model.",
    )  # fmt: skip
    errors = []
    jobs = [case.run(plate_global(), "global"), case.run(plate_submodel(CARD.format("../global/job.vtkhdf")), "submodel")]
    for job, tolerance in zip(jobs, (0.10, 0.01), strict=True):
        top = np.flatnonzero((np.abs(job.points[:, 0]) < 1e-9) & (np.abs(job.points[:, 1] - 1.0) < 1e-9))
        stress = float(job.last("S")[top, 0].mean())
        errors.append(abs(stress / (3 * REMOTE) - 1))
        case.near("stress xx", stress, 3 * REMOTE, tolerance, place=f"top of the hole, {job.path.parent.name}", time="end",
                  why=f"extrapolated from the integration points of {'coarse' if tolerance > 0.05 else 'fine'} elements")  # fmt: skip
    case.true("the submodel is nearer to the closed form", errors[1] < 0.5 * errors[0], place="top of the hole", time="end",
              why="its elements are a third as large")  # fmt: skip
    case.done()


def test_restart(run: Run, tmp_path: Path) -> None:
    """A job that continues another one reads the results of the global model again."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, FOLLOWED))
    steps = "*STEP, NLGEOM\n*STATIC, DIRECT\n0.05, 1.\n*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n*RESTART, WRITE\n*END STEP\n"
    deck = submodel(small_block("C3D8"), CARD.format("global.vtkhdf"), steps)
    run_job(run, tmp_path, "whole", deck)
    new = "*RESTART, READ, STEP=1, INC=7\n*STEP, NLGEOM\n*STATIC\n1., 1.\n*END STEP\n"
    run_job(run, tmp_path, "rest", new, "--oldjob=whole")
    whole, rest = read_results(tmp_path / "whole.vtkhdf"), read_results(tmp_path / "rest.vtkhdf")
    at = int(np.argmin(np.abs(rest.times - 1.0)))
    assert np.abs(rest.displacements[at] - whole.displacements[-1]).max() <= EXACT
    assert np.abs(rest.displacements[-1] - whole.displacements[-1]).max() <= EXACT


def test_resume(run: Run, program: Path, tmp_path: Path) -> None:
    """An interrupted job reads the results again and ends with the same bits; with other results it is not resumed."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, FOLLOWED))
    good = (tmp_path / "global.vtkhdf").read_bytes()
    steps = "*STEP, NLGEOM, INC=200\n*STATIC, DIRECT\n0.0125, 1.\n*BOUNDARY, SUBMODEL, STEP=1\nCUT, 1, 3\n*END STEP\n"
    deck = submodel(small_block("C3D8"), CARD.format("global.vtkhdf"), steps)
    run_job(run, tmp_path, "whole", deck)
    (tmp_path / "cut.inp").write_text(deck)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    with subprocess.Popen([program, "cut"], cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL) as job:
        while not (tmp_path / "cut.restart").exists() and job.poll() is None:
            time.sleep(0.005)
        job.kill()
    assert (tmp_path / "cut.restart").exists(), "the job was done before it was killed"
    (tmp_path / "other.inp").write_text((tmp_path / "global.inp").read_text().replace("0.3\n", "0.2\n").replace("0.02", "0.021"))
    assert run(["other"], cwd=tmp_path).returncode == 0
    (tmp_path / "global.vtkhdf").write_bytes((tmp_path / "other.vtkhdf").read_bytes())
    done = run(["--resume", "cut"], cwd=tmp_path)
    assert done.returncode == 7
    assert "or the results of its global model have" in re.sub(r"\s+", " ", done.stdout + done.stderr)
    (tmp_path / "global.vtkhdf").write_bytes(good)
    done = run(["--resume", "cut"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    whole, cut = read_results(tmp_path / "whole.vtkhdf"), read_results(tmp_path / "cut.vtkhdf")
    assert np.array_equal(whole.displacements, cut.displacements)


def test_parts(run: Run, tmp_path: Path) -> None:
    """A deck with a part and an instance, as Abaqus/CAE writes it: *Submodel and *Boundary name sets of the assembly."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, STEP))
    sub = small_block("C3D8")
    inner = sub.cards() + "*Solid Section, elset=ALL, material=M\n"
    outer = node_set("CUT", sub.boundary_nodes()).replace("NSET=CUT", "NSET=CUT, INSTANCE=P-1")
    deck = f"*Part, name=P\n{inner}*End Part\n*Assembly, name=A\n*Instance, name=P-1, part=P\n*End Instance\n{outer}*End Assembly\n"
    deck += LAW.split("*SOLID")[0] + "*Submodel, type=NODE, exterior tolerance=0.05\nCUT,\n"
    deck += "*Step, name=S\n*Static\n1., 1., 1e-05, 1.\n*Boundary, submodel, step=1\nCUT, 1, 1\nCUT, 2, 2\nCUT, 3, 3\n*End Step\n"
    run_job(run, tmp_path, "sub", deck, "globalmodel=global.vtkhdf")
    results = read_results(tmp_path / "sub.vtkhdf")
    assert np.abs(results.displacements[-1] - results.points @ GRADIENT.T).max() <= EXACT


def test_the_page_of_the_manual(run: Run, root: Path, tmp_path: Path) -> None:
    """The two decks that are shown, in both ways to name the results: the submodel deflects at its cut as the global model."""
    decks = re.findall(r"```(abaqus\S*)\n(.*?)```", (root / "doc" / "manual" / "submodels.md").read_text(), re.DOTALL)
    assert [kind for kind, _ in decks] == ["abaqus", "abaqus-submodel"]
    run_job(run, tmp_path, "global", decks[0][1])
    whole = read_results(tmp_path / "global.vtkhdf")
    for deck, options in ((decks[1][1], []), (decks[1][1].replace(", INPUT=global.vtkhdf", ""), ["globalmodel=global.vtkhdf"])):
        run_job(run, tmp_path, "local", deck, *options)
        local = read_results(tmp_path / "local.vtkhdf")
        for place in ([2.0, 0.0, 0.0], [2.0, 1.0, 1.0]):
            at, there = (int(np.argmin(np.abs(r.points - place).sum(axis=1))) for r in (local, whole))
            assert np.abs(local.displacements[-1][at] - whole.displacements[-1][there]).max() <= EXACT


BAD = [
    (CARD.format("none.vtkhdf"), DRIVEN, 7, "does not exist"),
    (CARD.format("sub.inp"), DRIVEN, 7, "cannot be opened as a .vtkhdf file"),
    (CARD.format("empty.frd"), DRIVEN, 7, "no nodes and elements of a .frd file"),
    (CARD.format("global.vtkhdf"), DRIVEN.replace("STEP=1", "STEP=3"), 4, "has no displacements of step 3; its steps are 1 to 1"),
    (CARD.format("global.vtkhdf"), DRIVEN.replace("STEP=1", "DATA SET=30"), 4, "no data set 30"),
    (CARD.format("no_u.frd"), DRIVEN, 4, "has no displacements"),
    ("", DRIVEN, 3, "needs a card *SUBMODEL"),
    ("*SUBMODEL\nCUT\n", DRIVEN, 3, "not named"),
    ("*SUBMODEL, TYPE=SURFACE, INPUT=global.vtkhdf\nCUT\n", DRIVEN, 3, "TYPE=NODE"),
    (CARD.format("global.vtkhdf"), STEP.format("*CLOAD, SUBMODEL, STEP=1\nCUT, 1\n"), 3, "Forces are not taken from a global model"),
]


@pytest.mark.parametrize(("card", "steps", "code", "words"), BAD, ids=[words for *_, words in BAD])
def test_bad_input(run: Run, tmp_path: Path, card: str, steps: str, code: int, words: str) -> None:
    """What is missing ends the job before the first increment, with a sentence that names it; --check finds it, too."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, STEP), "--frd")
    text = (tmp_path / "global.frd").read_text()
    (tmp_path / "no_u.frd").write_text(text[: text.index("    1PSTEP")] + " 9999\n")
    (tmp_path / "empty.frd").write_text("")
    (tmp_path / "sub.inp").write_text(submodel(small_block("C3D8"), card, steps))
    for options in ([], ["--check"]):
        done = run([*options, "sub"], cwd=tmp_path)
        assert done.returncode == code, done.stdout + done.stderr
        assert words in re.sub(r"\s+", " ", done.stdout + done.stderr)
    if code == 4:
        assert "*SUBMODEL of line " in done.stdout + done.stderr


def test_nodes_outside(run: Run, tmp_path: Path) -> None:
    """abaqus: an error beyond the tolerance, with the farthest node; calculix: the nearest point, with a warning."""
    mesh = block("C3D8", (2, 2, 2), LOW, HIGH)
    run_job(run, tmp_path, "global", homogeneous_global(mesh, STEP))
    sub = block("C3D8", (2, 2, 2), np.array([1.0, 1.0, 1.0]), np.array([3.0, 2.0, 2.3]))
    (tmp_path / "sub.inp").write_text(submodel(sub, CARD.format("global.vtkhdf"), DRIVEN))
    done = run(["sub"], cwd=tmp_path)
    text = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == 4
    assert re.search(r"9 driven nodes are outside .* by more than 0\.1\b.* The farthest is node \d+, by 0\.3", text), text
    done = run(["--dialect=calculix", "sub"], cwd=tmp_path)
    text = re.sub(r"\s+", " ", done.stdout + done.stderr)
    assert done.returncode == 0
    assert re.search(r"\*WARNING: Of the 26 driven nodes .* 9 are outside the global model .* by 0\.3", text), text
    results = read_results(tmp_path / "sub.vtkhdf")
    cut = sub.boundary_nodes()
    nearest = np.minimum(results.points, HIGH)
    assert np.abs(results.displacements[-1] - nearest @ GRADIENT.T)[cut].max() <= EXACT
    run_job(run, tmp_path, "sub", submodel(sub, "*SUBMODEL, INPUT=global.vtkhdf, EXTERIOR TOLERANCE=0.2\nCUT\n", DRIVEN))
