"""The modified Drucker-Prager model with a cap: a cube in isotropic compression, an oedometer, and triaxial compression at constant
lateral stress, against closed forms and an integration of the equations of the Abaqus Theory Manual, section 4.4.4.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.make_decks import block
from verify.decks.sheets import between
from verify.decks.solids import as_kind, node_set
from verify.readers.dat_frd_files import read_dat

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
YOUNG, POISSON = 3000.0, 0.25
G, K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
COHESION, ANGLE, R, START, ALPHA = 3.0, 35.0, 0.4, 0.002, 0.05
SLOPE, M = np.tan(np.radians(ANGLE)), 1 + ALPHA - ALPHA / np.cos(np.radians(ANGLE))
STRESSES, STRAINS = np.array([20.0, 30.0, 70.0]), np.array([0.0, 0.005, 0.02])


def cap_stress(v: float) -> float:
    """p_b over the volumetric plastic strain."""
    return float(np.interp(START + v, STRAINS, STRESSES))


def deck(steps: str, n: int = 1) -> str:
    """A unit cube in one octant, held at three faces."""
    body = as_kind(block(between(0, 1, n), between(0, 1, n), between(0, 1, n), "BODY"), "C3D8")
    sets = "".join(node_set(s, body.where(k, c)) for s, k, c in [("X0", 0, 0.0), ("Y0", 1, 0.0), ("Z0", 2, 0.0), ("X1", 0, 1.0), ("Y1", 1, 1.0), ("Z1", 2, 1.0)])
    law = f"*MATERIAL, NAME=CLAY\n*ELASTIC\n{YOUNG}, {POISSON}\n*CAP PLASTICITY\n{COHESION}, {ANGLE}, {R}, {START}, {ALPHA}, 1.\n*CAP HARDENING\n"
    law += "".join(f"{s}, {e}\n" for s, e in zip(STRESSES, STRAINS, strict=True))
    return body.cards() + sets + law + "*SOLID SECTION, ELSET=ALL, MATERIAL=CLAY\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n" + steps


def results(run_deck: RunDeck, folder: Path, text: str) -> tuple[np.ndarray, list[float]]:
    """The stresses at the end of each increment, and the last PEEQ."""
    done = run_deck(text)
    assert done.returncode == 0, done.stdout + done.stderr
    tables = read_dat(folder / "job.dat")
    stresses = [np.array(next(iter(t.rows.values()))) for t in tables if len(next(iter(t.rows.values()))) == 6]
    peeq = [next(iter(t.rows.values()))[0] for t in tables if len(next(iter(t.rows.values()))) == 1]
    return np.array(stresses), peeq


def step(moves: str, n: int = 40) -> str:
    """A step of n increments."""
    return f"*STEP\n*STATIC, DIRECT\n{1 / n}, 1.\n{moves}*EL PRINT, ELSET=ALL\nS, PEEQ\n*END STEP\n"


def test_isotropic_compression(run_deck: RunDeck, tmp_path: Path) -> None:
    """p = K (e_v - v) = p_b(v): exactly, at each increment."""
    stresses, peeq = results(run_deck, tmp_path, deck(step("*BOUNDARY\nX1, 1, 1, -0.008\nY1, 2, 2, -0.008\nZ1, 3, 3, -0.008\n", 10)))
    for i, (s, v) in enumerate(zip(stresses, peeq, strict=True)):
        p = -s[:3].mean()
        assert p == pytest.approx(K * (0.024 * (i + 1) / 10 - v), rel=1e-5)
        assert p <= cap_stress(v) * (1 + 1e-5)
    assert -stresses[-1][:3].mean() == pytest.approx(cap_stress(peeq[-1]), rel=1e-5)


def surface(state: np.ndarray) -> float:
    """The excess over the yield surface of p, q and the volumetric plastic strain."""
    p, q, v = state
    p_a = (cap_stress(v) - R * COHESION) / (1 + R * SLOPE)
    d = COHESION + p_a * SLOPE
    if p > p_a:
        return float(np.hypot(p - p_a, R * q / M) - R * d)
    if p < p_a - ALPHA * d * np.sin(np.radians(ANGLE)):
        return float(q - p * SLOPE - COHESION)
    return float(q - (1 - ALPHA / np.cos(np.radians(ANGLE))) * d - np.sqrt((ALPHA * d) ** 2 - (p - p_a) ** 2))


def oedometer(strain: float, n: int) -> np.ndarray:
    """p, q and v after an axial compression at no lateral strain, by n explicit steps of the rate equations."""
    state, h = np.zeros(3), 1e-6
    elastic = np.array([K * strain, 2 * G * strain, 0.0]) / n
    for _ in range(n):
        if surface(state + elastic) <= 0:
            state = state + elastic
            continue
        slope = np.array([(surface(state + h * e) - surface(state - h * e)) / (2 * h) for e in np.diag([1.0, 1.0, 1e-3])]) / [1, 1, 1e-3]
        p, q, v = state
        p_a = (cap_stress(v) - R * COHESION) / (1 + R * SLOPE)
        flow = np.array([p - p_a, (R / M) ** 2 * q]) if p > p_a else np.array([SLOPE**2 * (p - p_a), q / M**2])
        change = np.array([-K * flow[0], -3 * G * flow[1], flow[0]])
        state = state + elastic - (slope @ elastic) / (slope @ change) * change
    return state


def test_oedometer(run_deck: RunDeck, tmp_path: Path) -> None:
    """Compression without lateral strain: the error of 80 increments is half of that of 40, and small, against 20000 explicit steps."""
    exact = oedometer(0.02, 20000)
    assert surface(exact) == pytest.approx(0, abs=0.02), "the explicit steps stay near the surface"
    errors = []
    for n in (40, 80):
        moves = "*BOUNDARY\nX1, 1, 1, 0.\nY1, 2, 2, 0.\nZ1, 3, 3, -0.02\n"
        stresses, peeq = results(run_deck, tmp_path, deck(step(moves, n)))
        s = -stresses[-1][:3]
        errors.append(np.array([s.mean(), s[2] - s[0], 1000 * peeq[-1]]) - exact * [1, 1, 1000])
    assert np.abs(errors[1]).max() < 0.01 * exact[0]
    assert np.abs(errors[1]).max() < 0.65 * np.abs(errors[0]).max() + 2e-3 * exact[0]


@pytest.mark.parametrize("pressure", [12.0, 20.0])
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_critical_state(run_deck: RunDeck, tmp_path: Path, pressure: float, nlgeom: str) -> None:
    """Triaxial compression at constant lateral stress ends where the volume no longer changes, p = p_a and q = m (d + p tan(beta)) =
    3 (p - p_0): a soil that is dense softens towards it, a loose one hardens."""
    p = (3 * pressure + M * COHESION) / (3 - M * SLOPE)
    loads = f"*STEP{nlgeom}\n*STATIC\n1., 1.\n*DSLOAD\nSX, P, {pressure}\nSY, P, {pressure}\nSZ, P, {pressure}\n*END STEP\n"
    faces = "*SURFACE, NAME=SX\nALL, S4\n*SURFACE, NAME=SY\nALL, S5\n*SURFACE, NAME=SZ\nALL, S2\n"
    moves = "*BOUNDARY\nZ1, 3, 3, -0.25\n"
    text = deck(faces + loads + step(moves, 50).replace("*STEP", f"*STEP, INC=500{nlgeom}"))
    stresses, _ = results(run_deck, tmp_path, text)
    s = -stresses[-1][:3]
    assert s[0] == pytest.approx(pressure, rel=1e-3)
    assert s.mean() == pytest.approx(p, rel=5e-3)
    assert s[2] - s[0] == pytest.approx(3 * (p - pressure), rel=2e-2)
