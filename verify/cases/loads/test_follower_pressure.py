"""Pressures that follow their faces: closed forms, and few iterations, for the tangent is exact though it is not symmetric.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import fsolve

from verify.conftest import Run
from verify.decks.make_decks import block
from verify.decks.solids import as_kind, node_set, pressure_on
from verify.independent.results import read_field, read_history

C10, D1, TENSION = 1.9, 0.026, 2.0
TIGHT = "*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9, , , 1e-9\n"


def pulled_bar() -> tuple[float, float]:
    """Stretches along and across a neo-Hookean bar under the Cauchy stress TENSION: U = C10 (I1 - 3) + (J - 1)^2/D1."""

    def stress(stretches: np.ndarray) -> list[float]:
        along, across = stretches
        J = along * across**2
        mean = 2 * (J - 1) / D1
        trace = along**2 + 2 * across**2
        return [2 * C10 * J ** (-5 / 3) * (s**2 - trace / 3) + mean - t for s, t in ((along, TENSION), (across, 0.0))]

    return tuple(fsolve(stress, [1.1, 0.95], xtol=1e-14))  # type: ignore[return-value]


@pytest.mark.parametrize("kind", ["C3D8", "C3D10", "C3D20R"])
def test_pulled_bar(kind: str, run_deck: Run, tmp_path: Path) -> None:
    """A slender bar stands free and is pulled at its end by a tension that follows it. The symmetric part of the tangent alone is
    not positive: the bar would seem to buckle.
    """
    bar = as_kind(block([0, 0.5, 1], [0, 0.5, 1], np.linspace(0, 8, 9), "BAR"), kind)
    end = bar.outer_faces(bar.where(2, 8.0))
    corner, along = bar.where(2, 0.0), np.flatnonzero(np.abs(bar.nodes - [1.0, 0, 0]).max(1) < 1e-9)
    origin = np.flatnonzero(np.abs(bar.nodes).max(1) < 1e-9)
    deck = (bar.cards() + node_set("FOOT", corner) + node_set("ORIGIN", origin) + node_set("ASIDE", along)
            + f"*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n{C10}, {D1}\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
            + "*STEP, NLGEOM\n*STATIC\n1., 1.\n" + TIGHT + "*BOUNDARY\nFOOT, 3\nORIGIN, 1, 2\nASIDE, 2\n"
            + pressure_on(end, -TENSION) + "*END STEP\n")
    result = run_deck(deck)
    assert result.returncode == 0, result.stdout + result.stderr
    u = read_field(tmp_path / "job.vtkhdf", "U")[-1]
    stretch = np.array(pulled_bar())[[1, 1, 0]]
    assert np.abs(u - bar.nodes * (stretch - 1)).max() <= 1e-7 * 8
    history = read_history(tmp_path / "job.vtkhdf")
    assert history["n_iterations"].sum() <= 6  # in one increment; four or five at a quadratic rate
