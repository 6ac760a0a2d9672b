"""Drucker and Prager's cone against closed forms: tension, compression, shear, the apex; Prandtl's strip footing; refusals, resumption.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

import amontons
from verify.conftest import Run
from verify.library.common import same_results

Floats = NDArray[np.float64]
YOUNG, NU, FIRST, SLOPE = 1000.0, 0.3, 10.0, 100.0
SHEAR, BULK = YOUNG / (2 * (1 + NU)), YOUNG / (3 * (1 - 2 * NU))
BETA, PSI = 30.0, 12.0
TB, TP = np.tan(np.radians(BETA)), np.tan(np.radians(PSI))
#: Type of the hardening data: d over the stress of the curve, equivalent plastic strain over the multiplier of the flow.
TYPES = {"COMPRESSION": (1 - TB / 3, 1 - TP / 3), "TENSION": (1 + TB / 3, 1 + TP / 3), "SHEAR": (np.sqrt(3), np.sqrt(3))}
ROUNDING = 1e-8  #: of a converged increment with a uniform state
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])


def soil(kind: str, beta: float = BETA, psi: float = PSI, ratio: float = 1.0) -> str:
    """The material cards."""
    return (
        f"*MATERIAL, NAME=SOIL\n*ELASTIC\n{YOUNG}, {NU}\n*DRUCKER PRAGER\n{beta:.15g}, {ratio}, {psi:.15g}\n*DRUCKER PRAGER HARDENING, TYPE={kind}\n"
        f"{FIRST}, 0.\n{FIRST + SLOPE}, 1.\n"
    )


def cube(cards: str, boundary: str, option: str = "", n: int = 10) -> str:
    """A cube in a step of n increments; X1, Y1, Z1 are its faces at 1, X0, Y0, Z0 those at 0."""
    nodes = "".join(f"{i + 1}, " + ", ".join(f"{float(x)}" for x in corner) + "\n" for i, corner in enumerate(CORNERS))
    sets = "".join(
        f"*NSET, NSET={'XYZ'[axis]}{side}\n" + ", ".join(str(i + 1) for i in np.flatnonzero(CORNERS[:, axis] == side)) + "\n"
        for axis in range(3) for side in (0, 1)
    )  # fmt: skip
    return (
        f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=CUBE\n1, 1, 2, 3, 4, 5, 6, 7, 8\n{sets}{cards}*SOLID SECTION, ELSET=CUBE, MATERIAL=SOIL\n"
        f"*STEP{option}\n*STATIC\n{1 / n}, 1., 1e-6, {1 / n}\n*BOUNDARY\n{boundary}*END STEP\n"
    )


def stresses(folder: Path) -> tuple[Floats, Floats]:
    """Displacements of the nodes and stress of the first point (xx yy zz xy yz xz), at the end."""
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        u = np.asarray(file["VTKHDF/PointData/U"]).reshape(-1, n, 3)[-1]
        s = np.asarray(file["VTKHDF/PointData/S"]).reshape(-1, n, 6)[-1]
    assert np.ptp(s, axis=0).max() <= ROUNDING * np.abs(s).max(), "the state is uniform"
    return u, s[0]


def finish(run_deck: Run, deck: str, *options: str) -> str:
    """Runs a deck to its end; what was printed."""
    done = run_deck(deck, *options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def count(text: str, what: str) -> int:
    """A number of the summary."""
    found = re.search(rf"{what}\s+(\d+)", text)
    assert found
    return int(found[1])


SYMMETRY = "X0, 1\nY0, 2\nZ0, 3\n"


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("option", ["", ", NLGEOM"])
def test_uniaxial(run_deck: Run, tmp_path: Path, kind: str, sign: int, option: str) -> None:
    """Uniaxial compression and tension: stress and lateral displacement, for data of each test.

    s (1 + sign tan(beta)/3) = d, axial plastic strain m (1 + sign tan(psi)/3), lateral m (tan(psi)/3 - sign/2). Under NLGEOM the
    same holds between the logarithmic strains and the Kirchhoff stress.
    """
    factor, growth = TYPES[kind]
    strain = 0.05
    stretch = np.exp(sign * strain) - 1 if option else sign * strain
    finish(run_deck, cube(soil(kind), SYMMETRY + f"Z1, 3, 3, {stretch:.17g}\n", option))
    first, slope = factor * np.array([FIRST, SLOPE * growth]) / (1 + sign * TB / 3)
    m = (strain - first / YOUNG) / (1 + sign * TP / 3 + slope / YOUNG)
    s = sign * (first + slope * m)
    lateral = -NU * s / YOUNG + m * (TP / 3 - sign / 2)
    volume = 2 * lateral + sign * strain
    u, found = stresses(tmp_path)
    assert found[2] == pytest.approx(s / (np.exp(volume) if option else 1.0), rel=ROUNDING)
    assert np.abs(found[[0, 1, 3, 4, 5]]).max() <= 1e-6 * abs(s)
    assert u[6, 0] == pytest.approx(np.expm1(lateral) if option else lateral, rel=1e-7)


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("option", ["", ", NLGEOM"])
def test_uniaxial_with_ratio(run_deck: Run, tmp_path: Path, kind: str, sign: int, option: str) -> None:
    """K = 0.8: t is the stress in compression and the stress over K in tension.

    s (1/K + tan(beta)/3) = d in tension, axial plastic strain m (1/K + tan(psi)/3), lateral m (tan(psi)/3 - 1/(2 K)); d is
    (1/K + tan(beta)/3) and sqrt(3)/2 (1 + 1/K) times the stress of tension and shear, and the plastic strain likewise.
    """
    ratio, strain = 0.8, 0.05
    size = 1 / ratio if sign > 0 else 1.0
    scale = {"COMPRESSION": (1 - TB / 3, 1 - TP / 3), "TENSION": (1 / ratio + TB / 3, 1 / ratio + TP / 3)}
    factor, growth = scale.get(kind, (np.sqrt(3) / 2 * (1 + 1 / ratio), np.sqrt(3) / 2 * (1 + 1 / ratio)))
    stretch = np.exp(sign * strain) - 1 if option else sign * strain
    finish(run_deck, cube(soil(kind, ratio=ratio), SYMMETRY + f"Z1, 3, 3, {stretch:.17g}\n", option))
    first, slope = factor * np.array([FIRST, SLOPE * growth]) / (size + sign * TB / 3)
    m = (strain - first / YOUNG) / (size + sign * TP / 3 + slope / YOUNG)
    s = sign * (first + slope * m)
    lateral = -NU * s / YOUNG + m * (TP / 3 - sign * size / 2)
    volume = 2 * lateral + sign * strain
    u, found = stresses(tmp_path)
    assert found[2] == pytest.approx(s / (np.exp(volume) if option else 1.0), rel=ROUNDING)
    assert np.abs(found[[0, 1, 3, 4, 5]]).max() <= 1e-6 * abs(s)
    assert u[6, 0] == pytest.approx(np.expm1(lateral) if option else lateral, rel=1e-7)


def test_calculix_dialect_has_the_same_law(run_deck: Run, tmp_path: Path) -> None:
    """The card is Abaqus's: under the other dialect the law at finite strain is the same."""
    finish(run_deck, cube(soil("TENSION"), SYMMETRY + "Z1, 3, 3, -0.1\n", ", NLGEOM"))
    u, s = stresses(tmp_path)
    finish(run_deck, cube(soil("TENSION"), SYMMETRY + "Z1, 3, 3, -0.1\n", ", NLGEOM"), "--dialect=calculix")
    other_u, other_s = stresses(tmp_path)
    assert other_u == pytest.approx(u, rel=1e-5)
    assert other_s == pytest.approx(s, rel=1e-5, abs=1e-4)


