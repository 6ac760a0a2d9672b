"""Metals whose yield stress depends on the rate of plastic strain: bars pulled at a constant rate and held, all elements, tables.

The bar in the numbers of one dimension: stress = E (strain - p), rate of p = D (stress/y(p) - 1)^n above the static yield stress y.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from verify.cases.proof import Case, observed_order
from verify.decks.make_decks import block
from verify.decks.sheets import between
from verify.decks.solids import UNIT_CUBE, as_kind, node_set
from verify.readers.dat_frd_files import read_dat

Proof = Callable[..., Case]
RunDeck = Callable[..., subprocess.CompletedProcess[str]]
YOUNG, POISSON, STATIC, D, N = 200000.0, 0.3, 250.0, 40.0, 5.0
STEEL = f"*ELASTIC\n{YOUNG}, {POISSON}\n*PLASTIC\n{STATIC}, 0.\n"
HARDENING = 2000.0
HARD = f"*ELASTIC\n{YOUNG}, {POISSON}\n*PLASTIC\n{STATIC}, 0.\n{STATIC + HARDENING}, 1.\n"
POWER = f"*RATE DEPENDENT\n{D}, {N}\n"
DIGITS = 5e-7  # of the .dat file: seven
FINE = "*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-6\n"


def bar(law: str, kind: str = "C3D8") -> str:
    """A unit cube that is free across and pulled along z."""
    body = as_kind(block(between(0, 1, 1), between(0, 1, 1), between(0, 1, 1), "BODY"), kind)
    sets = "".join(node_set(s, body.where(k, c)) for s, k, c in [("X0", 0, 0.0), ("Y0", 1, 0.0), ("Z0", 2, 0.0), ("END", 2, 1.0)])
    return body.cards() + sets + f"*MATERIAL, NAME=M\n{law}*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"


def pull(strain: float, time: float, n: int, axis: int = 3, nlgeom: str = "") -> str:
    """A step in n increments to a strain."""
    cards = f"*STEP, INC=1000{nlgeom}\n*STATIC, DIRECT\n{time / n:.15g}, {time:.15g}\n{FINE}*BOUNDARY\nEND, {axis}, {axis}, {strain:.15g}\n"
    return cards + "*NODE PRINT, NSET=END, TOTALS=ONLY\nRF\n*END STEP\n"


def forces(run_deck: RunDeck, tmp_path: Path, deck: str, axis: int = 3) -> list[float]:
    """The force at the end of each increment."""
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout + done.stderr
    return [next(iter(t.rows.values()))[axis - 1] for t in read_dat(tmp_path / "job.dat")]


def implicit_bar(strains: list[float], dt: float | list[float], ratio: Callable[[float], float]) -> list[float]:
    """Stresses after increments by backward Euler, each by Brent's method: E (strain - p) = y(p) R(dp/dt), with linear hardening."""
    p, stresses = 0.0, []
    for strain, length in zip(strains, dt if isinstance(dt, list) else [dt] * len(strains), strict=True):

        def excess(dp: float, *, strain: float = strain, p: float = p, length: float = length) -> float:
            return YOUNG * (strain - p - dp) - (STATIC + HARDENING * (p + dp)) * ratio(dp / length)

        if excess(0.0) > 0:
            p += brentq(excess, 0, strain - p, xtol=1e-18, rtol=1e-15, maxiter=1000)
        stresses.append(YOUNG * (strain - p))
    return stresses


def power(rate: float) -> float:
    """The ratio of the power law."""
    return 1 + (rate / D) ** (1 / N)


