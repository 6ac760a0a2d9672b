"""Materials whose constants depend on a field variable (DEPENDENCIES, *FIELD): a bar in tension against closed forms.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from verify.conftest import Run

Floats = NDArray[np.float64]
ROUNDING = 1e-8  #: of a converged increment: the states are uniform, or linear in each element
ELASTIC = "*ELASTIC, DEPENDENCIES=1\n1000., 0.3, , 0.\n3000., 0.3, , 1.\n"
N = 4  #: elements of the bar, of length 1 each


def bar(material: str, conditions: str, steps: str, kind: str = "C3D8") -> str:
    """A bar of N cubes along x; X0 and X4 are its ends, SOME its first two cubes' nodes."""
    nodes = [(1 + 4 * i + k, i, y, z) for i in range(N + 1) for k, (y, z) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)))]
    lines = "".join(f"{n}, {x}., {y}., {z}.\n" for n, x, y, z in nodes)
    cubes = "".join(f"{e + 1}, " + ", ".join(str(4 * e + k) for k in (1, 5, 6, 2, 4, 8, 7, 3)) + "\n" for e in range(N))
    sets = "*NSET, NSET=ALL, GENERATE\n1, 20\n*NSET, NSET=X0\n1, 2, 3, 4\n*NSET, NSET=X4\n17, 18, 19, 20\n"
    sets += "*NSET, NSET=Y0\n" + "".join(f"{n}\n" for n, _, y, _ in nodes if y == 0)
    sets += "*NSET, NSET=Z0\n" + "".join(f"{n}\n" for n, _, _, z in nodes if z == 0)
    section = "*MATERIAL, NAME=M\n" + material + "*SOLID SECTION, ELSET=E, MATERIAL=M\n"
    held = "*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"
    return f"*NODE\n{lines}*ELEMENT, TYPE={kind}, ELSET=E\n{cubes}{sets}{section}{conditions}{held}{steps}"


def step(cards: str, n: int = 1, option: str = "") -> str:
    """A step of n increments."""
    return f"*STEP{option}\n*STATIC\n{1 / n}, 1., 1e-6, {1 / n}\n{cards}*END STEP\n"


def pull(force: float) -> str:
    """A force on the end, spread over its corners."""
    return f"*CLOAD\nX4, 1, {force / 4}\n"


