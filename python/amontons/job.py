"""A job: the verbs of amontons.h as methods, arrays as numpy arrays, errors as exceptions.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from amontons.binding import ABI, Log, Options, library


class AmontonsError(Exception):
    """What went wrong; `status` is the exit code that the program would end with."""

    status = 8


class UsageError(AmontonsError):
    """The call is wrong: a name, a number of values, an order of calls."""

    status = 2


class DeckError(AmontonsError):
    """The deck has errors; the message lists all of them with their lines."""

    status = 3


class SetupError(AmontonsError):
    """The model is not supported: rigid body motion is possible."""

    status = 4


class NotConvergedError(AmontonsError):
    """No smaller increment is allowed. The job is as at its last commit."""

    status = 5


class SolverError(AmontonsError):
    """Linear solver or memory."""

    status = 6


class FileError(AmontonsError):
    """Reading or writing a file."""

    status = 7


class InternalError(AmontonsError):
    """An internal error of Amontons."""


ERRORS = {kind.status: kind for kind in (UsageError, DeckError, SetupError, NotConvergedError, SolverError, FileError)}


class Verdict(IntEnum):
    """The outcome of a Newton iteration."""

    GO_ON = 0
    CONVERGED = 1
    DIVERGES = 2
    TOO_SLOW = 3


@dataclass(frozen=True)
class Matrix:
    """A matrix by compressed rows, counted from 0: what scipy.sparse.csr_array((value, column, first), shape) takes."""

    shape: tuple[int, int]
    first: NDArray[np.int64]
    column: NDArray[np.int64]
    value: NDArray[np.float64]

    def dense(self) -> NDArray[np.float64]:
        """The whole matrix; for small ones."""
        whole = np.zeros(self.shape)
        rows = np.repeat(np.arange(self.shape[0]), np.diff(self.first))
        np.add.at(whole, (rows, self.column), self.value)
        return whole

    def __matmul__(self, vector: ArrayLike) -> NDArray[np.float64]:
        """The product with a vector."""
        rows = np.repeat(np.arange(self.shape[0]), np.diff(self.first))
        return np.bincount(rows, self.value * np.asarray(vector, dtype=float)[self.column], self.shape[0])


@dataclass(frozen=True)
class Increment:
    """An increment that is committed."""

    step: int  #: counted from 1
    number: int  #: in the job, counted from 1
    time: float  #: total time at its end
    dt: float  #: its length
    iterations: int  #: Newton iterations, those of failed attempts too


def version() -> str:
    """The version of the library."""
    text = ctypes.create_string_buffer(64)
    library().amontons_version(text, len(text))
    return text.value.decode()


def encoded(text: str | PathLike[str] | None) -> bytes | None:
    """A text for C."""
    return None if text is None else str(text).encode()


class Communicator(Protocol):
    """A communicator of mpi4py."""

    def py2f(self) -> int:
        """Its Fortran handle."""


class Job:
    """A job. Its state is the last commit; later solutions can be kept (commit) or discarded (rollback).

    `for increment in job` solves and commits the increments of the deck one by one.

    A job belongs to one thread at a time; several jobs may run side by side in threads of their own.
    """

    def __init__(
        self,
        deck: str | PathLike[str] | None = None,
        *,
        text: str | None = None,
        name: str | None = None,
        outdir: str | PathLike[str] | None = None,
        dialect: str | None = None,
        threads: int = 1,
        files: bool = False,
        checkpoint: bool = False,
        resume: bool = False,
        check: bool = False,
        partitions: int = 0,
        user: str | PathLike[str] | None = None,
        old_job: str | PathLike[str] | None = None,
        log: Callable[[str], None] | None = None,
        comm: Communicator | None = None,
    ) -> None:
        """Begins a job.

        Args:
            deck: path of the deck; with a text it only names it in messages.
            text: the deck itself.
            name: of the result files; default that of the deck.
            outdir: folder of the result files; default that of the deck.
            dialect: "abaqus" or "calculix"; default what the deck says.
            threads: number of threads of this job.
            files: write job.vtkhdf, job.sta, job.cvg, job.dat.
            checkpoint: and job.restart at each commit.
            resume: continue after that checkpoint.
            check: read the deck and check the model, no more.
            partitions: write files, grid and fields of job.vtkhdf divided into so many (up to 9999), which groups of ranks write.
            user: routines of the user (UMAT, ...): a Fortran file, which is compiled, or a shared library.
            old_job: the job whose restart file (old_job.res) a deck with *RESTART, READ continues from.
            log: is given the lines that the program would print; on several ranks those of the first.
            comm: a communicator of mpi4py (MPI.COMM_WORLD): the job runs on its ranks, which all make the same calls with the
                same arguments and get the same values and exceptions.

        Raises:
            AmontonsError: one of its kinds.
        """
        self._library = library(comm is not None)
        self._job = ctypes.c_void_p()
        self._name = name or (Path(deck).stem if deck is not None else "job")
        self._log = Log((lambda _, line: log(line.decode(errors="replace"))) if log else 0)
        options = Options(
            ABI, threads, files, checkpoint, resume, check, partitions, encoded(deck), encoded(text), encoded(name), encoded(outdir),
            encoded(dialect), encoded(user), encoded(old_job), self._log, None,
        )  # fmt: skip
        if comm is None:
            status = self._library.amontons_open(ctypes.byref(options), ctypes.byref(self._job))
        else:
            status = self._library.amontons_open_on(ctypes.byref(options), comm.py2f(), ctypes.byref(self._job))
        try:
            self._judge(status)
        except AmontonsError:
            self.close()
            raise

    def _judge(self, status: int) -> None:
        """Raises the exception of a status that is not 0."""
        if status == 0:
            return
        message = self._library.amontons_message(self._job) if self._job else b"There is no such job, or no memory."
        raise ERRORS.get(status, InternalError)(message.decode(errors="replace"))

    def __enter__(self) -> Job:
        """The job itself; it is closed at the end of the block."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Finishes and closes the job."""
        if kind is None:
            self.finish()
        self.close()

    def __repr__(self) -> str:
        """Where it stands."""
        if not self._job:
            return f"<Job {self._name}: closed>"
        end = "done" if self.is_done else "not done"
        return f"<Job {self._name}: step {self.number('STEP'):.0f}, {self.number('INCREMENTS'):.0f} increments, time {self.time:g}, {end}>"

    def __iter__(self) -> Iterator[Increment]:
        """The increments that are left, each as soon as it is committed; the files are closed after the last."""
        iterations = int(self.number("ITERATIONS"))
        while not self.is_done:
            time = self.time
            self.advance()
            before, iterations = iterations, int(self.number("ITERATIONS"))
            yield Increment(int(self.number("STEP")), int(self.number("INCREMENTS")), self.time, self.time - time, iterations - before)
        self.finish()

    def __del__(self) -> None:
        """Gives the memory back."""
        if getattr(self, "_job", None):
            self.close()

    def close(self) -> None:
        """Ends the job and gives its memory back; no call is allowed after that."""
        self._library.amontons_close(self._job)
        self._job = ctypes.c_void_p()

    @property
    def is_done(self) -> bool:
        """Whether all steps are done."""
        return bool(self._library.amontons_is_done(self._job))

    @property
    def time(self) -> float:
        """The total time of what is solved."""
        return self.number("TIME")

    def advance(self) -> bool:
        """One increment as the deck says, committed. Returns whether there is more to do."""
        self._judge(self._library.amontons_advance(self._job))
        return not self.is_done

    def advance_to(self, time: float) -> None:
        """Increments until a total time, each committed."""
        self._judge(self._library.amontons_advance_to(self._job, time))

    def run(self) -> None:
        """All that is left to do."""
        while not self.is_done:
            self.advance()

    def try_step(self, dt: float) -> float:
        """Solves to now + dt, or to the end of the step if that comes first; not committed. Returns the time reached."""
        self._judge(self._library.amontons_try(self._job, dt))
        return self.time

    def begin(self, dt: float) -> None:
        """Begins an increment that is to be solved by `iterate`."""
        self._judge(self._library.amontons_begin(self._job, dt))

    def iterate(self) -> Verdict:
        """One Newton iteration."""
        verdict = ctypes.c_int()
        self._judge(self._library.amontons_iterate(self._job, ctypes.byref(verdict)))
        return Verdict(verdict.value)

    def commit(self) -> None:
        """Keeps what was solved since the last commit, and writes it."""
        self._judge(self._library.amontons_commit(self._job))

    def rollback(self) -> None:
        """Everything is bitwise as at the last commit. Values that were set stay set."""
        self._judge(self._library.amontons_rollback(self._job))

    def finish(self) -> None:
        """Closes the files; the job still returns its values."""
        self._judge(self._library.amontons_finish(self._job))

    def get(self, quantity: str, where: str | int = "") -> NDArray[np.float64]:
        """A quantity at the nodes of a set, surface or label ("": all nodes), one row per node.

        CFN, CFS, CAREA and the other sums over contact pairs take "slave / master" or the slave surface; one row per pair.
        POINT quantities have one row per integration point of an element set or the label of an element, ELEMENT
        quantities one per element; numbers are single ones. The names are in doc/manual/library.md, and
        names("QUANTITIES") lists them.
        """
        rows, columns = ctypes.c_int64(), ctypes.c_int64()
        names = (quantity.encode(), str(where).encode())
        shape = (ctypes.byref(rows), ctypes.byref(columns))
        self._judge(self._library.amontons_get(self._job, *names, None, 0, *shape))
        values = np.empty((rows.value, columns.value))
        self._judge(self._library.amontons_get(self._job, *names, values.ctypes.data, values.size, *shape))
        return values[:, 0] if columns.value == 1 else values

    def number(self, quantity: str, where: str = "") -> float:
        """A quantity that is a single number, e.g. "TIME", "FRICTION"."""
        values = self.get(quantity, where)
        if values.size != 1:
            raise UsageError(f"{quantity} is not a single number.")
        return float(values.ravel()[0])

    def nodes(self, where: str | int = "") -> NDArray[np.int64]:
        """The labels of the nodes of a set or surface, in the order of `get`."""
        return self.get("NODES", where).astype(np.int64)

    def names(self, kind: str) -> list[str]:
        """The names of "NODE SETS", "ELEMENT SETS", "SURFACES", "PAIRS", "INTERACTIONS", "MATERIALS", or the "QUANTITIES" of `get`."""
        length = ctypes.c_int64()
        self._judge(self._library.amontons_names(self._job, kind.encode(), None, 0, ctypes.byref(length)))
        text = ctypes.create_string_buffer(length.value)
        self._judge(self._library.amontons_names(self._job, kind.encode(), text, length, None))
        return text.value.decode(errors="replace").splitlines()

    def set(self, quantity: str, where: str | int, values: ArrayLike) -> None:
        """Sets FRICTION of an interaction, P of a surface, or NT, CF, CF1 to CF3, U, U1 to U3 of a node set.

        One value per component for all rows, or an array with one row per node (face). It is reached, straight from
        where it stands, at the end of the increments solved next.
        """
        array = np.ascontiguousarray(values, dtype=np.float64)
        names = (quantity.encode(), str(where).encode())
        self._judge(self._library.amontons_set(self._job, *names, array.ctypes.data, array.size))

    def matrix(self, name: str = "TANGENT") -> tuple[Matrix, NDArray[np.float64]]:
        """A matrix at what is solved, and the residual of the free unknowns.

        TANGENT is on the free unknowns v; MAP is C of du = C dv + c; STIFFNESS is that of the elements on all unknowns.
        """
        sizes = [ctypes.c_int64() for _ in range(3)]
        self._judge(self._library.amontons_matrix(self._job, name.encode(), *map(ctypes.byref, sizes)))
        rows, columns, entries = (size.value for size in sizes)
        first, column = np.empty(rows + 1, dtype=np.int64), np.empty(entries, dtype=np.int64)
        value = np.empty(entries)
        self._judge(self._library.amontons_matrix_copy(self._job, first.ctypes.data, column.ctypes.data, value.ctypes.data))
        residual = np.empty(columns if name.upper() != "STIFFNESS" else self._free_unknowns())
        self._judge(self._library.amontons_residual_copy(self._job, residual.ctypes.data))
        return Matrix((rows, columns), first, column, value), residual

    def _free_unknowns(self) -> int:
        """The number of free unknowns."""
        sizes = [ctypes.c_int64() for _ in range(3)]
        self._judge(self._library.amontons_matrix(self._job, b"MAP", *map(ctypes.byref, sizes)))
        return sizes[1].value
