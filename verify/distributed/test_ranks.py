"""Several ranks: the same answers as the serial program, the same bits twice, errors and deaths of a rank, resumption.

Needs bin/amontons-mpi (`make MPI=1`) and mpiexec; without them the tests are skipped. `verify.distributed.ranks_and_serial` runs all
generated decks and prints a table.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from verify.benchmark.estimate_table import cube
from verify.benchmark.ranks_table import estimated_ranks, whole_job
from verify.benchmark.wide_contact import Model, deck_of
from verify.cases.elastic.test_plane_and_discrete_elements import material, sheet, supports
from verify.distributed.ranks_and_serial import (
    DIALECT, TOLERANCE, Outcome, all_decks, difference, environment, execute, program, ranks_of, run, with_solver,
)  # fmt: skip
from verify.invariance.test_solvers import cantilever
from verify.study.gradients_samples import sample, with_gradients

if not program("amontons-mpi").exists():
    pytest.skip("there is no amontons-mpi: make MPI=1 builds it", allow_module_level=True)
if shutil.which("mpiexec") is None:
    pytest.skip("there is no mpiexec", allow_module_level=True)

DECKS = [  #: solids, laws with history, constraints that couple nodes, contact of all formulations, changes between steps
    "mixed/element-C3D8-nl",
    "mixed/element-C3D20-nl",
    "mixed/element-CAX8-nl",
    "mixed/elastic-C3D8-ortho-cyl-nl",
    "mixed/plastic-C3D8-isotropic-T-nl",
    "mixed/creep-C3D10-nl",
    "mixed/rubber-C3D10-foam1",
    "mixed/bond-C3D10-meanrot-nl",
    "mixed/steps-mixed-nl",
    "mixed/output-all-C3D20",
    "feature/tie-C3D8-C3D20-nl",
    "feature/pretension-C3D4-nl",
    "feature/ring-C3D15-nl",
    "feature/reference-kinematic-nl-moved",
    "feature/springa-table-nl",
    "behaviour/drag-C3D8I-n",
    "behaviour/drag-C3D10-s",
    "behaviour/drag-C3D15-m",
    "behaviour/hard-drag-n",
]


@pytest.mark.parametrize("name", DECKS)
def test_generated_decks(tmp_path: Path, name: str) -> None:
    """On 1, 2 and 4 ranks: equal statuses, increments and Newton iterations; displacements and reactions to 1e-10 of the largest."""
    deck = all_decks()[name]
    serial = run(tmp_path / "serial", deck, 0, DIALECT)
    assert serial.code == 0, serial.text
    for n in (1, 2, 4):
        what, worst = difference(serial, run(tmp_path / f"ranks{n}", deck, n, DIALECT))
        assert what == "" and worst <= (TOLERANCE if n > 1 else 0.0), f"{n} ranks: {what} {worst}"


@pytest.mark.parametrize("kind", ["CPS4I", "CPE4I", "CAX4I"])
def test_modes_that_have_flowed(tmp_path: Path, kind: str) -> None:
    """A bar bent beyond yield and released, NLGEOM: each rank keeps the amplitudes of its elements."""
    body = sheet(kind[:3], "4I", (8, 2), lambda u, v: (5 + 10 * u, v))
    deck = body.cards() + material(1000.0, 0.3).replace("*SOLID", "*PLASTIC\n2., 0.\n252., 1.\n*SOLID") + supports(body.where(0, 0.0), 1, 2)
    tip = "*BOUNDARY\n" + "".join(f"{n + 1}, 2, 2, {{}}\n" for n in body.where(0, 1.0))
    deck += "".join("*STEP, NLGEOM\n*STATIC, DIRECT\n0.25, 1.\n" + tip.replace("{}", u) + "*END STEP\n" for u in ("1.", "0.3"))
    serial = run(tmp_path / "serial", deck, 0)
    assert serial.code == 0, serial.text
    for n in (1, 2, 4):
        what, worst = difference(serial, run(tmp_path / f"ranks{n}", deck, n))
        assert what == "" and worst <= (TOLERANCE if n > 1 else 0.0), f"{n} ranks: {what} {worst}"


@pytest.mark.parametrize("solver", ["GAMG", "HYPRE", "MUMPS"])
def test_solvers(tmp_path: Path, solver: str) -> None:
    """A linear cube: the solvers of PETSc stop at a residual of 1e-11; the error is that times the condition, to be 1e-9 here."""
    serial = run(tmp_path / "serial", cube(8, ""), 0)
    for n in (1, 3):
        ranks = run(tmp_path / f"ranks{n}", cube(8, f", SOLVER={solver}"), n)
        name = "hypre" if solver == "HYPRE" else solver
        assert f"are distributed and solved by {name}." in ranks.text, ranks.text
        what, worst = difference(serial, ranks)
        assert what == "" and worst < 1e-9


#: Krylov iterations on so many ranks, and a little for other compilers: they took 25, 28 and 31 on one, two and eight ranks for the cube
#: and 47, 47 and 52 for the bar; the sum of the levels took 40 and 77 on one rank.
MAX_ITERATIONS = {"C3D8": {2: 29, 8: 32}, "C3D20": {2: 49, 8: 54}}


@pytest.mark.parametrize("kind", ["C3D8", "C3D20"])
def test_two_level_iteration(tmp_path: Path, kind: str) -> None:
    """The iteration divided among the ranks, with motions of parts and with corners of quadratic elements as second level: the displacements
    of the serial program to 1e-9, as its residual is 1e-11 (1e-8 for the slender bar); the iterations of MAX_ITERATIONS, on eight ranks of
    700 unknowns, too; and the same bits twice."""
    solver = ", SOLVER=ITERATIVE SCALING"
    deck = cube(12, solver) if kind == "C3D8" else cantilever(kind, (3, 3, 30), 0.49).replace("*STATIC", f"*STATIC{solver}")
    serial = run(tmp_path / "serial", deck, 0)
    assert serial.code == 0, serial.text
    for n in (2, 8):
        ranks = run(tmp_path / f"ranks{n}", deck, n)
        if n == 2:
            again = run(tmp_path / "again", deck, n)
            assert all(values.tobytes() == again.fields[name].tobytes() for name, values in ranks.fields.items())
        assert "are distributed and solved by two-level iteration." in ranks.text, ranks.text
        what, worst = difference(serial, ranks)
        assert what == "" and worst < (1e-9 if kind == "C3D8" else 1e-8)
        assert krylov_iterations(ranks) <= MAX_ITERATIONS[kind][n]
        assert re.search(r"it sends [1-9]\d*\.\d messages and [\d.]+ kilobytes in a Krylov iteration", ranks.text)


@pytest.mark.parametrize("n", [1, 2, 4, 8])
def test_bddc_of_a_slender_bar(tmp_path: Path, n: int) -> None:
    """A bar of C3D20, nearly incompressible and ten times as long as thick: few iterations, as edges, faces and corners of subdomains are
    coarse unknowns and interfaces are weighted by their Schur complements (6, 11 and 14 on 2, 4 and 8 ranks); 77 by two levels."""
    deck = cantilever("C3D20", (3, 3, 30), 0.49)
    serial = run(tmp_path / "serial", deck, 0)
    ranks = run(tmp_path / "ranks", with_solver(deck, "BDDC"), n)
    assert "are distributed and solved by BDDC." in ranks.text and "a factor is used" not in ranks.text, ranks.text
    what, worst = difference(serial, ranks)
    assert what == "" and worst < 1e-9
    assert krylov_iterations(ranks) <= 25


def bodies(n: int, step: tuple[int, int]) -> str:
    """Columns of six hexahedra, each beside the last by a step in x and y: apart (2 and more), or joined by an edge alone (1, 1)."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    number: dict[tuple[int, int, int], int] = {}
    elements = [
        [number.setdefault((b * step[0] + x, b * step[1] + y, z + k), len(number) + 1) for k in (0, 1) for x, y in corners]
        for b in range(n)
        for z in range(6)
    ]
    ends = {name: "".join(f"{i}\n" for place, i in number.items() if place[2] == z) for name, z in (("LOW", 0), ("HIGH", 6))}
    return (
        "*NODE\n"
        + "".join(f"{i}, {x}., {y}., {z}.\n" for (x, y, z), i in number.items())
        + "*ELEMENT, TYPE=C3D8, ELSET=ALL\n"
        + "".join(", ".join(map(str, [e, *nodes])) + "\n" for e, nodes in enumerate(elements, 1))
        + "".join(f"*NSET, NSET={name}\n{labels}" for name, labels in ends.items())
        + "*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
        + "*STEP\n*STATIC\n*BOUNDARY\nLOW, 1, 3\n*CLOAD\nHIGH, 1, 1.\nHIGH, 3, -2.\n*END STEP\n"
    )


