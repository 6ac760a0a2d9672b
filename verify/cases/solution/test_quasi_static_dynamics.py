"""DYNAMIC, APPLICATION=QUASI-STATIC: backward Euler against its recurrence, a fall, a snap, energies, what is refused.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.cases.solution.test_failure_report import pressed_arch
from verify.cases.solution.test_stabilization import CUBE, TRUSSES, history, lifted
from verify.conftest import Run
from verify.decks.loose_bodies import Pile, by_inertia, stack, wall
from verify.decks.make_decks import block
from verify.decks.sheets import between, fix, pair, solid_deck

BAR = CUBE.replace("*SOLID SECTION", "*DENSITY\n3.\n*SOLID SECTION")
ARCH = TRUSSES.replace("*SOLID SECTION", "*DENSITY\n0.3\n*SOLID SECTION")
MASS, STIFFNESS = 1.0, 1000.0  # of BAR for u = z w: a third of its mass, E A/L


def step(times: str, cards: str, words: str = "", of_step: str = "") -> str:
    """A step with inertia."""
    return f"*STEP, INC=2000{of_step}\n*DYNAMIC, APPLICATION=QUASI-STATIC{words}\n{times}\n{cards}\n*END STEP\n"


def march(u: float, v: float, dt: float, forces: list[float]) -> tuple[list[float], list[float], float]:
    """Backward Euler for one unknown: displacements, kinetic energies, and what the rule dissipates."""
    places, energies, loss = [], [], 0.0
    for force in forces:
        new = (force + MASS / dt**2 * (u + dt * v)) / (STIFFNESS + MASS / dt**2)
        rate = (new - u) / dt
        loss += 0.5 * MASS * (rate - v) ** 2 + 0.5 * STIFFNESS * (new - u) ** 2
        u, v = new, rate
        places.append(u)
        energies.append(0.5 * MASS * v**2)
    return places, energies, loss


def balance(folder: Path) -> np.ndarray:
    """External work without all that took it, over the largest energy."""
    taken = ["strain_energy", "kinetic_energy", "integration_loss", "friction_work", "contact_energy", "plastic_work", "damped_work"]
    given = history(folder, "external_work")
    return (given - sum(history(folder, name) for name in taken)) / max(abs(given).max(), history(folder, "integration_loss").max())


def test_recurrence(run_deck: Run, tmp_path: Path) -> None:
    """A bar under a force that grows, then one that acts at once with the velocity kept, then a static step: rest.

    The modes of the bar follow one unknown if it is as stiff as E A/L, and a third of its mass moves with its end.
    """
    deck = BAR + step("0.02, 0.2", "*CLOAD\nHIGH, 3, 1.", ", DIRECT") + step("0.02, 0.1", "*CLOAD\nHIGH, 3, -2.", ", DIRECT", ", AMPLITUDE=STEP")
    deck += "*STEP\n*STATIC\n1., 1.\n*END STEP\n" + step("0.02, 0.04", "*CLOAD\nHIGH, 3, 1.", ", DIRECT", ", AMPLITUDE=STEP")
    done = run_deck(deck)
    assert done.returncode == 0, done.stdout
    first, kinetic, loss = march(0.0, 0.0, 0.02, [0.4 * i for i in range(1, 11)])
    second, more, lost = march(first[-1], (first[-1] - first[-2]) / 0.02, 0.02, [-8.0] * 5)
    rest = -8.0 / STIFFNESS
    third, last, final = march(rest, 0.0, 0.02, [4.0] * 2)
    assert lifted(tmp_path) == pytest.approx(np.array([*first, *second, rest, *third]), rel=1e-10)
    assert history(tmp_path, "kinetic_energy") == pytest.approx(np.array([*kinetic, *more, 0.0, *last]), rel=1e-9, abs=1e-14)
    assert history(tmp_path, "integration_loss")[[9, 14, 15, 17]] == pytest.approx([loss, loss + lost, loss + lost, loss + lost + final], rel=1e-9)
    assert history(tmp_path, "applied_force")[:10, 2] == pytest.approx([0.4 * i for i in range(1, 11)], rel=1e-10), "loads alone"
    assert balance(tmp_path)[:15] == pytest.approx(0.0, abs=1e-10)


def test_sudden_load_comes_to_rest(run_deck: Run, tmp_path: Path) -> None:
    """The static displacement remains, and half the work of the force is dissipated: F u - F u/2."""
    done = run_deck(BAR + step("0.02, 10., 1e-6, 0.5", "*CLOAD\nHIGH, 3, 1.\n*NODE PRINT, NSET=HIGH\nV", "", ", AMPLITUDE=STEP"))
    assert done.returncode == 0, done.stdout
    first = next(line.split() for line in (tmp_path / "job.dat").read_text().split("velocities (vx,vy,vz)")[1].splitlines()[1:] if line.split())
    assert float(first[3]) == pytest.approx(march(0.0, 0.0, 0.02, [4.0])[0][0] / 0.02, rel=1e-5)
    assert lifted(tmp_path)[-1] == pytest.approx(4.0 / STIFFNESS, rel=1e-6)
    assert history(tmp_path, "kinetic_energy")[-1] < 1e-8 * history(tmp_path, "strain_energy")[-1]
    assert history(tmp_path, "integration_loss")[-1] == pytest.approx(0.5 * 16.0 / STIFFNESS, rel=1e-5)
    assert balance(tmp_path) == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("is_surface", [False, True])
def test_fall(run_deck: Run, tmp_path: Path, is_surface: bool) -> None:
    """A block without any support falls on a table: u = -g dt^2 n (n + 1)/2 until it touches, then it rests with its weight."""
    body = block(between(0, 1, 3), between(0, 1, 3), between(0.5, 1.5, 3), "BODY")
    table = block(between(-1, 2, 5), between(-1, 2, 5), between(-1, 0, 2), "TABLE")
    density, gravity, dt = 1e-3, 9810.0, 1e-3
    cards = pair("BODY_BOTTOM", "TABLE_TOP", 0.3, ", TYPE=SURFACE TO SURFACE" if is_surface else "")
    loads = fix("TABLE_BOTTOM, 1, 3") + f"*DLOAD\nBODY, GRAV, {gravity}, 0., 0., -1."
    steps = step(f"{dt}, 0.03", loads, ", DIRECT", ", NLGEOM, AMPLITUDE=STEP")
    deck = solid_deck([(body, (210000.0, 0.3)), (table, (210000.0, 0.3))], cards, steps)
    done = run_deck(deck.replace("*SOLID SECTION", f"*DENSITY\n{density}\n*SOLID SECTION"))
    assert done.returncode == 0, done.stdout
    touched = next(n for n in range(1, 100) if gravity * dt**2 * n * (n + 1) / 2 > 0.5)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        u = np.asarray(file["VTKHDF/PointData/U"])
        fall = u.reshape(-1, len(body.nodes) + len(table.nodes), 3)[1:, : len(body.nodes), 2]
    free = [-gravity * dt**2 * n * (n + 1) / 2 for n in range(1, touched)]
    assert fall[: touched - 1] == pytest.approx(np.outer(free, np.ones(len(body.nodes))), rel=1e-9), "the same at all nodes"
    force = history(tmp_path, "slave_force")[:, 2]
    assert force[: touched - 1] == pytest.approx(0.0, abs=1e-9)
    assert force[touched - 1] > 0.0
    assert force[-1] == pytest.approx(density * gravity, rel=1e-3)
    assert fall[-1] == pytest.approx(-0.5, abs=1e-3)
    assert balance(tmp_path) == pytest.approx(0.0, abs=1e-6)
    assert history(tmp_path, "integration_loss")[-1] == pytest.approx(density * gravity * 0.5, rel=1e-2), "the impact takes the fall"


def test_snap_through(run_deck: Run, tmp_path: Path) -> None:
    """Two shallow trusses of Hencky's material under three times their limit end where statics has its other branch.

    P = -2 tau A y/l L/l with tau = E ln(l/L), y the height of the apex. A static step ends at the limit point.
    """
    done = run_deck(ARCH + step("0.05, 1., 1e-8", "*CLOAD\n2, 2, -1.2", "", ", NLGEOM") + step("0.1, 100.", "", "", ", NLGEOM"))
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        y = 1 + float(np.asarray(file["VTKHDF/PointData/U"]).reshape(-1, 3, 3)[-1, 1, 1])
    old, long = np.hypot(10.0, 1.0), np.hypot(10.0, y)
    assert y < -1
    assert -2 * 1000 * np.log(long / old) * y / long * old / long == pytest.approx(1.2, rel=1e-6)
    assert history(tmp_path, "kinetic_energy").max() > 1e3 * history(tmp_path, "kinetic_energy")[-1]
    assert balance(tmp_path) == pytest.approx(0.0, abs=1e-5)


def last_u(folder: Path) -> np.ndarray:
    """The displacements at the end."""
    with h5py.File(folder / "job.vtkhdf") as file:
        return np.asarray(file["VTKHDF/PointData/U"][-len(file["VTKHDF/Points"]) :])


def test_pressed_arch(run_deck: Run, tmp_path: Path) -> None:
    """A stamp under forces presses an arch through: by inertia it ends where statics does, after snap-through steps."""
    deck = by_inertia(pressed_arch(), "0.01, 1., 1e-9, 0.1")
    done = run_deck(deck + step("0.1, 10.", "", "", ", NLGEOM"))
    assert done.returncode == 0, done.stdout
    u = last_u(tmp_path)
    assert history(tmp_path, "reaction_force")[-1, 1] == pytest.approx(1500.0, rel=1e-6)
    assert u[:, 1].min() < -0.6, "the middle of the arch lies below its supports by as much as it was above, and more"
    assert balance(tmp_path) == pytest.approx(0.0, abs=1e-8)
    assert history(tmp_path, "integration_loss")[-1] > 0.5, "what the snap releases"
    done = run_deck(pressed_arch())
    assert done.returncode == 0, done.stdout
    assert np.abs(u - last_u(tmp_path)).max() < 1e-3 * np.abs(u).max(), "friction alone remembers the way"


@pytest.mark.parametrize(
    "pile",
    [pytest.param(stack(8, 0.1), id="stack of 8"), pytest.param(stack(16, 0.1, cells=1, options=", TYPE=SURFACE TO SURFACE"), id="stack of 16 by faces"),
     pytest.param(wall(5, 5, 0.1, cells=1, options=", TYPE=SURFACE TO SURFACE"), id="wall by faces")],
)  # fmt: skip
def test_piles_fall(run_deck: Run, tmp_path: Path, pile: Pile) -> None:
    """Loose blocks fall on one another and rest, also where a static step finds no support: the table carries weight and push."""
    done = run_deck(by_inertia(pile.deck, "1e-3, 0.5, 1e-9, 0.05", ", AMPLITUDE=STEP"))
    assert done.returncode == 0, done.stdout
    assert history(tmp_path, "reaction_force")[-1, :2] == pytest.approx([-pile.push, pile.weight], abs=1e-5 * pile.weight)
    assert history(tmp_path, "kinetic_energy")[-1] < 1e-9 * history(tmp_path, "external_work")[-1]
    assert balance(tmp_path) == pytest.approx(0.0, abs=1e-8)
    assert not history(tmp_path, "proximal_work").any()


def test_resumed(run_deck: Run, tmp_path: Path) -> None:
    """A job cut in two by RESTART continues with velocity and energies, bitwise."""
    assert run_deck(BAR + step("0.02, 0.2", "*RESTART, WRITE\n*CLOAD\nHIGH, 3, 1.", ", DIRECT")).returncode == 0
    whole = lifted(tmp_path), history(tmp_path, "kinetic_energy"), history(tmp_path, "integration_loss")
    (tmp_path / "job.res").rename(tmp_path / "old.res")
    done = run_deck("*RESTART, READ, STEP=1, INC=5\n", "oldjob=old")
    assert done.returncode == 0, done.stdout
    assert np.array_equal(lifted(tmp_path)[-5:], whole[0][-5:])
    assert np.array_equal(history(tmp_path, "kinetic_energy")[-5:], whole[1][-5:])
    assert np.array_equal(history(tmp_path, "integration_loss")[-5:], whole[2][-5:])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [("", "*DYNAMIC needs APPLICATION=QUASI-STATIC"), (", APPLICATION=TRANSIENT FIDELITY", "Waves and vibration are not resolved"),
     (", APPLICATION=QUASI-STATIC, ALPHA=-0.05", "Backward Euler has no such parameter")],
)  # fmt: skip
def test_refused(run_deck: Run, words: str, sentence: str) -> None:
    """Other dynamics, and no density."""
    done = run_deck(BAR + f"*STEP\n*DYNAMIC{words}\n0.1, 1.\n*END STEP\n")
    assert done.returncode == 3
    assert sentence in " ".join(done.stdout.split()), done.stdout


def test_density_is_needed(run_deck: Run) -> None:
    """A sentence that names the material."""
    done = run_deck(CUBE + step("0.1, 1.", "*CLOAD\nHIGH, 3, 1."))
    assert done.returncode == 3
    assert "give *DENSITY to the material M" in " ".join(done.stdout.split()), done.stdout