def test_biaxial_compression(run_deck: Run, tmp_path: Path) -> None:
    """Two equal compressions s: q = s, p = 2 s/3; plastic strain m (tan(psi)/3 - 1/2) along them and m (tan(psi)/3 + 1) across."""
    factor, growth = TYPES["COMPRESSION"]
    finish(run_deck, cube(soil("COMPRESSION"), SYMMETRY + "X1, 1, 1, -0.05\nY1, 2, 2, -0.05\n"))
    first, slope = factor * np.array([FIRST, SLOPE * growth]) / (1 - 2 * TB / 3)
    m = (0.05 - first * (1 - NU) / YOUNG) / (0.5 - TP / 3 + slope * (1 - NU) / YOUNG)
    s = first + slope * m
    u, found = stresses(tmp_path)
    assert found[:2] == pytest.approx([-s, -s], rel=ROUNDING)
    assert u[6, 2] == pytest.approx(2 * NU * s / YOUNG + m * (TP / 3 + 1), rel=1e-7)


@pytest.mark.parametrize("psi", [0.0, PSI])
def test_pure_shear(run_deck: Run, tmp_path: Path, psi: float) -> None:
    """Simple shear: without dilatancy the stress is pure shear, the cohesion at the plastic shear strain. Dilatancy that is hindered
    builds up pressure: tr(plastic strain) = m tan(psi) = p/K, sqrt(3) tau = d + p tan(beta), gamma = tau/G + sqrt(3) m."""
    gamma = 0.06
    shear = "".join(f"{i + 1}, 1, 1, {gamma * z}\n" for i, (_, _, z) in enumerate(CORNERS)) + "ALL, 2, 3\n"
    finish(run_deck, cube(soil("SHEAR", psi=psi), shear))
    tp = np.tan(np.radians(psi))
    # sqrt(3) tau = sqrt(3) (FIRST + SLOPE sqrt(3) m) + K tan(psi) tan(beta) m
    slope = np.sqrt(3) * SLOPE + BULK * tp * TB / np.sqrt(3)
    m = (gamma - FIRST / SHEAR) / (np.sqrt(3) + slope / SHEAR)
    _, found = stresses(tmp_path)
    assert found[5] == pytest.approx(FIRST + slope * m, rel=ROUNDING)
    assert found[:3] == pytest.approx(-BULK * tp * m, rel=ROUNDING, abs=1e-9)


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("psi", [0.0, PSI, BETA])
def test_apex(run_deck: Run, tmp_path: Path, kind: str, psi: float) -> None:
    """Tension in all directions: the mean stress is d/tan(beta), the equivalent plastic strain d/(y tan(beta)) of that of the volume."""
    factor, _ = TYPES[kind]
    volume = 0.15
    spread = "".join(f"{'XYZ'[axis]}1, {axis + 1}, {axis + 1}, {volume / 3}\n" for axis in range(3))
    finish(run_deck, cube(soil(kind, psi=psi), SYMMETRY + spread))
    ratio = factor / TB
    plastic = (volume - ratio * FIRST / BULK) / (1 + ratio * SLOPE * ratio / BULK)
    _, found = stresses(tmp_path)
    assert found[:3] == pytest.approx(ratio * (FIRST + SLOPE * ratio * plastic), rel=ROUNDING)
    assert np.abs(found[3:]).max() <= 1e-9