@pytest.mark.parametrize("kind", ["apart", "hinged", "equations"])
def test_bddc_of_odd_parts(tmp_path: Path, kind: str) -> None:
    """Parts of several bodies; parts that share an edge alone, in which they can turn; equations between unknowns of all ranks. Five ranks."""
    if kind == "equations":
        deck = cantilever("C3D8", (2, 2, 20))
        tip = [int(word) for word in re.findall(r"\d+", deck.split("NSET=TIP\n")[1].split("*")[0])]
        deck = deck.replace("*MATERIAL", "".join(f"*EQUATION\n2\n{label}, 3, 1., {tip[0]}, 3, -1.\n" for label in tip[1:]) + "*MATERIAL")
    else:
        deck = bodies(4, (3, 0) if kind == "apart" else (1, 1))
    serial = run(tmp_path / "serial", deck, 0)
    ranks = run(tmp_path / "ranks", with_solver(deck, "BDDC"), 5)
    assert serial.code == 0 and "are distributed and solved by BDDC." in ranks.text, ranks.text
    what, worst = difference(serial, ranks)
    assert what == "" and worst < 1e-9


@pytest.mark.parametrize("name", ["mixed/element-C3D20-nl", "mixed/plastic-C3D8-isotropic-T-nl", "feature/tie-C3D8-C3D20-nl"])
def test_bddc_of_nonlinear_decks(tmp_path: Path, name: str) -> None:
    """New values in each iteration, ranks without elements, ties: the Newton iterations of the serial program, fields within its tolerance."""
    deck = all_decks()[name]
    serial = run(tmp_path / "serial", deck, 0, DIALECT)
    ranks = run(tmp_path / "ranks", with_solver(deck, "BDDC"), 4, DIALECT)
    assert serial.code == 0 and "are distributed and solved by BDDC." in ranks.text, ranks.text
    what, worst = difference(serial, ranks)
    assert what == "" and worst < 1e-5