def test_bar(proof: Proof) -> None:
    """Pulled at a constant rate until the stress is steady, and held after a jerk."""
    case = proof(
        "rate-dependent-bar",
        title="A bar that yields at a rate (power law), pulled and held",
        model="One C3D8, E = 200000, nu = 0.3, static yield stress 250, D = 40, n = 5. Pulled to a strain of 0.02 at the rate 0.1, then of 10, in 40 "
        "increments; stretched to the strain 0.0025 in a time of 1e-12, held for a time of 1e-4 in 20, 40 and 80 increments.",
        formula="Steady: sigma = sigma_0 (1 + (rate/D)^(1/n)). Held: x = sigma/sigma_0 - 1 = (x_0^(1-n) + (n - 1) E D t/sigma_0)^(1/(1-n)).",
        source="P. S. Symonds (1967) for the law; closed forms",
        proves="The rate is that of the increment in natural time, in *STATIC steps; exact at a constant rate, first order in time otherwise.",
    )
    cube = bar(STEEL + POWER)
    for rate in (0.1, 10.0):
        job = case.run(cube + pull(0.02, 0.02 / rate, 40), f"rate {rate:g}", requested=40)
        case.near(f"steady stress at the rate {rate:g}", job.last("S")[0, 2], STATIC * power(rate), 1e-9, why="steady: backward Euler is exact",
                  place="all of the bar", time="the end")  # fmt: skip
    errors = []
    x = YOUNG * 0.0025 / STATIC - 1
    wanted = STATIC * (1 + (x ** (1 - N) + (N - 1) * YOUNG * D * 1e-4 / STATIC) ** (1 / (1 - N)))
    for n in (20, 40, 80):
        job = case.run(cube + pull(0.0025, 1e-12, 1) + pull(0.0025, 1e-4, n), f"held, {n} increments", requested=n + 1)
        errors.append(float(job.last("S")[0, 2] / wanted - 1))
    found = observed_order([abs(e) for e in errors[1:]])
    case.near("stress left", errors[2] + 1, 1.0, 0.03, why="first order, 80 increments", order=f"{found:.1f}", place="all of the bar", time="the end")
    case.within("observed order", found, (0.8, 1.2), why="backward Euler", place="all of the bar", time="the end")
    case.done()


def test_hardening_bar(run_deck: RunDeck, tmp_path: Path) -> None:
    """Pulled, held, pulled faster and unloaded with static hardening: the implicit equations in all increments, and what a held bar
    has left by an integrator of the differential equation, to first order."""
    times, strains, p = [0.0, 0.1, 0.3, 0.31, 0.4], [0.0, 0.01, 0.01, 0.03, 0.0285], 0.0
    for (t0, t1), (e0, e1) in zip(pairwise(times[:3]), pairwise(strains[:3]), strict=True):

        def rate(t: float, p: np.ndarray, *, t0: float = t0, t1: float = t1, e0: float = e0, e1: float = e1) -> np.ndarray:
            over = YOUNG * (e0 + (t - t0) / (t1 - t0) * (e1 - e0) - p) / (STATIC + HARDENING * p) - 1
            return D * np.maximum(over, 0) ** N

        p = solve_ivp(rate, (t0, t1), [p], method="Radau", rtol=1e-10, atol=1e-14).y[0, -1]
    errors = []
    for n in (50, 100):
        found = forces(run_deck, tmp_path, bar(HARD + POWER) + "".join(pull(strains[i + 1], times[i + 1] - times[i], n) for i in range(4)))
        path = [x for e0, e1 in pairwise(strains) for x in np.linspace(e0, e1, n + 1)[1:]]
        assert found == pytest.approx(implicit_bar(path, [(t1 - t0) / n for t0, t1 in pairwise(times) for _ in range(n)], power), rel=DIGITS, abs=1e-4)
        errors.append(found[2 * n - 1] - YOUNG * (strains[2] - p))
    assert abs(errors[1]) < 1e-3 * STATIC
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)


