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

ABI = 3
NAME = "libamontons.so"

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


def find_library() -> str:
    """The path of libamontons: AMONTONS_LIBRARY, beside this file, in the tree around it, in the
    lib of `make install`, or the system's.

    Raises:
        OSError: it is nowhere.
    """
    named = os.environ.get("AMONTONS_LIBRARY")
    here = Path(__file__).resolve().parent
    places = [Path(named)] if named else [here / NAME, here.parent.parent / "lib" / NAME, here.parent.parent.parent / NAME]
    for place in places:
        if place.exists():
            return str(place)
    found = None if named else ctypes.util.find_library("amontons")
    if found is None:
        raise OSError(f"{NAME} was not found; build it with `make`, or name it in the environment variable AMONTONS_LIBRARY.")
    return found


@cache
def library() -> ctypes.CDLL:
    """The shared library, loaded once, with the signatures of its functions.

    Raises:
        OSError: it is nowhere, or has another binary interface than this package.
    """
    loaded = ctypes.CDLL(find_library())
    for name, (result, arguments) in SIGNATURES.items():
        function = getattr(loaded, name)
        function.restype = result
        function.argtypes = arguments
    if loaded.amontons_abi() != ABI:
        raise OSError(f"{find_library()} has binary interface {loaded.amontons_abi()}; this package needs {ABI}.")
    return loaded