def test_bddc_is_refused(tmp_path: Path) -> None:
    """Contact joins elements of several ranks: a sentence names what is allowed. One rank has the whole stiffness."""
    refused = run(tmp_path / "two", with_solver(deck_of(Model(2)), "BDDC"), 2)
    assert refused.code == 4 and errors_in(refused) == 1, refused.text
    assert "SOLVER=BDDC on several ranks" in refused.text and "GAMG, HYPRE and MUMPS are allowed" in re.sub(r"\s+", " ", refused.text)
    assert run(tmp_path / "one", with_solver(deck_of(Model(2)), "BDDC"), 1).code == 0


def krylov_iterations(outcome: Outcome) -> int:
    """The number in the table of the job."""
    return int(re.search(r"Krylov iterations +(\d+)", outcome.text)[1])


DIVIDED = [  #: solids alone, so that the stiffness is divided: NLGEOM, laws with history, ties, follower pressure, changes between steps
    "mixed/element-C3D8-nl",
    "mixed/element-C3D20-nl",
    "mixed/plastic-C3D8-isotropic-T-nl",
    "mixed/creep-C3D10-nl",
    "mixed/steps-mixed-nl",
    "feature/tie-C3D8-C3D20-nl",
    "feature/pretension-C3D4-nl",
    "feature/springa-table-nl",
    "feature/reference-kinematic-nl-moved",
]


@pytest.mark.parametrize("name", DIVIDED)
def test_divided_stiffness(tmp_path: Path, name: str) -> None:
    """Each rank keeps the stiffness of its own elements: the increments and Newton iterations of the iteration in the serial program, fields
    within Newton's tolerance, as two preconditioners give directions that differ by a thousandth of it."""
    deck = with_solver(all_decks()[name], "ITERATIVE SCALING")
    serial = run(tmp_path / "serial", deck, 0, DIALECT)
    assert serial.code == 0, serial.text
    for n in (2, 4):
        ranks = run(tmp_path / f"ranks{n}", deck, n, DIALECT)
        what, worst = difference(serial, ranks)
        assert what == "" and worst < 1e-5, f"{n} ranks: {what} {worst}"


def bar(cards: str) -> str:
    """A cantilever of hexahedra with NLGEOM and two increments, by iteration; cards in place of its loads."""
    deck = cantilever("C3D8", (2, 2, 20), 0.3, step="*STEP, NLGEOM\n*STATIC, SOLVER=ITERATIVE SCALING, DIRECT\n0.5, 1.\n")
    return deck.replace("*CLOAD\nTIP, 1, 0.1\nTIP, 3, -0.02\n", cards)