#: Kind of element to its cards (a bar of length 1 between nodes whose x is 0 and 1), section and area.
FLAT = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n5, 0.5, 0., 0.\n6, 1., 0.5, 0.\n7, 0.5, 1., 0.\n8, 0., 0.5, 0.\n"
SQUARE = "*NSET, NSET=LOW\n1, 2\n*NSET, NSET=START\n1, 4\n*NSET, NSET=END\n2, 3\n*BOUNDARY\nSTART, 1\nLOW, 2\n"
ROUND = "*NSET, NSET=LOW\n1, 2, 5\n*NSET, NSET=START\n1, 4, 8\n*NSET, NSET=END\n2, 3, 6\n*BOUNDARY\nSTART, 1\nLOW, 2\n"
LINE = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n*NSET, NSET=END\n2\n"
OTHERS = {
    "CPS4": (FLAT, "1, 1, 2, 3, 4", "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n0.5\n", SQUARE, 0.5),
    "CPS8R": (FLAT, "1, 1, 2, 3, 4, 5, 6, 7, 8", "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n0.5\n", ROUND, 0.5),
    "M3D4": (FLAT, "1, 1, 2, 3, 4", "*MEMBRANE SECTION, ELSET=ALL, MATERIAL=M\n0.1\n", SQUARE + "1, 3\n2, 3\n3, 3\n4, 3\n", 0.1),
    "S4": (FLAT, "1, 1, 2, 3, 4", "*SHELL SECTION, ELSET=ALL, MATERIAL=M\n0.1\n", SQUARE + "1, 3\n2, 3\n3, 3\n4, 3\n", 0.1),
    "S8R": (FLAT, "1, 1, 2, 3, 4, 5, 6, 7, 8", "*SHELL SECTION, ELSET=ALL, MATERIAL=M\n0.1\n", ROUND + "1, 3\n2, 3\n3, 3\n4, 3\n", 0.1),
    "T3D2": (LINE, "1, 1, 2", "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n0.25\n", "*BOUNDARY\n1, 1, 3\n2, 2, 3\n", 0.25),
    "B31": (LINE, "1, 1, 2", "*BEAM SECTION, ELSET=ALL, MATERIAL=M, SECTION=RECT\n0.5, 0.5\n0., 1., 0.\n", "*BOUNDARY\n1, 1, 6\n", 0.25),
}


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("kind", ["C3D4", "C3D8", "C3D8I", "C3D8R", "C3D10", "C3D20R", *OTHERS])
def test_elements(run_deck: RunDeck, tmp_path: Path, kind: str, nlgeom: str) -> None:
    """Bars of all kinds of elements in increments of equal times: the implicit equations of the bar, in the logarithmic strain under
    NLGEOM, where the force is the Kirchhoff stress over the stretch; the free strains across are found by each element."""
    n, time, strain, area, axis = 10, 0.01, 0.05, 1.0, 3
    if kind in OTHERS:
        nodes, element, section, held, area = OTHERS[kind]
        axis = 1
        deck = f"{nodes}*ELEMENT, TYPE={kind}, ELSET=ALL\n{element}\n*MATERIAL, NAME=M\n{HARD}{POWER}{section}{held}"
    else:
        deck = bar(HARD + POWER, kind)
    found = np.array(forces(run_deck, tmp_path, deck + pull(strain, time, n, axis, nlgeom), axis))
    strains = [strain * (i + 1) / n for i in range(n)]
    wanted = np.array(implicit_bar(strains, time / n, power))
    if nlgeom:
        stretches = 1 + np.array(strains)
        wanted = np.array(implicit_bar(list(np.log(stretches)), time / n, power)) / stretches
    assert found / area == pytest.approx(wanted, rel=DIGITS)


TABLE = [0.0, *np.geomspace(1e-4, 1e3, 281)]


def sampled(kind: str, hardening: float) -> str:
    """The power law as a table of ratios or as hardening curves of several rates."""
    if kind == "ratios":
        return f"*PLASTIC\n{STATIC}, 0.\n{STATIC + hardening}, 1.\n*RATE DEPENDENT, TYPE=YIELD RATIO\n" + "".join(f"{power(r):.15g}, {r:.15g}\n" for r in TABLE)
    return "".join(f"*PLASTIC, RATE={r:.15g}\n{STATIC * power(r):.15g}, 0.\n{(STATIC + hardening) * power(r):.15g}, 1.\n" for r in TABLE)


@pytest.mark.parametrize("rate", [1e-2, 0.3, 30.0])
def test_tables(run_deck: RunDeck, tmp_path: Path, rate: float) -> None:
    """The power law sampled forty times per decade: ratios and curves are the same law, and the sampled one within its error."""
    found = []
    for law in (HARD + POWER, *(f"*ELASTIC\n{YOUNG}, {POISSON}\n{sampled(kind, HARDENING)}" for kind in ("ratios", "curves"))):
        found.append(np.array(forces(run_deck, tmp_path, bar(law) + pull(0.02, 0.02 / rate, 10))))
    strains = [0.02 * (i + 1) / 10 for i in range(10)]
    assert found[0] == pytest.approx(implicit_bar(strains, 0.002 / rate, power), rel=DIGITS)
    assert found[1] == pytest.approx(implicit_bar(strains, 0.002 / rate, lambda r: float(np.interp(r, TABLE, [power(x) for x in TABLE]))), rel=DIGITS)
    assert found[2] == pytest.approx(found[1], rel=DIGITS)
    assert found[1] == pytest.approx(found[0], rel=2e-4), "chords of r^(1/5) over an interval of 6 per cent"


def test_outside_of_curves(run_deck: RunDeck, tmp_path: Path) -> None:
    """Below the lowest and above the highest rate the nearest curve holds; between, the stress is linear in the rate."""
    law = f"*ELASTIC\n{YOUNG}, {POISSON}\n*PLASTIC, RATE=10.\n300., 0.\n*PLASTIC, RATE=2.\n200., 0.\n"
    for rate, wanted in ((1.0, 200.0), (4.0, 225.0), (50.0, 300.0)):
        found = forces(run_deck, tmp_path, bar(law) + pull(0.05, 0.05 / rate, 10))
        assert found[-1] == pytest.approx(wanted, rel=DIGITS)


