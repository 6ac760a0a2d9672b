"""The slip scenarios of slave nodes of a program of your own: no job is needed.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from amontons.binding import library
from amontons.job import UsageError


@dataclass(frozen=True)
class Slip:
    """What friction does at each node."""

    scenario: NDArray[np.int32]  #: 1 to 4; 0: no slip search
    state: NDArray[np.int32]  #: 1 stick, 2 slip, 3 slip in balance, 4 opened
    length: NDArray[np.float64]  #: step length


def classify(tangential: ArrayLike, normal_force: ArrayLike, slip: ArrayLike, direction: ArrayLike, mu: ArrayLike,
             controls: ArrayLike | None = None) -> Slip:  # fmt: skip
    """State, scenario and step length of closed slave nodes, by the table of doc/theory/contact.md, section 4.

    Args:
        tangential: (2, n, 3) imbalance across the normal at the iterate u, and after the whole direction d.
        normal_force: (2, n) positive in compression; negative at u: the node opens.
        slip: (2, n, 3) slip since the start of the increment.
        direction: (n, 3) d at the nodes, tangential, relative to the master.
        mu: (n,) coefficients of friction, or one number.
        controls: |DR| that is in balance over mu N, the same as a force, a slip that is zero, least and largest length.

    Raises:
        UsageError: arrays of different lengths.
    """
    d = np.ascontiguousarray(direction, dtype=np.float64).reshape(-1, 3)
    n = len(d)
    try:
        arrays = [np.ascontiguousarray(tangential, dtype=np.float64).reshape(2, n, 3),
                  np.ascontiguousarray(normal_force, dtype=np.float64).reshape(2, n),
                  np.ascontiguousarray(slip, dtype=np.float64).reshape(2, n, 3), d,
                  np.ascontiguousarray(np.broadcast_to(np.asarray(mu, dtype=np.float64), (n,)))]  # fmt: skip
        bounds = None if controls is None else np.ascontiguousarray(controls, dtype=np.float64).reshape(5)
    except ValueError as wrong:
        raise UsageError(f"The arrays of {n} nodes do not fit together: {wrong}.") from wrong
    verdicts, length = np.empty((n, 2), dtype=np.int32), np.empty(n)
    status = library().amontons_classify(n, *(array.ctypes.data for array in arrays), None if bounds is None else bounds.ctypes.data,
                                         verdicts.ctypes.data, length.ctypes.data)  # fmt: skip
    if status:
        raise UsageError("The slip scenarios cannot be computed from these arrays.")
    return Slip(verdicts[:, 0], verdicts[:, 1], length)
