"""Forces that turn with their nodes (*CLOAD, FOLLOWER): a cantilever under a force that stays normal to its tip.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from verify.conftest import Run
from verify.independent.results import read_field, read_history, read_results

LENGTH, SIDE, MODULUS = 10.0, 0.1, 1.2e6
DECK_ERROR = 3


def elastica(load: float) -> np.ndarray:
    """Tip displacement of an inextensible beam (Euler's elastica), by the load P L^2/(E I). In the frame of the tip the force is
    fixed: the angle follows from EI phi'' = P cos(phi) with phi = phi' = 0 at the tip, without shooting.
    """
    scale = load / LENGTH**2
    path = solve_ivp(lambda _, y: [y[1], scale * np.cos(y[0]), np.cos(y[0]), -np.sin(y[0])], (0, LENGTH), np.zeros(4), rtol=1e-11, atol=1e-12)
    angle, _, along, across = path.y[:, -1]
    return np.array([np.cos(angle) * along - np.sin(angle) * across - LENGTH, np.sin(angle) * along + np.cos(angle) * across])


def cantilever(kind: str, load: float) -> str:
    """Along x, clamped at x = 0, with the force along y at x = 10; solids have a kinematic coupling there."""
    force = load * MODULUS * SIDE**4 / 12 / LENGTH**2
    lines = ["*NODE, NSET=ALL"]
    if kind == "B32":
        n = 10
        lines += [f"{i + 1}, {LENGTH * i / (2 * n)}, 0, 0" for i in range(2 * n + 1)]
        lines += ["*ELEMENT, TYPE=B32, ELSET=E", *(f"{e + 1}, {2 * e + 1}, {2 * e + 2}, {2 * e + 3}" for e in range(n))]
        lines += ["*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT", f"{SIDE}, {SIDE}", "0, 0, 1", "*NSET, NSET=TIP", str(2 * n + 1)]
        clamp, forces = "1, ENCASTRE", f"TIP, 2, {force}"
    elif kind == "S4R":
        n = 20
        lines += [f"{2 * i + j + 1}, {LENGTH * i / n}, 0, {SIDE * j}" for i in range(n + 1) for j in range(2)]
        lines += ["*ELEMENT, TYPE=S4R, ELSET=E", *(f"{e + 1}, {2 * e + 1}, {2 * e + 3}, {2 * e + 4}, {2 * e + 2}" for e in range(n))]
        lines += ["*SHELL SECTION, ELSET=E, MATERIAL=M", str(SIDE), "*NSET, NSET=TIP", f"{2 * n + 1}, {2 * n + 2}"]
        clamp, forces = "1, ENCASTRE\n2, ENCASTRE", f"TIP, 2, {force / 2}"
    else:
        n = 40
        lines += [f"{4 * i + j + 1}, {LENGTH * i / n}, {y}, {z}" for i in range(n + 1)
                  for j, (y, z) in enumerate(SIDE * (np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) - 0.5))]  # fmt: skip
        lines += [f"999, {LENGTH}, 0, 0", "*ELEMENT, TYPE=C3D8I, ELSET=E"]
        lines += [", ".join(map(str, [e + 1, *(4 * e + k for k in range(1, 9))])) for e in range(n)]
        lines += ["*SOLID SECTION, ELSET=E, MATERIAL=M", "*SURFACE, NAME=END", f"{n}, S2", "*NSET, NSET=TIP", "999",
                  "*COUPLING, CONSTRAINT NAME=C, REF NODE=999, SURFACE=END", "*KINEMATIC"]  # fmt: skip
        clamp, forces = "1, 1, 3\n2, 1, 3\n3, 1, 3\n4, 1, 3", f"TIP, 2, {force}"
    return "\n".join([*lines, "*MATERIAL, NAME=M", "*ELASTIC", f"{MODULUS}, 0.", "*BOUNDARY", clamp, "*STEP, NLGEOM, INC=200",
                      "*STATIC", "0.1, 1", "*CLOAD, FOLLOWER", forces, "*END STEP", ""])  # fmt: skip


@pytest.mark.parametrize("load", [4.0, 10.0])
@pytest.mark.parametrize("kind", ["B32", "S4R", "C3D8I"])
def test_cantilever_under_a_follower_force(kind: str, load: float, run_deck: Run, tmp_path: Path) -> None:
    """The tip turns by 102 and 171 degrees. Limit: 0.4 % of the length, of elements that are 1/10 to 1/40 of it."""
    result = run_deck(cantilever(kind, load))
    assert result.returncode == 0, result.stdout + result.stderr
    tip, reference = read_tip(tmp_path / "job.vtkhdf"), elastica(load)
    assert np.abs(tip - reference).max() <= 0.004 * LENGTH, (tip, reference)
    result = run_deck(cantilever(kind, load).replace(", FOLLOWER", ""))
    assert result.returncode == 0, result.stdout + result.stderr
    assert np.abs(read_tip(tmp_path / "job.vtkhdf") - reference).max() > 0.05 * LENGTH  # a force of fixed direction bends it less


@pytest.mark.parametrize("kind", ["B32", "C3D8I"])
def test_moments_keep_their_axes(kind: str, run_deck: Run, tmp_path: Path) -> None:
    """A moment bends the cantilever by 1 rad, one about x stays about x: the moments of the clamp balance both, to the tolerance of Newton's
    method. Forces on the components of a rotation vector would differ by about half of the angle.
    """
    bending = MODULUS * SIDE**4 / 12 / LENGTH
    deck = cantilever(kind, 0.0)
    moments = f"*CLOAD\nTIP, 6, {bending}\nTIP, 4, {0.1 * bending}\n"
    result = run_deck(deck[: deck.index("*CLOAD")] + "*CONTROLS, PARAMETERS=FIELD\n1e-8, 1e-8\n" + moments + "*END STEP\n")
    assert result.returncode == 0, result.stdout + result.stderr
    data = read_results(tmp_path / "job.vtkhdf")
    assert data.reactions is not None
    place, force, moment = data.points, data.reactions[-1], np.zeros(3)
    if kind == "B32":  # the moments of its clamp are the forces of the rotation node
        is_rotation = ~np.isin(np.arange(len(place)), used_nodes(tmp_path / "job.vtkhdf"))
        is_rotation[:21] = False
        assert np.abs(data.displacements[-1][is_rotation]).max() > 0.9
        moment, force = force[is_rotation].sum(axis=0), np.where(is_rotation[:, None], 0, force)
    moment = moment + np.cross(place, force).sum(axis=0)
    assert np.abs(moment + [0.1 * bending, 0, bending]).max() <= 1e-4 * bending, moment / bending
    assert np.abs(force.sum(axis=0)).max() <= 1e-5 * bending / LENGTH


def used_nodes(path: Path) -> np.ndarray:
    """The nodes of elements."""
    with h5py.File(path) as file:
        return np.unique(file["VTKHDF/Connectivity"][:])


def read_tip(path: Path) -> np.ndarray:
    """The displacement in the plane of a node of the deck at the tip."""
    with h5py.File(path) as file:
        points = np.asarray(file["VTKHDF/Points"][: file["VTKHDF/NumberOfPoints"][0]])
    at_tip = np.abs(points[:, :2] - [LENGTH, 0]).max(axis=1) < 1e-9
    assert at_tip.any()
    return read_field(path, "U")[-1][at_tip][0, :2]


def elastica_with_dead_load(follower: float, dead: float) -> np.ndarray:
    """Tip displacement under a follower force and one along y, both by P L^2/(E I). The force in the beam is constant, and known with
    the angle of the tip: EI phi'' = -(F_y cos(phi) - F_x sin(phi)), from the tip back to the clamp, where phi = 0 gives that angle.
    """
    def back(tip: float) -> np.ndarray:
        f_x, f_y = -follower * np.sin(tip) / LENGTH**2, (follower * np.cos(tip) + dead) / LENGTH**2
        path = solve_ivp(lambda _, y: [y[1], -(f_y * np.cos(y[0]) - f_x * np.sin(y[0])), np.cos(y[0]), np.sin(y[0])], (0, LENGTH), [tip, 0, 0, 0], rtol=1e-10, atol=1e-12)
        return path.y[:, -1]

    tip = brentq(lambda angle: back(angle)[0], 0.3, 2.5)
    return back(tip)[2:] - [LENGTH, 0]


@pytest.mark.parametrize("kind", ["B32", "S4R", "C3D8I"])
def test_a_dead_load_beside_a_follower_force(kind: str, run_deck: Run, tmp_path: Path) -> None:
    """On the same node and degree of freedom: one turns with the node, the other one keeps its direction."""
    follower, dead = 3.0, 2.0
    deck = cantilever(kind, follower)
    turned = deck[deck.index("*CLOAD, FOLLOWER\n") : deck.index("*END STEP")]
    both = turned + turned.replace(", FOLLOWER", "").replace(turned.split()[-1], str(float(turned.split()[-1]) * dead / follower))
    result = run_deck(deck.replace(turned, both))
    assert result.returncode == 0, result.stdout + result.stderr
    tip, reference = read_tip(tmp_path / "job.vtkhdf"), elastica_with_dead_load(follower, dead)
    assert np.abs(tip - reference).max() <= 0.004 * LENGTH, (tip, reference)
    for one in (follower + dead, 0.0):  # it differs from both loads alike
        other = elastica_with_dead_load(one, follower + dead - one)
        assert np.abs(tip - other).max() > 0.02 * LENGTH


def test_loads_of_a_node_that_is_turned(run_deck: Run, tmp_path: Path) -> None:
    """A rigid body on two springs, turned by 60 degrees about z: a follower force F and a dead load Q along x give
    k u = (Q + F cos(60), F sin(60)). A later step changes the dead load alone; OP=NEW removes both."""
    stiffness, follower, dead = 50.0, 4.0, 3.0
    cube = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    deck = "*NODE\n" + "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(cube, 1)) + "90, 2., 0., 0.\n"
    deck += "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
    deck += "*RIGID BODY, ELSET=E, REF NODE=90\n"
    for k in (1, 2):
        deck += f"*ELEMENT, TYPE=SPRING1, ELSET=S{k}\n{10 + k}, 90\n*SPRING, ELSET=S{k}\n{k}\n{stiffness}\n"
    deck += f"*STEP, NLGEOM\n*STATIC\n0.25, 1.\n*BOUNDARY\n90, 3, 5\n90, 6, 6, {np.pi / 3}\n*CLOAD, FOLLOWER\n90, 1, {follower}\n*CLOAD\n90, 1, {dead}\n"
    shown = "*NSET, NSET=REFERENCE\n90\n*NODE PRINT, NSET=REFERENCE\nU\n*END STEP\n"
    deck += shown + f"*STEP, NLGEOM\n*STATIC\n*CLOAD\n90, 1, {-dead}\n*END STEP\n"
    deck += "*STEP, NLGEOM\n*STATIC\n*CLOAD, OP=NEW\n*END STEP\n"
    result = run_deck(deck)
    assert result.returncode == 0, result.stdout + result.stderr
    rows = [line.split() for line in (tmp_path / "job.dat").read_text().splitlines() if line.split()[:1] == ["90"]]
    u = np.array([[float(word) for word in row[1:3]] for row in rows]) * stiffness
    turned = follower * np.array([np.cos(np.pi / 3), np.sin(np.pi / 3)])
    for row, expected in ((3, turned + [dead, 0]), (-2, turned - [dead, 0]), (-1, np.zeros(2))):
        assert u[row] == pytest.approx(expected, abs=1e-5 * follower)


def test_iterations_of_an_exact_tangent(run_deck: Run, tmp_path: Path) -> None:
    """A small follower force on a thick cantilever: Newton's method converges quadratically, in at most four iterations."""
    deck = cantilever("S4R", 0.5).replace(f"*SHELL SECTION, ELSET=E, MATERIAL=M\n{SIDE}\n", f"*SHELL SECTION, ELSET=E, MATERIAL=M\n{10 * SIDE}\n")
    result = run_deck(deck.replace(f", 2, {0.25 * MODULUS * SIDE**4 / 12 / LENGTH**2}", f", 2, {250 * MODULUS * SIDE**4 / 12 / LENGTH**2}"))
    assert result.returncode == 0, result.stdout + result.stderr
    assert read_history(tmp_path / "job.vtkhdf")["n_iterations"].max() <= 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("*CLOAD, FOLLOWER\nTIP, 2", "*CLOAD, FOLLOWER\nTIP, 6"), "FOLLOWER turns forces, degrees of freedom 1 to 3"),
        (("*CLOAD, FOLLOWER\nTIP", "*CLOAD, FOLLOWER\n20"), "which the node 20 cannot"),
        (("*KINEMATIC", "*DISTRIBUTING"), "the rotation of a *DISTRIBUTING coupling is a small one"),
    ],
)
def test_what_cannot_turn_is_refused(change: tuple[str, str], message: str, run_deck: Run) -> None:
    """Moments, nodes of solids, distributing couplings."""
    result = run_deck(cantilever("C3D8I", 4.0).replace(*change))
    assert result.returncode == DECK_ERROR
    assert message in " ".join((result.stdout + result.stderr).split())


def test_calculix_has_none(run_deck: Run, tmp_path: Path) -> None:
    """CalculiX warns and keeps the direction; so does its dialect."""
    deck = "** dialect: calculix\n" + cantilever("C3D8I", 1.0).replace("*COUPLING, CONSTRAINT NAME=C, REF NODE=999, SURFACE=END\n*KINEMATIC", "*NSET, NSET=FACE\n161, 162, 163, 164\n*RIGID BODY, NSET=FACE, REF NODE=999")
    result = run_deck(deck)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "CalculiX has no FOLLOWER" in " ".join((result.stdout + result.stderr).split())
    u = read_field(tmp_path / "job.vtkhdf", "U")[-1]
    assert run_deck(deck.replace(", FOLLOWER", "")).returncode == 0
    assert np.array_equal(u, read_field(tmp_path / "job.vtkhdf", "U")[-1])
