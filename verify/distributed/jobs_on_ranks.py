"""Jobs of the library on a communicator, to be run by mpiexec: what each rank gets goes to FOLDER/rank<r>.npz.

    mpiexec -n 3 python -m verify.distributed.jobs_on_ranks conversation|half|partitions|errors FOLDER

`conversation` makes the calls that test_library_on_ranks.py makes with the library of one rank. `half` has jobs on parts of the ranks, then one on
all. `partitions` writes results in two partitions. `errors` collects the messages of calls that fail.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import amontons
from verify.benchmark.estimate_table import cube
from verify.benchmark.wide_contact import Model, deck_of
from verify.decks.make_decks import block_deck

QUANTITIES = ("U", "RF", "S", "E", "CPRESS", "CSHEAR", "COPEN", "CSTATUS", "CSCENARIO", "CONTACT FORCE", "INTERNAL FORCE", "RESIDUAL", "POINT S", "POINT E",
              "POINT VOLUME", "ELEMENT ENERGY", "TIME", "ITERATIONS", "INCREMENTS", "STRAIN ENERGY", "FRICTION WORK")  # fmt: skip


def conversation(job: amontons.Job) -> dict[str, np.ndarray]:
    """Advance, set, try, roll back, iterate, look within an increment, commit, matrices, run to the end: all values on the way."""
    found: dict[str, np.ndarray] = {}

    def look(when: str) -> None:
        found.update({f"{when}: {name}": job.get(name) for name in QUANTITIES})

    job.advance_to(0.35)
    look("advanced")
    job.set("U3", "UPPER_TOP", -0.0011)
    job.set("FRICTION", "RUBBING", 0.25)
    job.try_step(0.2)
    look("tried")
    job.rollback()
    look("rolled back")
    job.begin(0.1)
    verdict = job.iterate()
    look("first iteration")
    while verdict is amontons.Verdict.GO_ON:
        verdict = job.iterate()
    job.commit()
    for name in ("TANGENT", "MAP", "STIFFNESS"):
        matrix, residual = job.matrix(name)
        found |= {f"{name} rows": matrix.first, f"{name} columns": matrix.column, f"{name} values": matrix.value, f"{name} residual": residual}
    job.run()
    look("end")
    return found


def converse(comm: object, folder: Path) -> dict[str, np.ndarray]:
    """On all ranks, with files and a log."""
    heard: list[str] = []
    with amontons.Job(text=block_deck(2), name="job", outdir=folder, files=True, checkpoint=True, log=heard.append, comm=comm) as job:
        found = conversation(job)
    return found | {"heard": np.array(len(heard))}


def halves(comm: object, _: Path) -> dict[str, np.ndarray]:
    """Two jobs on two parts of the ranks at once, with multigrid; then one of the second part alone, then one on all ranks by each solver."""
    found: dict[str, np.ndarray] = {}
    part = comm.Split(comm.rank % 2)
    for solver in ("GAMG", "HYPRE", "MUMPS"):
        with amontons.Job(text=cube(3 + comm.rank % 2, f", SOLVER={solver}"), comm=part) as job:
            job.run()
            found[f"part {comm.rank % 2} {solver}"] = job.get("U")
    if comm.rank % 2 == 1:
        with amontons.Job(text=cube(3, ""), comm=part) as job:
            job.run()
            found["odd ranks alone"] = job.get("U")
    comm.Barrier()
    for solver in ("GAMG", "HYPRE", "MUMPS"):
        with amontons.Job(text=cube(4, f", SOLVER={solver}"), comm=comm) as job:
            job.run()
            found[f"all {solver}"] = job.get("U")
    return found


def partitions(comm: object, folder: Path) -> dict[str, np.ndarray]:
    """The contact of test_partitions.py with a file for each of two groups of ranks."""
    with amontons.Job(text=deck_of(Model(5)), name="job", outdir=folder, partitions=2, comm=comm) as job:
        job.run()
        return {"U": job.get("U")}


def message_of(call: Callable[[], object]) -> str:
    """Kind and text of the error of a call."""
    try:
        call()
    except amontons.AmontonsError as error:
        return f"{type(error).__name__}: {error}"
    return "no error"


def errors(comm: object, folder: Path) -> dict[str, np.ndarray]:
    """Of a deck, of a model that cannot converge, of the order of calls, of arguments that differ, of ranks that are mixed."""
    from mpi4py import MPI

    heard: list[str] = []
    found = {
        "deck": message_of(lambda: amontons.Job(text="*HEADING\n*STATIK\n", comm=comm, log=heard.append)),
        "no rank": message_of(lambda: amontons.Job(text=cube(2, ""), comm=MPI.COMM_NULL)),
        "different decks": message_of(lambda: amontons.Job(text=cube(2 + comm.rank % 2, ""), comm=comm)),
        "user": message_of(lambda: amontons.Job(text=cube(2, ""), user="routine.f90", comm=comm)),
        "alone": message_of(lambda: amontons.Job(text=cube(2, ", SOLVER=GAMG"))),
        "different partitions": message_of(lambda: amontons.Job(text=cube(2, ""), outdir=folder, partitions=1 + comm.rank, comm=comm)),
        "partitions": message_of(lambda: amontons.Job(text=cube(2, ""), outdir=folder, partitions=-1, comm=comm)),
        "folder": message_of(lambda: amontons.Job(text=cube(2, ""), outdir=folder / "nowhere", files=True, comm=comm)),
    }
    with amontons.Job(text=block_deck(2), comm=comm) as job:
        found["other"] = message_of(lambda: amontons.Job(text=cube(2, ""), comm=MPI.COMM_SELF))
        found["step"] = message_of(lambda: job.try_step(0.1 + 0.1 * comm.rank))
        found["set"] = message_of(lambda: job.set("U3", "UPPER_TOP", -0.001 * (1 + comm.rank)))
        found["name"] = message_of(lambda: job.get("NONSENSE"))
        job.set("U3", "UPPER_TOP", -50.0)
        found["not converged"] = message_of(lambda: job.try_step(1.0))
        job.set("U3", "UPPER_TOP", -0.001)
        job.try_step(0.1)
        found["continues"] = f"{job.time:.12g}"
    return {name: np.array(text) for name, text in found.items()} | {"heard": np.array(len(heard))}


def main(words: list[str]) -> None:
    """What one rank does."""
    from mpi4py import MPI

    work = {"conversation": converse, "half": halves, "partitions": partitions, "errors": errors}[words[0]]
    np.savez(Path(words[1]) / f"rank{MPI.COMM_WORLD.rank}.npz", **work(MPI.COMM_WORLD, Path(words[1])))


if __name__ == "__main__":
    main(sys.argv[1:])