def test_temperature(run_deck: RunDeck, tmp_path: Path) -> None:
    """D, n and the static curve over the temperature, at 50 between 0 and 100: a bar at a constant rate."""
    law = f"*ELASTIC\n{YOUNG}, {POISSON}\n*PLASTIC\n300., 0., 0.\n200., 0., 100.\n*RATE DEPENDENT\n30., 4., 0.\n50., 6., 100.\n"
    steps = "*NSET, NSET=ALLN, GENERATE\n1, 8\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALLN, 50.\n" + pull(0.02, 0.02, 10)
    assert forces(run_deck, tmp_path, bar(law) + steps)[-1] == pytest.approx(250 * (1 + (1 / 40) ** (1 / 5)), rel=DIGITS)


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_turned(run_deck: RunDeck, tmp_path: Path, nlgeom: str) -> None:
    """A cube that is deformed in all components, and the same cube turned: the forces turn with it."""
    stretch = np.array([[0.03, 0.01, -0.02], [0.005, -0.01, 0.015], [0.0, 0.02, -0.012]])
    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [-1.0, 0.3, 1.0], [0.2, -0.7, 2.0]]))[0]
    corners = np.array([[float(x) for x in row.split(",")[1:]] for row in UNIT_CUBE.split("\n")[:8]])
    found = []
    for q in (np.eye(3), turn if np.linalg.det(turn) > 0 else -turn):
        x, u = corners @ q.T, corners @ stretch.T @ q.T
        nodes = "".join(f"{i + 1}, " + ", ".join(f"{c:.16g}" for c in row) + "\n" for i, row in enumerate(x))
        motion = "".join(f"{i + 1}, {k + 1}, {k + 1}, {u[i, k]:.16g}\n" for i in range(8) for k in range(3))
        deck = f"*NODE, NSET=N\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n{HARD}{POWER}"
        deck += f"*SOLID SECTION, ELSET=E, MATERIAL=M\n*STEP{nlgeom}\n*STATIC, DIRECT\n0.001, 0.003\n*BOUNDARY\n{motion}"
        done = run_deck(deck + "*NODE PRINT, NSET=N\nRF\n*END STEP\n")
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(np.array(list(read_dat(tmp_path / "job.dat")[-1].rows.values())) @ q)
    assert found[1] == pytest.approx(found[0], rel=DIGITS, abs=DIGITS * np.abs(found[0]).max())


def test_same_strain_in_less_time(run_deck: RunDeck, tmp_path: Path) -> None:
    """Times and rates in other units: milliseconds in place of seconds."""
    second = forces(run_deck, tmp_path, bar(HARD + POWER) + pull(0.02, 0.1, 10))
    milli = forces(run_deck, tmp_path, bar(HARD + f"*RATE DEPENDENT\n{D / 1000}, {N}\n") + pull(0.02, 100.0, 10))
    assert milli == pytest.approx(second, rel=DIGITS)


def test_beam_in_bending(run_deck: RunDeck, tmp_path: Path) -> None:
    """A beam bent by its end in CPS8R: the faster, the stiffer, between the static and the elastic force; iterations stay few."""
    body = "*NODE, NSET=ALLN\n" + "".join(f"{1 + i * 3 + j}, {i * 0.5}, {j * 0.5}\n" for i in range(21) for j in range(3))
    cells = [(i, [6 * i + k for k in (1, 7, 9, 3, 4, 8, 6, 2)]) for i in range(10)]
    body += "*ELEMENT, TYPE=CPS8R, ELSET=E\n" + "".join(f"{i + 1}, " + ", ".join(map(str, nodes)) + "\n" for i, nodes in cells)
    body += "*NSET, NSET=START\n1, 2, 3\n*NSET, NSET=END\n61, 62, 63\n"
    found = []
    for law, time in ((HARD, 1.0), (HARD + POWER, 100.0), (HARD + POWER, 1e-2), (f"*ELASTIC\n{YOUNG}, {POISSON}\n", 1.0)):
        deck = f"{body}*MATERIAL, NAME=M\n{law}*SOLID SECTION, ELSET=E, MATERIAL=M\n1.\n*BOUNDARY\nSTART, 1, 2\n"
        found.append(forces(run_deck, tmp_path, deck + pull(0.4, time, 4, 2), 2)[-1])
    assert found == sorted(found)
    assert found[2] > 1.2 * found[1] > 1.2 * found[0]