def test_follower_pressure(tmp_path: Path) -> None:
    """A pressure that turns with the faces: its stiffness is added by the rank of the element."""
    deck = bar("*DLOAD\nALL, P3, 20.\n")
    serial, *ranks = (run(tmp_path / str(n), deck, n) for n in (0, 2, 4))
    assert serial.code == 0, serial.text
    for outcome in ranks:
        what, worst = difference(serial, outcome)
        assert what == "" and worst < 1e-7
        most = re.search(r"at most (\d+) unknowns, (\d+) in its halo and (\d+) neighbours; it sends ([\d.]+) messages", outcome.text)
        assert most and min(float(number) for number in most.groups()) > 0.0, outcome.text


def test_unsymmetric_material(tmp_path: Path) -> None:
    """Friction angle 30, no dilation: the tangent has a skew-symmetric part in the whole pattern, and GMRES works on parts of vectors."""
    deck = bar("*CLOAD\nTIP, 1, 0.005\nTIP, 3, -2.4\n").replace(
        "*SOLID SECTION", "*DRUCKER PRAGER\n30., 1., 0.\n*DRUCKER PRAGER HARDENING\n20., 0.\n1020., 0.02\n*SOLID SECTION"
    )
    serial, *ranks = (run(tmp_path / str(n), deck, n) for n in (0, 2, 4))
    assert serial.code == 0, serial.text
    for outcome in ranks:
        what, worst = difference(serial, outcome)
        assert what == "" and worst < 1e-7
        assert "distributed and solved by two-level iteration" in outcome.text and "a factor is used" not in outcome.text


@pytest.mark.parametrize(("solver", "name"), [("ITERATIVE SCALING", "two-level iteration"), ("BDDC", "BDDC")])
def test_whole_stiffness_for_a_factor(tmp_path: Path, solver: str, name: str) -> None:
    """A strut beyond its buckling load: the tangent is not positive definite, the ranks make the divided stiffness whole and take a factor,
    in the iterations of the serial program and with its fields. Strict criteria, as iterated directions are inexact."""
    deck = bar("*CONTROLS, PARAMETERS=FIELD\n1e-12, 1e-12\n*CLOAD\nTIP, 1, 0.5\nTIP, 3, -2000.\n")
    serial, *ranks = (run(tmp_path / str(n), with_solver(deck, solver) if n else deck, n) for n in (0, 2, 4))
    assert serial.code == 0 and "did not converge: a factor is used" in serial.text
    for outcome in ranks:
        assert f"solved by {name}" in outcome.text and "did not converge: a factor is used" in outcome.text
        what, worst = difference(serial, outcome)
        assert what == "" and worst < TOLERANCE


def test_estimate(tmp_path: Path) -> None:
    """The memory of a rank is what the serial program estimates and 20 MB for the libraries of MPI, within a fifth; more ranks need less."""
    deck = cube(26, ", SOLVER=ITERATIVE SCALING")
    (tmp_path / "job.inp").write_text(deck)
    estimate = estimated_ranks(execute(tmp_path, 0, "--estimate").text)
    assert list(estimate) == [2, 4, 8, 16]
    for few, more in ((2, 4), (4, 8), (8, 16)):
        assert estimate[few][0] > estimate[more][0] and estimate[few][1] > estimate[more][1]
    for n in (2, 4):
        _, megabytes = whole_job(run(tmp_path / str(n), deck, n).text)
        assert abs(estimate[n][1] + 20.0 - megabytes) < 0.2 * megabytes, (n, estimate[n][1], megabytes)


@pytest.mark.slow
def test_default(tmp_path: Path) -> None:
    """A cube of 3 * 22 * 23^2 free unknowns, more than 30 000: two ranks solve it each for itself, four share it."""
    serial = run(tmp_path / "serial", cube(22, ""), 0)
    for n in (2, 4):
        ranks = run(tmp_path / f"ranks{n}", cube(22, ""), n)
        assert ("equations are distributed and solved by MUMPS." in ranks.text) == (n == 4), ranks.text
        what, worst = difference(serial, ranks)
        assert what == "" and worst <= TOLERANCE


