"""Mohr and Coulomb's law against closed forms: compression, tension, apex, triaxial states; Prandtl's strip footing; refusals.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.cases.inelastic.test_drucker_prager import BULK, LIMIT, NU, ROUNDING, SYMMETRY, YOUNG, check, count, cube, finish, footing, pressures, stresses
from verify.conftest import Run

COHESION, PHI, PSI = 10.0, np.radians(30.0), np.radians(12.0)
VERTEX = 0.1 * COHESION * np.tan(PSI)  #: of the hyperbolic potential, by the default ECCENTRICITY


def soil(phi: float = 30.0, psi: float = 12.0, cohesion: float = COHESION, slope: float = 0.0) -> str:
    """The material cards."""
    return (
        f"*MATERIAL, NAME=SOIL\n*ELASTIC\n{YOUNG}, {NU}\n*MOHR COULOMB\n{phi:.15g}, {psi:.15g}\n*MOHR COULOMB HARDENING\n"
        f"{cohesion:.15g}, 0.\n{cohesion + slope:.15g}, 1.\n"
    )


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("option", ["", ", NLGEOM"])
def test_uniaxial(run_deck: Run, tmp_path: Path, sign: int, option: str) -> None:
    """Uniaxial compression and tension: the stress is 2 c cos(phi)/(1 -+ sin(phi)), a meridian of the hexagon and of the potential.

    There the potential is sqrt(a^2 + (m q)^2) - p tan(psi) with m = (3 -+ sin(phi))/(6 cos(phi)) and a = 0.1 c tan(psi), so that the
    plastic volume is tan(psi) sqrt(1 + (a/(m q))^2)/m of the equivalent deviatoric strain. Under NLGEOM the same holds between the
    logarithmic strains and the Kirchhoff stress.
    """
    strain = 0.05
    stretch = np.exp(sign * strain) - 1 if option else sign * strain
    finish(run_deck, cube(soil(), SYMMETRY + f"Z1, 3, 3, {stretch:.17g}\n", option))
    size = 2 * COHESION * np.cos(PHI) / (1 + sign * np.sin(PHI))
    m = (3 + sign * np.sin(PHI)) / (6 * np.cos(PHI))
    ratio = np.tan(PSI) / m * np.sqrt(1 + (VERTEX / (m * size)) ** 2)
    deviatoric = (strain - size / YOUNG) / (1 + sign * ratio / 3)
    lateral = -sign * NU * size / YOUNG - sign * deviatoric / 2 + ratio * deviatoric / 3
    volume = 2 * lateral + sign * strain
    u, found = stresses(tmp_path)
    assert found[2] == pytest.approx(sign * size / (np.exp(volume) if option else 1.0), rel=ROUNDING)
    assert np.abs(found[[0, 1, 3, 4, 5]]).max() <= 1e-6 * size
    assert u[6, 0] == pytest.approx(np.expm1(lateral) if option else lateral, rel=1e-7)


def test_calculix_dialect_has_the_same_law(run_deck: Run, tmp_path: Path) -> None:
    """Under the other dialect the law at finite strain is the same."""
    finish(run_deck, cube(soil(), SYMMETRY + "Z1, 3, 3, -0.1\n", ", NLGEOM"))
    u, s = stresses(tmp_path)
    finish(run_deck, cube(soil(), SYMMETRY + "Z1, 3, 3, -0.1\n", ", NLGEOM"), "--dialect=calculix")
    other_u, other_s = stresses(tmp_path)
    assert other_u == pytest.approx(u, rel=1e-5)
    assert other_s == pytest.approx(s, rel=1e-5, abs=1e-4)


@pytest.mark.parametrize("pressure", [20.0, 100.0])
@pytest.mark.parametrize("sign", [-1, 1])
def test_triaxial(run_deck: Run, tmp_path: Path, pressure: float, sign: int) -> None:
    """Triaxial compression and extension under a cell pressure P: with N = tan^2(45 + phi/2) the greater pressure is N times the smaller
    plus 2 c sqrt(N)."""
    n = np.tan(np.pi / 4 + PHI / 2) ** 2
    axial = n * pressure + 2 * COHESION * np.sqrt(n) if sign < 0 else (pressure - 2 * COHESION * np.sqrt(n)) / n
    deck = cube(soil(), SYMMETRY + f"Z1, 3, 3, {sign * 0.5}\n", n=20)
    faces = "*SURFACE, NAME=SIDES\n1, S4\n1, S5\n*STEP"
    deck = deck.replace("*STEP", faces, 1).replace("*END STEP", f"*DSLOAD\nSIDES, P, {pressure}\n*END STEP")
    finish(run_deck, deck)
    _, found = stresses(tmp_path)
    assert found[2] == pytest.approx(-axial, rel=ROUNDING)
    assert found[:2] == pytest.approx(-pressure, rel=1e-6)


@pytest.mark.parametrize("slope", [0.0, 20.0])
def test_hardening_by_work(run_deck: Run, tmp_path: Path, slope: float) -> None:
    """Tension in all directions: the mean stress is c/tan(phi), the equivalent plastic strain the plastic volume over tan(phi)."""
    volume = 0.15
    spread = "".join(f"{'XYZ'[axis]}1, {axis + 1}, {axis + 1}, {volume / 3}\n" for axis in range(3))
    finish(run_deck, cube(soil(slope=slope), SYMMETRY + spread, n=40))
    ratio = 1 / np.tan(PHI)
    plastic = (volume - ratio * COHESION / BULK) / (1 + ratio * slope * ratio / BULK)
    _, found = stresses(tmp_path)
    # the growth of e is work over the cohesion at the end of an increment, exact for one of constant pressure
    assert found[:3] == pytest.approx(ratio * (COHESION + slope * ratio * plastic), rel=1e-7)
    assert np.abs(found[3:]).max() <= 1e-9


def test_strip_footing(run_deck: Run, tmp_path: Path) -> None:
    """Prandtl's limit load, (exp(pi tan phi) tan^2(45 + phi/2) - 1) c/tan(phi), with the soil of the cone that is matched to it.

    Displacement elements reach the limit from above, with an error of the first order.
    """
    excess = []
    for n in (6, 12):
        deck = footing(n)
        start, end = deck.index("*DRUCKER PRAGER\n"), deck.index("*SOLID SECTION")
        text = finish(run_deck, deck[:start] + "*MOHR COULOMB\n20., 20.\n*MOHR COULOMB HARDENING\n1., 0.\n" + deck[end:])
        p = pressures(tmp_path / "job.vtkhdf")
        assert count(text, "attempts that failed") == 0
        excess.append(p[-1] / LIMIT - 1)
    assert 0 < excess[1] < 0.6 * excess[0]
    assert 2 * excess[1] - excess[0] == pytest.approx(0.0, abs=0.02), "extrapolated by the first order"


START = "*MATERIAL, NAME=SOIL\n*ELASTIC\n1000., .3\n"
ANGLES, HARDENING = "*MOHR COULOMB\n30., 10.\n", "*MOHR COULOMB HARDENING\n10., 0.\n"


@pytest.mark.parametrize(
    "cards, words",
    [
        (START + ANGLES, "needs both"),
        (START + HARDENING, "needs both"),
        (START + "*MOHR COULOMB\n86., 10.\n" + HARDENING, "friction angle must be from 0 to 85"),
        (START + "*MOHR COULOMB\n30., 40.\n" + HARDENING, "dilation angle must be"),
        (START + ANGLES + "*MOHR COULOMB HARDENING\n0., 0.\n", "cohesion must be positive"),
        (START + "*MOHR COULOMB, ECCENTRICITY=-1.\n30., 10.\n" + HARDENING, "ECCENTRICITY must not be negative"),
        (START + "*MOHR COULOMB, DEVIATORIC ECCENTRICITY=0.5\n30., 10.\n" + HARDENING, "above 0.5"),
        (START + ANGLES + HARDENING + "*TENSION CUTOFF\n1., 0.\n", "TENSION CUTOFF"),
        (START + ANGLES + HARDENING + "*DRUCKER PRAGER\n30., 1., 10.\n*DRUCKER PRAGER HARDENING\n10., 0.\n", "one law of yield"),
        (START + ANGLES + "*DRUCKER PRAGER HARDENING\n10., 0.\n", "that of the same law"),
        (START + ANGLES + HARDENING + "*PLASTIC\n10., 0.\n", "one law of yield"),
        (START + ANGLES + HARDENING + "*CREEP\n1e-9, 2., 0.\n", "*CREEP"),
        ("*MATERIAL, NAME=SOIL\n*ELASTIC, TYPE=ORTHO\n9., 1., 8., 1., 1., 7., 3., 2.,\n 1.\n" + ANGLES + HARDENING, "not isotropic"),
    ],
)
def test_refused(run_deck: Run, cards: str, words: str) -> None:
    """What is not supported or makes no sense is an error that says why."""
    done = check(run_deck, cards)
    assert done.returncode != 0
    assert words in done.stdout + done.stderr
