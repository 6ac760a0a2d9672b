"""A rigid circular punch on an elastic half space with friction, by boundary elements.

Rings of constant pressure p and radial shear q (outward, on the half space); G shear modulus, nu Poisson's ratio. Into the
half space and outward,

    u_z = (1 - nu)/G int p r' A dr' - (1 - 2 nu)/(2 G) int_r^a q dr'
    u_r = (1 - nu)/G int q r' B dr' - (1 - 2 nu)/(2 G r) int_0^r p r' dr'

with A = int J0(s r) J0(s r') ds and B = int J1(s r) J1(s r') ds, which are elliptic integrals (Johnson, Contact Mechanics, 1985,
sec. 3.8; Gradshteyn and Ryzhik 6.612). The pressing load grows in proportion and so does all else: a ring that slips has always
slipped, and one that sticks has u_r = 0.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipe, ellipkm1

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Punch:
    """The solution for radius 1 and depth 1."""

    r: Floats  #: (n,) middle of each ring
    p: Floats  #: (n,) pressure [G]
    q: Floats  #: (n,) radial shear [G]
    stick: NDArray[np.bool_]  #: (n,) rings that stick
    edges: Floats  #: (n + 1,)

    @property
    def force(self) -> float:
        """All of it, over G."""
        return float((self.p * np.pi * np.diff(self.edges**2)).sum())

    @property
    def stick_radius(self) -> float:
        """Outer edge of the last ring that sticks."""
        return float(self.edges[int(self.stick.sum())])


def kernels(r: Floats, other: Floats) -> tuple[Floats, Floats]:
    """A and B."""
    rest = np.maximum(((r - other) / (r + other)) ** 2, 1e-30)
    m = 1 - rest
    k, e = ellipkm1(rest), ellipe(m)
    chi = (r**2 + other**2) / (2 * r * other)
    q = chi * np.sqrt(m) * k - np.sqrt(2 * (chi + 1)) * e
    return 2 / np.pi * k / (r + other), q / (np.pi * np.sqrt(r * other))


def ring_integrals(edges: Floats) -> tuple[Floats, Floats]:
    """int A r' dr' and int B r' dr' over each ring (columns) seen from the middle of each (rows)."""
    middle = 0.5 * (edges[1:] + edges[:-1])
    x, w = np.polynomial.legendre.leggauss(16)
    x, w = 0.5 * (x + 1), 0.5 * w
    x, w = x**3, 3 * x**2 * w  # points gather at the middle of the ring, where its own kernel has a logarithm
    a = np.zeros((len(middle), len(middle)))
    b = np.zeros_like(a)
    for side in (-1, 1):
        half = 0.5 * np.diff(edges)
        for point, weight in zip(x, w, strict=True):
            place = middle + side * half * point
            values = kernels(middle[:, None], place[None, :])
            a += values[0] * (place * half * weight)
            b += values[1] * (place * half * weight)
    return a, b


def solve_punch(nu: float, mu: float, n: int = 200) -> Punch:
    """Which rings stick is found by trial: those that need more friction than there is slip, from the edge inwards."""
    edges = np.sin(np.linspace(0, np.pi / 2, n + 1))
    r = 0.5 * (edges[1:] + edges[:-1])
    a, b = ring_integrals(edges)
    areas = 0.5 * np.diff(edges**2)
    outside = np.triu(np.ones((n, n)), 1) * np.diff(edges) + np.diag(edges[1:] - r)
    inside = np.tril(np.ones((n, n)), -1) * areas + np.diag(0.5 * (r**2 - edges[:-1] ** 2))
    normal, coupling = (1 - nu) * a, -0.5 * (1 - 2 * nu) * outside
    radial, pull = (1 - nu) * b, -0.5 * (1 - 2 * nu) * inside / r[:, None]
    n_stick = n
    while True:
        stick = np.arange(n) < n_stick
        friction = np.where(stick[:, None], np.hstack([pull, radial]), np.hstack([-mu * np.eye(n), np.eye(n)]))
        rows = np.vstack([np.hstack([normal, coupling]), friction])
        p, q = np.split(np.linalg.solve(rows, np.concatenate([np.ones(n), np.zeros(n)])), 2)
        too_much = stick & (q > mu * p)
        if not too_much.any():
            return Punch(r, p, q, stick, edges)
        n_stick = max(n_stick - max(1, int(too_much.sum()) // 2), 0)