@pytest.mark.parametrize("solver", ["GAMG", "HYPRE", "MUMPS"])
@pytest.mark.parametrize("name", ["mixed/element-C3D8-nl", "mixed/element-C3D20-nl", "feature/tie-C3D8-C3D20-nl"])
def test_solvers_of_nonlinear_decks(tmp_path: Path, solver: str, name: str) -> None:
    """NLGEOM, quadratic elements, ties: equal increments; fields within Newton's tolerance, as a direction is solved to a thousandth of it."""
    deck = all_decks()[name]
    serial = run(tmp_path / "serial", deck, 0, DIALECT)
    ranks = run(tmp_path / "ranks", with_solver(deck, solver), 2, DIALECT)
    assert serial.code == 0 and "are distributed and solved by" in ranks.text
    what, worst = difference(serial, ranks)
    assert what == "" and worst < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["ITERATIVE SCALING", "GAMG", "HYPRE", "MUMPS"])
def test_contact_with_friction(tmp_path: Path, solver: str) -> None:
    """Two plates, pressed and dragged, with criteria of 1e-9: equal statuses in all increments. The bulk under the contact skin is a
    preconditioner: only directions depend on it, and of these only those that set origins of slip leave a trace. They are solved to
    1e-5 (`tolerance_origin` of the controls), and so far fields may differ."""
    deck = deck_of(Model(3, criteria=1e-9), interface="SKIN")
    serial = run(tmp_path / "serial", deck, 0)
    ranks = run(tmp_path / "ranks", with_solver(deck, solver), 2)
    assert (serial.code, ranks.code) == (0, 0), ranks.text
    assert np.array_equal(serial.counts["n_status"], ranks.counts["n_status"])
    for name, values in serial.fields.items():
        assert np.abs(values - ranks.fields[name]).max() < 1e-5 * np.abs(values).max()


@pytest.mark.parametrize("preconditioner", ["NODAL", "AMG", "FACTOR"])
def test_conjugate_gradients(tmp_path: Path, preconditioner: str) -> None:
    """Residuals by the elements of the ranks, friction, NLGEOM: the statuses and fields of Newton's method in the serial program, to 1e-5,
    which is required of conjugate gradients. AMG is multigrid of PETSc on one rank and on two."""
    deck = sample("three_cubes")
    serial = run(tmp_path / "serial", deck, 0)
    for n in (1, 2):
        ranks = run(tmp_path / f"ranks{n}", with_gradients(deck, preconditioner), n)
        assert (serial.code, ranks.code) == (0, 0), ranks.text
        assert ("are distributed and solved by GAMG." in ranks.text) == (preconditioner == "AMG"), ranks.text
        assert np.array_equal(serial.counts["n_status"], ranks.counts["n_status"])
        for name, values in serial.fields.items():
            assert np.abs(values - ranks.fields[name]).max() < 1e-5 * np.abs(values).max()


def test_contact_skin_on_four_ranks(tmp_path: Path) -> None:
    """Two plates of 30 000 unknowns, enough for ranks to share a factor: the contact skin keeps its own, and all counts, statuses and
    fields are those of the serial program."""
    deck = deck_of(Model(33, increments=1), "SKIN").split("*STEP", 2)
    serial, ranks = (run(tmp_path / str(n), "*STEP".join(deck[:2]), n) for n in (0, 4))
    assert serial.code == 0 and serial.statuses.size > 1000, serial.text
    assert "MUMPS" not in ranks.text
    what, worst = difference(serial, ranks)
    assert what == "" and worst < TOLERANCE


@pytest.mark.parametrize("solver", ["", "GAMG", "HYPRE"])
def test_same_bits_again(tmp_path: Path, solver: str) -> None:
    """Three ranks, five times: all bits of displacements and reactions. Sums by the arrival of messages differ in every other run."""
    deck = with_solver(deck_of(Model(3)), solver)
    first = run(tmp_path / "first", deck, 3)
    assert first.code == 0, first.text
    for k in range(4):
        again = run(tmp_path / f"again{k}", deck, 3)
        assert [name for name, values in first.fields.items() if values.tobytes() != again.fields[name].tobytes()] == []


def test_same_bits_again_by_bddc(tmp_path: Path) -> None:
    """Eight ranks of which several share an edge, six times: PETSc alone adds their coarse matrices by arrival: ten runs gave eight results."""
    deck = with_solver(cantilever("C3D20", (5, 5, 5), 0.49), "BDDC")
    first = run(tmp_path / "first", deck, 8)
    assert first.code == 0 and "a factor is used" not in first.text, first.text
    for k in range(5):
        again = run(tmp_path / f"again{k}", deck, 8)
        assert [name for name, values in first.fields.items() if values.tobytes() != again.fields[name].tobytes()] == []