# ------------------------------------------------------------------------------------------------------ strip footing

PHI = np.radians(20.0)
MATCH = np.sqrt(1 + np.sin(PHI) ** 2 / 3)  #: of the cone to Mohr and Coulomb's criterion in plane strain, associated flow
LIMIT = (np.exp(np.pi * np.tan(PHI)) * np.tan(np.pi / 4 + PHI / 2) ** 2 - 1) / np.tan(PHI)  #: Prandtl's, over the cohesion


def lines(start: float, end: float, n: int, growth: float) -> Floats:
    """Corners of n cells, each growth times as long as the one before."""
    return start + (end - start) * np.concatenate([[0.0], np.cumsum(growth ** np.arange(n))]) / np.sum(growth ** np.arange(n))


def footing(n: int, psi: float = 1.0, settlement: float = 0.1, increments: int = 20) -> str:
    """Half of a smooth rigid footing, 2 wide, on soil without weight and of cohesion 1, 12 wide and 4 deep: CPE8R, n to its half width.

    psi is the share of the friction angle that the dilation angle is.
    """
    x = np.concatenate([lines(0, 1, n, 0.85 ** (6 / n)), lines(1, 6, 2 * n, 1.1 ** (6 / n))[1:]])
    y = -lines(0, 4, 5 * n // 3, 1.15 ** (6 / n))
    fine_x, fine_y = np.sort(np.r_[x, (x[1:] + x[:-1]) / 2]), np.sort(np.r_[y, (y[1:] + y[:-1]) / 2])[::-1]
    places = [(i, j) for j in range(len(fine_y)) for i in range(len(fine_x)) if not (i % 2 and j % 2)]
    number = {place: k + 1 for k, place in enumerate(places)}
    nodes = "".join(f"{number[i, j]}, {fine_x[i]:.12g}, {fine_y[j]:.12g}\n" for i, j in places)
    corners = [(0, 2), (2, 2), (2, 0), (0, 0), (1, 2), (2, 1), (1, 0), (0, 1)]
    elements = "".join(
        f"{k + 1}, " + ", ".join(str(number[2 * i + a, 2 * j + b]) for a, b in corners) + "\n"
        for k, (i, j) in enumerate((i, j) for j in range(len(y) - 1) for i in range(len(x) - 1))
    )

    def node_set(name: str, chosen: list[int]) -> str:
        return f"*NSET, NSET={name}\n" + "".join(f"{k}\n" for k in chosen)

    sides = node_set("SIDES", [number[i, j] for i, j in places if i in (0, len(fine_x) - 1)])
    bottom = node_set("BOTTOM", [number[i, j] for i, j in places if j == len(fine_y) - 1])
    foot = node_set("FOOT", [number[i, j] for i, j in places if j == 0 and fine_x[i] < 1 + 1e-9])
    beta = np.degrees(np.arctan(np.sqrt(3) * np.sin(PHI) / MATCH))
    return (
        f"*NODE\n{nodes}*ELEMENT, TYPE=CPE8R, ELSET=SOIL\n{elements}{sides}{bottom}{foot}*MATERIAL, NAME=SOIL\n*ELASTIC\n1000., 0.3\n*DRUCKER PRAGER\n"
        f"{beta:.15g}, , {psi * beta:.15g}\n*DRUCKER PRAGER HARDENING, TYPE=SHEAR\n{np.cos(PHI) / MATCH:.15g}, 0.\n*SOLID SECTION, ELSET=SOIL, MATERIAL=SOIL\n"
        f"1.\n*BOUNDARY\nSIDES, 1\nBOTTOM, 1, 2\n*STEP, INC=1000\n*STATIC\n{1 / increments}, 1., 1e-6, {1 / increments}\n*BOUNDARY\nFOOT, 2, 2, {-settlement}\n"
        "*END STEP\n"
    )


def pressures(path: Path) -> Floats:
    """Mean pressure below the footing in each frame, over the cohesion."""
    with h5py.File(path) as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        points = np.asarray(file["VTKHDF/Points"])[:n]
        force = np.asarray(file["VTKHDF/PointData/RF"]).reshape(-1, n, 3)
    foot = (points[:, 1] > -1e-9) & (points[:, 0] < 1 + 1e-9)
    return -force[:, foot, 1].sum(axis=1)


def test_strip_footing(run_deck: Run, tmp_path: Path) -> None:
    """The limit load of a strip footing on soil without weight: (exp(pi tan phi) tan^2(45 + phi/2) - 1) c/tan(phi).

    L. Prandtl, Z. angew. Math. Mech. 1 (1921) 15-20; the cone is matched to Mohr and Coulomb's criterion in plane strain
    (D. C. Drucker, W. Prager, Quart. Appl. Math. 10 (1952) 157-165). Displacement elements are too stiff: the limit is reached
    from above, and the error is of the first order (the fan at the edge is singular).
    """
    excess = []
    for n in (6, 12):
        text = finish(run_deck, footing(n))
        p = pressures(tmp_path / "job.vtkhdf")
        assert p[-1] == pytest.approx(p[-3], rel=2e-3), "the limit is reached"
        assert count(text, "attempts that failed") == 0
        assert count(text, "Newton iterations") <= 100, "five an increment"
        excess.append(p[-1] / LIMIT - 1)
    assert 0 < excess[1] < 0.6 * excess[0]
    assert 2 * excess[1] - excess[0] == pytest.approx(0.0, abs=0.01), "extrapolated by the first order"


def test_flow_that_is_not_associated(run_deck: Run, tmp_path: Path) -> None:
    """Half the dilation: the tangent is unsymmetric, Newton's method stays quadratic. Less dilation cannot carry more load than
    associated flow (A. C. Palmer, Geotechnique 16 (1966) 96-98); here a settlement before the limit."""
    text = finish(run_deck, footing(6, psi=0.5, settlement=0.05, increments=10))
    assert count(text, "attempts that failed") == 0
    assert count(text, "Newton iterations") <= 60, "six an increment"
    loose = pressures(tmp_path / "job.vtkhdf")
    finish(run_deck, footing(6, psi=1.0, settlement=0.05, increments=10))
    dense = pressures(tmp_path / "job.vtkhdf")
    assert np.all(loose <= dense * (1 + 1e-6))
    assert loose[-1] > 0.85 * dense[-1]


def test_resumes_bitwise(tmp_path: Path) -> None:
    """A job that was left resumes to the same bits."""
    deck = tmp_path / "footing.inp"
    deck.write_text(footing(6, psi=0.5, settlement=0.03, increments=6))
    with amontons.Job(deck, name="whole", outdir=tmp_path, files=True) as job:
        job.run()
    job = amontons.Job(deck, name="dropped", outdir=tmp_path, checkpoint=True)
    for _ in range(4):
        job.advance()
    job.close()
    with amontons.Job(deck, name="dropped", outdir=tmp_path, resume=True, checkpoint=True) as job:
        job.run()
    assert same_results(tmp_path / "whole.vtkhdf", tmp_path / "dropped.vtkhdf") == []


# ----------------------------------------------------------------------------------------------------------- refusals


def check(run_deck: Run, cards: str) -> subprocess.CompletedProcess[str]:
    """Reads a deck with these material cards."""
    return run_deck(cube(cards, SYMMETRY), "--check")


ANGLES, HARDENING = "*DRUCKER PRAGER\n30., 1., 10.\n", "*DRUCKER PRAGER HARDENING\n10., 0.\n"
START = "*MATERIAL, NAME=SOIL\n*ELASTIC\n1000., .3\n"


@pytest.mark.parametrize(
    "cards, words",
    [
        (START + ANGLES, "needs both"),
        (START + HARDENING, "needs both"),
        (START + "*DRUCKER PRAGER\n80., 1., 10.\n" + HARDENING, "friction angle must be from 0 to 71.5"),
        (START + "*DRUCKER PRAGER\n30., 0.77, 10.\n" + HARDENING, "K, the ratio"),
        (START + "*DRUCKER PRAGER\n30., 1., 40.\n" + HARDENING, "dilation angle must be"),
        (START + "*DRUCKER PRAGER, SHEAR CRITERION=HYPERBOLIC\n30., 1., 10.\n" + HARDENING, "HYPERBOLIC"),
        (START + ANGLES + "*DRUCKER PRAGER HARDENING, TYPE=COHESION\n10., 0.\n", "COMPRESSION"),
        (START + ANGLES + "*DRUCKER PRAGER HARDENING, RATE=1.\n10., 0.\n", "RATE"),
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


def test_blank_ratio_is_one(run_deck: Run) -> None:
    """K blank or 0 means 1, as in Abaqus."""
    for ratio in ("", "0."):
        done = check(run_deck, START + f"*DRUCKER PRAGER\n30., {ratio}, 10.\n" + HARDENING)
        assert done.returncode == 0, done.stdout + done.stderr
