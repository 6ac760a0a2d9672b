"""Metals that expand otherwise in each direction, under small and large displacements: bars against closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.cases.inelastic.test_field_variables import N, bar, step
from verify.cases.inelastic.test_initial_strains import solve
from verify.conftest import Run

E, NU, YIELD, WARMED = 210000.0, 0.3, 250.0, 1000.0
EXPANSION = np.array([2e-5, 1e-5, 3e-5]) * WARMED  #: strains along the axes of the material
LAWS = {
    "isotropic": f"*PLASTIC\n{YIELD}, 0.\n{YIELD}, 1.\n",
    "kinematic": f"*PLASTIC, HARDENING=KINEMATIC\n{YIELD}, 0.\n{YIELD + 0.01}, 1.\n",
    "creep": "*CREEP\n1.E-20, 4., 0.\n",
}


def warmed(law: str, angle: float, cards: str, option: str, n: int = 1) -> str:
    """A bar whose material is turned by an angle [degrees] about z and warmed."""
    material = f"*ELASTIC\n{E}, {NU}\n*EXPANSION, TYPE=ORTHO\n2.E-5, 1.E-5, 3.E-5\n{LAWS[law]}"
    text = bar(material, "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n", step(f"*TEMPERATURE\nALL, {WARMED}\n{cards}", n, option))
    axes = f"*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n3, {angle}\n"
    return axes + text.replace("MATERIAL=M\n", "MATERIAL=M, ORIENTATION=O\n")


@pytest.mark.parametrize("option", ["", ", NLGEOM"])
@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("law", LAWS)
def test_no_stress(run: Run, tmp_path: Path, law: str, dialect: str, option: str) -> None:
    """Every node is moved as a free bar expands: 1 + e, in the abaqus dialect under NLGEOM exp(e), has no stress."""
    angle = np.radians(30.0)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    stretch = np.expm1(EXPANSION) if option and dialect == "abaqus" else EXPANSION
    strain = turn @ np.diag(stretch) @ turn.T
    places = {1 + 4 * i + k: (i, y, z) for i in range(N + 1) for k, (y, z) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)))}
    moved = "".join(f"{n}, {d + 1}, {d + 1}, {(strain @ x)[d]:.15g}\n" for n, x in places.items() for d in range(3))
    deck = warmed(law, 30.0, f"*BOUNDARY\n{moved}", option).replace("*STATIC", "*VISCO, CETOL=1." if law == "creep" else "*STATIC")
    _, stress = solve(run, tmp_path, deck, dialect)
    assert np.abs(stress).max() < 1e-8 * E


@pytest.mark.parametrize("option", ["", ", NLGEOM"])
@pytest.mark.parametrize("dialect", ["abaqus", "calculix"])
@pytest.mark.parametrize("law", ["isotropic", "kinematic"])
def test_held_bar_yields(run: Run, tmp_path: Path, law: str, dialect: str, option: str) -> None:
    """Held along x, where the second axis of the material lies: the stress is the yield stress, and the sides take half the flow each.

    In the abaqus dialect under NLGEOM the yield stress is that of the Kirchhoff stress, J times Cauchy's.
    """
    e = EXPANSION[[1, 0, 2]]
    deck = warmed(law, 90.0, "*BOUNDARY\nX4, 1\n", option, 20)
    u, stress = solve(run, tmp_path, deck, dialect)
    is_stretch = bool(option) and dialect == "calculix"
    along = np.log1p(e[0]) if is_stretch else e[0]
    elastic = YIELD / E
    flow = along - elastic
    aside = NU * elastic + 0.5 * flow + (np.log1p(e[1:]) if is_stretch else e[1:])
    volume = np.exp(aside.sum()) if option and not is_stretch else 1.0
    assert stress[0] == pytest.approx(-YIELD / volume, rel=1e-4)
    assert u[1:] == pytest.approx(np.expm1(aside) if option else aside, rel=1e-4)