def solve(run: Run, folder: Path, deck: str) -> tuple[Floats, Floats]:
    """Displacement of the end along x and the stress along x of all points, in each frame."""
    (folder / "job.inp").write_text(deck)
    done = run(["--outdir", folder, folder / "job.inp"], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        u = np.asarray(file["VTKHDF/PointData/U"]).reshape(-1, n, 3)
        s = np.asarray(file["VTKHDF/PointData/S"]).reshape(-1, n, 6)
    return u[:, -1, 0], s[..., 0]


@pytest.mark.parametrize("option", ["", ", NLGEOM"])
def test_elastic_by_initial_field(run: Run, tmp_path: Path, option: str) -> None:
    """E between two rows: E(0.25) = 1500. Under NLGEOM the logarithmic strain of a held elongation gives the stress."""
    initial = "*INITIAL CONDITIONS, TYPE=FIELD, VARIABLE=1\nALL, 0.25\n"
    u, s = solve(run, tmp_path, bar(ELASTIC, initial, step("*BOUNDARY\nX4, 1, 1, 0.4\n", option=option)))
    strain = np.log(1.1) if option else 0.1
    area = np.exp(-2 * 0.3 * strain) if option else 1.0
    kirchhoff = 1500 * strain  # Cauchy's stress is this over J = exp((1 - 2 nu) e)
    expected = kirchhoff / (1.1 * area) if option else kirchhoff
    assert s[-1] == pytest.approx(expected, rel=ROUNDING)
    assert u[-1] == pytest.approx(0.4, rel=ROUNDING)


def test_field_over_the_steps(run: Run, tmp_path: Path) -> None:
    """The field goes linearly to its value, by an amplitude, and back to the initial one by OP=NEW; u = F L / E(f) at each time."""
    initial = "*INITIAL CONDITIONS, TYPE=FIELD\nALL, 0.5\n*AMPLITUDE, NAME=A\n0., 0.5, 0.5, 0., 1., 1.\n"
    steps = step(pull(10.0) + "*FIELD\nALL, 1.\n", 2) + step("*FIELD, AMPLITUDE=A\nALL, 1.\n", 2) + step("*FIELD, OP=NEW\n", 1)
    u, _ = solve(run, tmp_path, bar(ELASTIC, initial, steps))
    field = np.array([0.75, 1.0, 0.0, 1.0, 0.5])
    force = np.array([5.0, 10.0, 10.0, 10.0, 10.0])
    assert u[-5:] == pytest.approx(force * N / (1000 + 2000 * field), rel=ROUNDING)


@pytest.mark.parametrize("kind", ["C3D8", "C3D8I"])
def test_field_along_the_bar(run: Run, tmp_path: Path, kind: str) -> None:
    """A field that changes along the bar: each linear element has the constants of its mean."""
    rows = "".join(f"{1 + 4 * i + k}, {i / N}\n" for i in range(N + 1) for k in range(4))
    table = ELASTIC.replace("1000., 0.3", "1000., 0.").replace("3000., 0.3", "3000., 0.")
    u, _ = solve(run, tmp_path, bar(table, f"*INITIAL CONDITIONS, TYPE=FIELD\n{rows}", step(pull(12.0)), kind))
    means = (np.arange(N) + 0.5) / N
    assert u[-1] == pytest.approx(sum(12.0 / (1000 + 2000 * means)), rel=ROUNDING)


def test_yield_stress(run: Run, tmp_path: Path) -> None:
    """The yield stress falls with the second field variable while the bar is held: S = 20 - 10 f + H p, p by the fixed strain."""
    table = "*ELASTIC\n1000., 0.3\n*PLASTIC, DEPENDENCIES=2\n20., 0., , 7., 0.\n30., 0.1, , 7., 0.\n10., 0., , 7., 1.\n20., 0.1, , 7., 1.\n"
    steps = step("*BOUNDARY\nX4, 1, 1, 0.16\n", 4) + step("*FIELD, VARIABLE=2\nALL, 1.\n", 4)
    _, s = solve(run, tmp_path, bar(table, "*INITIAL CONDITIONS, TYPE=FIELD, VARIABLE=2\nALL, 0.\n", steps))
    for frame, yielded in ((-5, 20.0), (-1, 10.0)):
        plastic = (1000 * 0.04 - yielded) / (1000 + 100)
        assert s[frame] == pytest.approx(yielded + 100 * plastic, rel=1e-6)


def test_expansion(run: Run, tmp_path: Path) -> None:
    """Secant coefficients over the field: e = a(f) T - a(f0) T0, as with a table over the temperature."""
    table = "*ELASTIC\n1000., 0.3\n*EXPANSION, DEPENDENCIES=1\n1e-4, , 0.\n3e-4, , 1.\n"
    initial = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*INITIAL CONDITIONS, TYPE=FIELD\nALL, 0.25\n"
    u, s = solve(run, tmp_path, bar(table, initial, step("*TEMPERATURE\nALL, 120.\n*FIELD\nALL, 0.75\n")))
    assert u[-1] == pytest.approx(N * (2.5e-4 * 120 - 1.5e-4 * 20), rel=ROUNDING)
    assert np.abs(s[-1]).max() < 1e-6


@pytest.mark.parametrize(("material", "message"), [
    ("*ELASTIC, DEPENDENCIES=1\n1000., 0.3, 0., 0.\n2000., 0.3, 10., 1.\n", "one column of the table may change"),
    ("*ELASTIC, DEPENDENCIES=1\n1000., 0.3, , 1.\n2000., 0.3, , 0.\n", "must ascend"),
    (ELASTIC + "*PLASTIC\n10., 0., 0.\n5., 0., 100.\n", "over the temperature and over field variables"),
    ("*ELASTIC, DEPENDENCIES=0\n1000., 0.3\n", "DEPENDENCIES must be the number"),
    (ELASTIC + "*DENSITY, DEPENDENCIES=1\n1., , 0.\n2., , 1.\n", "density over a field variable"),
])  # fmt: skip
def test_wrong_tables(run: Run, tmp_path: Path, material: str, message: str) -> None:
    """What a table over field variables cannot be."""
    (tmp_path / "job.inp").write_text(bar(material, "", step(pull(1.0))))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 3
    assert message in done.stdout + done.stderr


def test_field_without_effect(run: Run, tmp_path: Path) -> None:
    """A field on which nothing depends is passed over with a note; an invalid number is an error."""
    (tmp_path / "job.inp").write_text(bar("*ELASTIC\n1000., 0.3\n", "*INITIAL CONDITIONS, TYPE=FIELD\nALL, 1.\n", step(pull(1.0))))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 0
    assert "No property of a material depends on field variable 1" in done.stdout + done.stderr
    (tmp_path / "job.inp").write_text(bar(ELASTIC, "", step(pull(1.0) + "*FIELD, VARIABLE=0\nALL, 1.\n")))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 3
    assert "VARIABLE must be the number" in done.stdout + done.stderr
