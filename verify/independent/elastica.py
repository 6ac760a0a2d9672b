"""Plane frames of slender beams at large displacements: extensible, without shear, by shooting along their axes.

The beam of E. Reissner (On one-dimensional finite-strain beam theory: the plane problem, ZAMP 23 (1972) 795-804) without shear. Its
internal force (H, V) is constant between loads, and along the arc s of the undeformed axis, which has the direction a,

    x' = (1 + e) cos t,   y' = (1 + e) sin t,   t' = a' + M/EI,   M' = (1 + e) (H sin t - V cos t),   e = (H cos t + V sin t)/EA.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import fsolve

STEPS = 100  #: of the Runge-Kutta rule of fourth order in each part of a beam


def shoot(state: np.ndarray, force: Sequence[float], length: float, stiffness: tuple[float, float]) -> np.ndarray:
    """x, y, direction and moment at the end of a straight part of a beam, from those at its start."""
    bending, axial = stiffness

    def slope(z: np.ndarray) -> np.ndarray:
        cosine, sine = np.cos(z[2]), np.sin(z[2])
        stretch = 1.0 + (force[0] * cosine + force[1] * sine) / axial
        return np.array([stretch * cosine, stretch * sine, z[3] / bending, stretch * (force[0] * sine - force[1] * cosine)])

    h = length / STEPS
    for _ in range(STEPS):
        k1 = slope(state)
        k2 = slope(state + 0.5 * h * k1)
        k3 = slope(state + 0.5 * h * k2)
        k4 = slope(state + h * k3)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return state


class LeeFrame:
    """Two beams of length 120 at a right angle, hinged at their far ends, and a force down on the second one, 24 from the corner.

    S. L. Lee, F. S. Manuel, E. C. Rossow, Large deflections and stability of elastic frames, ASCE J. Eng. Mech. 94 (1968) 521-547; with
    the data of K. H. Schweizerhof, P. Wriggers, Comput. Methods Appl. Mech. Eng. 59 (1986) 261-279: EA = 4320, EI = 1440.
    """

    stiffness = (1440.0, 4320.0)

    def __init__(self) -> None:
        self.unknowns = np.array([0.5 * np.pi, 0.0, -1e-3, 1e-3])  #: direction at the first hinge, its force, the load
        self.point = np.zeros(2)  #: deflection over 50, and load

    def miss(self, unknowns: np.ndarray, near: np.ndarray, along: np.ndarray) -> list[float]:
        """What is missing at the second hinge, and along the path."""
        direction, horizontal, vertical, load = unknowns
        corner = shoot(np.array([0.0, 0.0, direction, 0.0]), (horizontal, vertical), 120.0, self.stiffness)
        corner[2] -= 0.5 * np.pi
        loaded = shoot(corner, (horizontal, vertical), 24.0, self.stiffness)
        end = shoot(loaded, (horizontal, vertical + load), 96.0, self.stiffness)
        self.point = np.array([(120.0 - loaded[1]) / 50.0, load])
        return [end[0] - 120.0, end[1] - 120.0, end[3] / 100.0, float(np.dot(self.point - near, along))]

    def distance(self, deflection: float, load: float, along: np.ndarray) -> float:
        """Distance of a point from the path of the beams, at right angles to a direction, with deflections over 50. Points in their order
        along the path, each a start for the next.
        """
        near = np.array([deflection / 50.0, load])
        found, _, status, message = fsolve(self.miss, self.unknowns, args=(near, along), xtol=1e-12, full_output=True)
        assert status == 1, message
        self.unknowns = found
        return float(np.linalg.norm(self.point - near))


class Toggle:
    """Two beams from clamps to a ridge that keeps its direction, and a force down on the ridge.

    F. W. Williams, An approach to the non-linear behaviour of the members of a rigid jointed plane framework with finite deflections,
    Quart. J. Mech. Appl. Math. 17 (1964) 451-469.
    """

    def __init__(self, half_span: float, rise: float, stiffness: tuple[float, float]) -> None:
        self.half_span, self.rise, self.stiffness = half_span, rise, stiffness
        self.unknowns = np.array([-1e-3, 1e-3, 0.0])  #: force and moment at the clamp

    def miss(self, unknowns: np.ndarray, deflection: float) -> list[float]:
        """What is missing at the ridge."""
        direction = np.arctan2(self.rise, self.half_span)
        start = np.array([0.0, 0.0, direction, unknowns[2]])
        end = shoot(start, unknowns[:2], float(np.hypot(self.rise, self.half_span)), self.stiffness)
        return [end[0] - self.half_span, end[1] - self.rise + deflection, end[2] - direction]

    def load(self, deflection: float) -> float:
        """The load at a deflection."""
        found, _, status, message = fsolve(self.miss, self.unknowns, args=(deflection,), xtol=1e-12, full_output=True)
        assert status == 1, message
        self.unknowns = found
        return -2.0 * float(found[1])