def test_serial_program_refuses(tmp_path: Path) -> None:
    """Without PETSc its solvers are errors of the deck, reported with what is allowed."""
    for solver in ("GAMG", "BDDC"):
        outcome = run(tmp_path / solver, cube(2, f", SOLVER={solver}"), 0)
        assert outcome.code == 3 and "amontons-mpi has (make MPI=1)" in outcome.text and outcome.text.count("*ERROR: SOLVER") == 1


def errors_in(outcome: Outcome) -> int:
    """How often the end of a job is reported."""
    return re.sub(r"\x1b\[\d*m", "", outcome.text).count("*ERROR")


def test_errors_of_all_are_reported_once(tmp_path: Path) -> None:
    """A wrong deck, a missing folder and a user routine on two ranks."""
    assert errors_in(run(tmp_path, "*HEADING\n*STATIK\n", 2)) == errors_in(run(tmp_path, "*HEADING\n*STATIK\n", 0))
    missing = run(tmp_path, cube(2, ""), 2, "--outdir", "nowhere")
    assert missing.code == 7 and errors_in(missing) == 1
    user = run(tmp_path, cube(2, ""), 2, "--user", "routine.f90")
    assert user.code == 2 and errors_in(user) == 1 and "one rank" in user.text
    material = run(tmp_path, cube(2, "").replace("*ELASTIC", "*USER MATERIAL, CONSTANTS=2, LIBRARY=routine.so"), 2)
    assert material.code == 2 and errors_in(material) == 1 and "one rank" in material.text


def test_error_of_one_rank_ends_all(tmp_path: Path) -> None:
    """The second rank may take 500 MB, too little for the 60 000 unknowns: reported once, and all end within a minute."""
    (tmp_path / "job.inp").write_text(cube(26, ""))
    name = program("amontons-mpi")
    command = ["mpiexec", "-n", "1", name, "job", ":", "-n", "1", "bash", "-c", f"ulimit -v 500000; exec {name} job"]
    start = time.monotonic()
    done = subprocess.run(command, cwd=tmp_path, env=environment(), capture_output=True, text=True, timeout=120, check=False)
    assert time.monotonic() - start < 60
    assert done.returncode != 0
    assert errors_in(Outcome(0, done.stdout + done.stderr)) == 1 and "memory" in done.stdout + done.stderr


def interrupt(folder: Path, sign: int, n_increments: int) -> int:
    """Starts folder/job.inp on three ranks, sends a signal to the last one after some increments; the exit code of mpiexec."""
    with (folder / "output.txt").open("w") as output:
        process = subprocess.Popen(
            ["mpiexec", "-n", "3", program("amontons-mpi"), "--progress=plain", "job"], cwd=folder, env=environment(), stdout=output, stderr=output
        )
        while process.poll() is None and (folder / "output.txt").read_text().count(" 100 %") + count_lines(folder) < n_increments:
            time.sleep(0.02)
        os.kill(ranks_of(process)[-1], sign)
        return process.wait(timeout=60)


def count_lines(folder: Path) -> int:
    """Increments reported so far."""
    return sum(" % " in line for line in (folder / "output.txt").read_text().splitlines())


@pytest.mark.parametrize(("sign", "n"), [(signal.SIGKILL, 2), (signal.SIGKILL, 0), (signal.SIGTERM, 4)])
def test_a_rank_that_ends_and_resumption(tmp_path: Path, sign: int, n: int) -> None:
    """A rank is killed, or gets a signal to stop: the others end, the converged increments are on disk, and the job continues with another number
    of ranks (0: the serial program) to the same end as without interruption."""
    deck = deck_of(Model(5))
    whole = run(tmp_path / "whole", deck, 0)
    folder = tmp_path / "job"
    folder.mkdir()
    (folder / "job.inp").write_text(deck)
    assert interrupt(folder, sign, 4) != 0
    text = (folder / "output.txt").read_text()
    if sign == signal.SIGTERM:
        assert "stopped by SIGTERM" in text and errors_in(Outcome(0, text)) == 1
    assert (folder / "job.restart").exists()
    rest = execute(folder, n, "--resume")
    assert rest.code == 0, rest.text
    assert "continues after the checkpoint" in rest.text or (sign == signal.SIGKILL and "starts again from its beginning" in rest.text)
    what, worst = difference(whole, rest)
    assert what == "" and worst < 1e-9
