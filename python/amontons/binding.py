"""The C functions of amontons.h by ctypes, and where the shared library is found.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes
import ctypes.util
import os
from ctypes import CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_int, c_int32, c_int64, c_void_p
from functools import cache
from pathlib import Path

ABI = 4
NAMES = {False: "libamontons.so", True: "libamontons-mpi.so"}  #: for one rank, and on a communicator
VARIABLES = {False: "AMONTONS_LIBRARY", True: "AMONTONS_MPI_LIBRARY"}

Log = CFUNCTYPE(None, c_void_p, c_char_p)


class Options(Structure):
    """amontons_options."""

    _fields_ = [
        ("abi", c_int32),
        ("n_threads", c_int32),
        ("has_files", c_int32),
        ("has_checkpoint", c_int32),
        ("is_resumed", c_int32),
        ("is_check", c_int32),
        ("n_partitions", c_int32),
        ("deck", c_char_p),
        ("text", c_char_p),
        ("job", c_char_p),
        ("outdir", c_char_p),
        ("dialect", c_char_p),
        ("user", c_char_p),
        ("old_job", c_char_p),
        ("log", Log),
        ("context", c_void_p),
    ]


SIGNATURES: dict[str, tuple[object, list[object]]] = {
    "amontons_abi": (c_int, []),
    "amontons_version": (None, [c_char_p, c_int]),
    "amontons_classify": (c_int, [c_int64] + 8 * [c_void_p]),
    "amontons_open": (c_int, [POINTER(Options), POINTER(c_void_p)]),
    "amontons_open_on": (c_int, [POINTER(Options), c_int, POINTER(c_void_p)]),
    "amontons_close": (None, [c_void_p]),
    "amontons_message": (c_char_p, [c_void_p]),
    "amontons_is_done": (c_int, [c_void_p]),
    "amontons_advance": (c_int, [c_void_p]),
    "amontons_advance_to": (c_int, [c_void_p, c_double]),
    "amontons_try": (c_int, [c_void_p, c_double]),
    "amontons_begin": (c_int, [c_void_p, c_double]),
    "amontons_iterate": (c_int, [c_void_p, POINTER(c_int)]),
    "amontons_commit": (c_int, [c_void_p]),
    "amontons_rollback": (c_int, [c_void_p]),
    "amontons_finish": (c_int, [c_void_p]),
    "amontons_get": (c_int, [c_void_p, c_char_p, c_char_p, c_void_p, c_int64, POINTER(c_int64), POINTER(c_int64)]),
    "amontons_set": (c_int, [c_void_p, c_char_p, c_char_p, c_void_p, c_int64]),
    "amontons_names": (c_int, [c_void_p, c_char_p, c_void_p, c_int64, POINTER(c_int64)]),
    "amontons_matrix": (c_int, [c_void_p, c_char_p, POINTER(c_int64), POINTER(c_int64), POINTER(c_int64)]),
    "amontons_matrix_copy": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "amontons_residual_copy": (c_int, [c_void_p, c_void_p]),
}


def find_library(has_ranks: bool = False) -> str:
    """The path of libamontons (with ranks libamontons-mpi): AMONTONS_LIBRARY (AMONTONS_MPI_LIBRARY), beside this file, in the
    tree around it, in the lib of `make install`, or the system's.

    Raises:
        OSError: it is nowhere.
    """
    name, variable = NAMES[has_ranks], VARIABLES[has_ranks]
    named = os.environ.get(variable)
    here = Path(__file__).resolve().parent
    places = [Path(named)] if named else [here / name, here.parent.parent / "lib" / name, here.parent.parent.parent / name]
    for place in places:
        if place.exists():
            return str(place)
    found = None if named else ctypes.util.find_library(name[3:-3])
    if found is None:
        command = "make MPI=1" if has_ranks else "make"
        raise OSError(f"{name} was not found; build it with `{command}`, or name it in the environment variable {variable}.")
    return found


@cache
def library(has_ranks: bool = False) -> ctypes.CDLL:
    """The shared library, loaded once, with the signatures of its functions.

    Raises:
        OSError: it is nowhere, or has another binary interface than this package.
    """
    path = find_library(has_ranks)
    loaded = ctypes.CDLL(path)
    for name, (result, arguments) in SIGNATURES.items():
        function = getattr(loaded, name)
        function.restype = result
        function.argtypes = arguments
    if loaded.amontons_abi() != ABI:
        raise OSError(f"{path} has binary interface {loaded.amontons_abi()}; this package needs {ABI}.")
    return loaded
