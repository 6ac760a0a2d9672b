"""Submodels of shells and beams: cut strips and rings take displacements and rotations of a coarser global model; closed forms, and what is refused.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.shells import Floats, Shell, shell
from verify.readers.dat_frd_files import read_dat

E, THICK, WIDTH, LENGTH = 1000.0, 0.2, 1.0, 8.0
RIGIDITY = E * THICK**3 / 12  #: per width; Poisson's ratio is 0
LAW = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n"
SECTION = LAW + f"*SHELL SECTION, ELSET=E, MATERIAL=M\n{THICK}\n"
Place = Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]


def run_job(run: Run, folder: Path, name: str, deck: str, *options: str) -> str:
    """Runs a deck, which must end well."""
    (folder / f"{name}.inp").write_text(deck)
    done = run([*options, name], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return re.sub(r"\s+", " ", done.stdout)


def part(first: float, last: float) -> Place:
    """A piece of the strip along x."""
    return lambda u, v: (first + (last - first) * u, WIDTH * v, 0 * u)


def sets_of(body: Shell) -> str:
    """The ends of the parameter u."""
    return "".join(f"*NSET, NSET={name}\n" + "".join(f"{i + 1},\n" for i in body.where(0, at)) for name, at in (("LEFT", 0.0), ("RIGHT", 1.0)))


def end_loads(body: Shell, dof: int, total: float) -> str:
    """A force or moment on the right end."""
    return "*CLOAD\n" + "".join(f"{i + 1}, {dof}, {total * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())


def global_strip(kind: str, n: int, dof: int, total: float, step: str = "*STEP\n*STATIC\n") -> str:
    """A cantilever along x."""
    body = shell(kind, (n, 1), part(0.0, LENGTH))
    return f"{body.cards()}{sets_of(body)}{SECTION}*BOUNDARY\nLEFT, ENCASTRE\n{step}{end_loads(body, dof, total)}*END STEP\n"


def submodel_strip(kind: str, n: int, first: float, last: float, step: str = "*STEP\n*STATIC\n", dofs: str = "1, 6", ending: str = "vtkhdf") -> tuple[Shell, str]:
    """A piece of it, driven at both ends."""
    body = shell(kind, (n, 2), part(first, last))
    deck = f"{body.cards()}{sets_of(body)}{SECTION}*SUBMODEL, INPUT=global.{ending}\nLEFT, RIGHT\n{step}*BOUNDARY, SUBMODEL, STEP=1\nLEFT, {dofs}\nRIGHT, {dofs}\n"
    return body, deck + "*NODE PRINT, NSET=N\nU\n*NODE PRINT, NSET=LEFT, TOTALS=ONLY\nRF\n*EL PRINT, ELSET=E\nSF, SM\n*END STEP\n"


def last_table(folder: Path, words: str) -> dict:
    """Rows of the last table of a name."""
    table = next(t for t in reversed(read_dat(folder / "sub.dat")) if words in t.name[0])
    return {key[0]: row for key, row in table.rows.items()}


@pytest.mark.parametrize("ending", ["vtkhdf", "frd"])
@pytest.mark.parametrize("kind", ["S3", "S4", "S4R", "S6", "S8R"])
def test_pure_bending(run: Run, tmp_path: Path, kind: str, ending: str) -> None:
    """w = M x^2/(2 D) under an end moment: the submodel of any kind finds it, and its moment, from a global model of eight S8R, which is exact."""
    moment = 0.002
    run_job(run, tmp_path, "global", global_strip("S8R", 8, 5, -moment), "--frd")
    body, deck = submodel_strip(kind, 6, 2.3, 5.1, ending=ending)
    run_job(run, tmp_path, "sub", deck)
    exact = moment * body.nodes[:, 0] ** 2 / (2 * RIGIDITY * WIDTH)
    found = np.array([last_table(tmp_path, "displacements")[i + 1][2] for i in range(len(body.nodes))])
    assert np.abs(found - exact).max() < 0.002 * np.abs(exact).max()
    moments = np.array([row[0] for row in last_table(tmp_path, "section moments").values()])
    assert np.abs(np.abs(moments).mean() * WIDTH - moment) < 0.01 * moment


def test_force_at_the_cut(run: Run, tmp_path: Path) -> None:
    """A cantilever under an end force: the reaction at the cut of its submodel is this force; displacements alone (1, 3) would leave a hinge there."""
    force = 0.001
    run_job(run, tmp_path, "global", global_strip("S8R", 16, 3, force))
    body, deck = submodel_strip("S8R", 8, 2.3, 5.1)
    run_job(run, tmp_path, "sub", deck)
    reaction = next(iter(last_table(tmp_path, "total force").values()))
    assert reaction[2] == pytest.approx(-force, rel=0.005)
    x = body.nodes[:, 0]
    exact = force * (x**2 * (3 * LENGTH - x) / (6 * RIGIDITY) + x / (E / 2 * THICK)) / WIDTH
    found = np.array([last_table(tmp_path, "displacements")[i + 1][2] for i in range(len(body.nodes))])
    assert np.abs(found - exact).max() < 0.002 * np.abs(exact).max()
    _, hinged = submodel_strip("S8R", 8, 2.3, 5.1, dofs="1, 3")
    run_job(run, tmp_path, "sub", hinged)
    reaction = next(iter(last_table(tmp_path, "total force").values()))
    assert abs(reaction[2]) < 0.01 * force


def test_rolling_up(run: Run, tmp_path: Path) -> None:
    """NLGEOM: the moment rolls the strip up to a turn of 240 degrees; the submodel follows rotations beyond half a turn and lies on the circle."""
    turn = np.radians(240.0)
    moment = RIGIDITY * WIDTH * turn / LENGTH
    step = "*STEP, NLGEOM\n*STATIC\n0.05, 1., , 0.05\n"
    run_job(run, tmp_path, "global", global_strip("S8R", 16, 5, -moment, step))
    body, deck = submodel_strip("S8R", 6, 5.0, 7.5, step)
    run_job(run, tmp_path, "sub", deck)
    rows = last_table(tmp_path, "displacements")
    angle = turn * body.nodes[:, 0] / LENGTH
    radius = LENGTH / turn
    exact = np.column_stack((radius * np.sin(angle) - body.nodes[:, 0], 0 * angle, radius * (1 - np.cos(angle))))
    found = np.array([rows[i + 1] for i in range(len(body.nodes))])
    assert np.abs(found - exact).max() < 0.01 * LENGTH
    moments = np.array([row[0] for row in last_table(tmp_path, "section moments").values()])
    assert np.abs(moments).mean() * WIDTH == pytest.approx(moment, rel=0.02)


def ring(kind: str, n: int, first: float, last: float) -> Shell:
    """A part of a cylinder of radius 5 about y."""
    return shell(kind, (n, 1), lambda u, v: (5 * np.sin(first + (last - first) * u), WIDTH * v, 5 * np.cos(first + (last - first) * u)))


def test_curved(run: Run, tmp_path: Path) -> None:
    """A quarter of a thin ring under an end moment: constant moment, no membrane force; nodes of the fine submodel lie off the flat faces of the coarse S4."""
    moment = 0.002
    whole = ring("S4", 16, 0.0, np.pi / 2)
    loads = end_loads(whole, 5, moment)
    run_job(run, tmp_path, "global", f"{whole.cards()}{sets_of(whole)}{SECTION}*BOUNDARY\nLEFT, ENCASTRE\n*STEP\n*STATIC\n{loads}*END STEP\n")
    body = ring("S4", 24, 0.43, 1.05)
    deck = f"{body.cards()}{sets_of(body)}{SECTION}*SUBMODEL, INPUT=global.vtkhdf\nLEFT, RIGHT\n*STEP\n*STATIC\n*BOUNDARY, SUBMODEL, STEP=1\nLEFT, 1, 6\nRIGHT, 1, 6\n"
    run_job(run, tmp_path, "sub", deck + "*EL PRINT, ELSET=E\nSF, SM\n*END STEP\n")
    moments = np.array(list(last_table(tmp_path, "section moments").values()))
    forces = np.array(list(last_table(tmp_path, "section forces").values()))
    # moments and forces of the closed form: M/b and 0; a membrane strain of the size of that of bending would be a force of 6 M/h
    bending = np.abs(moments[:, :2]).max(axis=1)
    assert bending.mean() == pytest.approx(moment / WIDTH, rel=0.03)
    assert np.abs(forces[:, :3]).max() < 0.05 * 6 * moment / THICK


@pytest.mark.parametrize("kind", ["B31", "B32"])
def test_beam(run: Run, tmp_path: Path, kind: str) -> None:
    """A cantilever of a rectangle under an end force and a torque: reactions of the submodel are force and moments of statics."""
    force, torque = 0.5, 0.8
    step = 2 if kind == "B32" else 1

    def beam(n: int, first: float, last: float) -> tuple[str, int]:
        xs = np.linspace(first, last, step * n + 1)
        nodes = "".join(f"{i + 1}, {x:.15g}, 0., 0.\n" for i, x in enumerate(xs))
        elements = "".join(f"{e + 1}, " + ", ".join(str(step * e + 1 + k) for k in range(step + 1)) + "\n" for e in range(n))
        return (f"*NODE, NSET=N\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{elements}{LAW}*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n0.4, 0.3\n0., 1., 0.\n"
                f"*NSET, NSET=LEFT\n1\n*NSET, NSET=RIGHT\n{len(xs)}\n"), len(xs)  # fmt: skip

    cards, last = beam(40, 0.0, LENGTH)
    run_job(run, tmp_path, "global", f"{cards}*BOUNDARY\nLEFT, ENCASTRE\n*STEP\n*STATIC\n*CLOAD\n{last}, 3, {force}\n{last}, 4, {torque}\n*END STEP\n")
    cards, _ = beam(12, 2.2, 4.9)
    deck = f"{cards}*SUBMODEL, INPUT=global.vtkhdf\nLEFT, RIGHT\n*STEP\n*STATIC\n*BOUNDARY, SUBMODEL, STEP=1\nLEFT, 1, 6\nRIGHT, 1, 6\n"
    run_job(run, tmp_path, "sub", deck + "*EL PRINT, ELSET=E\nSF, SM\n*NODE PRINT, NSET=N\nU\n*END STEP\n")
    forces = np.array(list(last_table(tmp_path, "section forces").values()))[4:8]
    moments = np.array(list(last_table(tmp_path, "section moments").values()))[4:8]
    assert np.abs(forces[:, 1:]).sum(axis=1).mean() == pytest.approx(force, rel=0.02)
    assert np.abs(moments[:, 2]).mean() == pytest.approx(torque, rel=0.01 if kind == "B32" else 0.02)


def test_axisymmetric(run: Run, tmp_path: Path) -> None:
    """A clamped circular plate under pressure: the ring between two radii finds w = p (a^2 - r^2)^2/(64 D) + p (a^2 - r^2)/(4 K) at its middle."""
    radius, pressure = 10.0, 1e-4

    def plate(n: int, first: float, last: float) -> str:
        xs = np.linspace(first, last, n + 1)
        nodes = "".join(f"{i + 1}, {x:.15g}, 0.\n" for i, x in enumerate(xs))
        elements = "".join(f"{e + 1}, {e + 1}, {e + 2}\n" for e in range(n))
        return f"*NODE, NSET=N\n{nodes}*ELEMENT, TYPE=SAX1, ELSET=E\n{elements}{SECTION}"

    run_job(run, tmp_path, "global", f"{plate(40, 0.0, radius)}*BOUNDARY\n1, XSYMM\n41, ENCASTRE\n*STEP\n*STATIC\n*DLOAD\nE, P, {pressure}\n*END STEP\n")
    deck = f"{plate(20, 3.1, 6.2)}*SUBMODEL, INPUT=global.vtkhdf\n1, 21\n*STEP\n*STATIC\n*DLOAD\nE, P, {pressure}\n*BOUNDARY, SUBMODEL, STEP=1\n1, 1, 6\n21, 1, 6\n*NODE PRINT, NSET=N\nU\n*END STEP\n"
    run_job(run, tmp_path, "sub", deck)
    found = abs(last_table(tmp_path, "displacements")[11][1])
    r = 0.5 * (3.1 + 6.2)
    exact = pressure * (radius**2 - r**2) ** 2 / (64 * RIGIDITY) + pressure * (radius**2 - r**2) / (4 * E / 2 * THICK)
    assert found == pytest.approx(exact, rel=0.005)


CUBE = "*NODE, NSET=N\n1, 0., 0., -1.\n2, 8., 0., -1.\n3, 8., 1., -1.\n4, 0., 1., -1.\n5, 0., 0., 1.\n6, 8., 0., 1.\n7, 8., 1., 1.\n8, 0., 1., 1.\n*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"


@pytest.mark.parametrize(
    ("change", "option", "words"),
    [
        (("1, 6", "1, 6, 0.1"), "abaqus", "and no value"),
        (("", ""), "calculix", "In the calculix dialect the driven nodes"),
        (("*BOUNDARY, SUBMODEL, STEP=1\nLEFT, 1, 6\nRIGHT, 1, 6", "*TEMPERATURE, SUBMODEL, STEP=1\nLEFT"), "abaqus", "whose temperature has gradients over the thickness"),
    ],
)  # fmt: skip
def test_refused(run: Run, tmp_path: Path, change: tuple[str, str], option: str, words: str) -> None:
    """Bad decks."""
    run_job(run, tmp_path, "global", global_strip("S8R", 4, 5, 0.001))
    _, deck = submodel_strip("S4", 4, 2.0, 5.0)
    (tmp_path / "sub.inp").write_text(deck.replace(*change))
    done = run([f"--dialect={option}", "sub"], cwd=tmp_path)
    assert done.returncode == 3, done.stdout
    assert words in " ".join((done.stdout + done.stderr).split())


def test_rotations_of_solids_are_refused(run: Run, tmp_path: Path) -> None:
    """Nodes of solids have none."""
    run_job(run, tmp_path, "global", global_strip("S8R", 4, 5, 0.001))
    deck = f"{CUBE}{LAW}*SOLID SECTION, ELSET=E, MATERIAL=M\n*SUBMODEL, INPUT=global.vtkhdf\nN\n*STEP\n*STATIC\n*BOUNDARY, SUBMODEL, STEP=1\nN, 1, 6\n*END STEP\n"
    (tmp_path / "sub.inp").write_text(deck)
    done = run(["sub"], cwd=tmp_path)
    assert done.returncode == 3
    assert "and the rotations 4 to 6 of shells and beams" in " ".join((done.stdout + done.stderr).split())


def test_shell_across_the_global_thickness(run: Run, tmp_path: Path) -> None:
    """A shell whose normal lies in the plane of the global shell has no fibre there."""
    run_job(run, tmp_path, "global", global_strip("S8R", 4, 5, 0.001))
    body = shell("S4", (2, 2), lambda u, v: (2 + u, 0 * u + 0.5, 0.1 * (v - 0.5)))
    deck = f"{body.cards()}{sets_of(body)}{SECTION}*SUBMODEL, INPUT=global.vtkhdf\nLEFT, RIGHT\n*STEP\n*STATIC\n*BOUNDARY, SUBMODEL, STEP=1\nLEFT, 1, 6\nRIGHT, 1, 6\n*END STEP\n"
    (tmp_path / "sub.inp").write_text(deck)
    done = run(["sub"], cwd=tmp_path)
    assert done.returncode != 0
    assert "whose thickness is not along the normal" in " ".join((done.stdout + done.stderr).split())
