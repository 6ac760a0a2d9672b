"""Self contact: a post-buckled tube, a C-shaped block and a ring, by one surface, by two, and by general contact.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

from verify.conftest import Run
from verify.decks.planes import Plane, flat_deck, flatten
from verify.decks.sheets import between, fix, plane_deck, sheet, step

Floats = NDArray[np.float64]
FORMS = ["NODE", "SURFACE"]
EQUAL = 1e-6  #: over the largest value: the same slaves and masters, but for a side that is chosen anew in each increment
WALL = 0.01  #: of the tube, over its mean radius
OVAL = 0.001  #: imperfection of the tube, over its mean radius
TOL_TUBE = 0.01  #: the stretch of the wall, the imperfection, and the mesh
CONTACT_LOAD, LINE_LOAD = 5.247, 10.34  #: J. Flaherty, J. Keller, S. Rubinow, SIAM J. Appl. Math. 23 (1972) 446-455 [D / R^3]


def self_pair(form: str, mu: float = 0.0, surfaces: str = "SKIN") -> str:
    """A pair of the inner surface with itself, or of two surfaces."""
    friction = f"*FRICTION\n{mu}\n" if mu else ""
    return f"*SURFACE INTERACTION, NAME=I\n{friction}*CONTACT PAIR, INTERACTION=I, TYPE={form} TO SURFACE\n{surfaces}\n"


def general(mu: float = 0.0) -> str:
    """The same by general contact."""
    interaction = "*SURFACE INTERACTION, NAME=I\n" + (f"*FRICTION\n{mu}\n" if mu else "")
    return interaction + "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PROPERTY ASSIGNMENT\n, , I\n"


def solve(run: Run, folder: Path, deck: str, code: int = 0) -> Path:
    """Runs a deck; its result file."""
    (folder / "job.inp").write_text(deck)
    done = run(["--outdir", folder, folder / "job.inp"], folder)
    assert done.returncode == code, done.stdout + done.stderr
    return folder / "job.vtkhdf"


def contact_forces(file: h5py.File) -> tuple[Floats, Floats]:
    """Time and forces of the slaves in each frame: (frames), (frames, slaves, 3)."""
    n = len(file["AMONTONS/contact/node"])
    times = np.asarray(file["VTKHDF/Steps/Values"])
    return times, np.asarray(file["AMONTONS/contact/force"]).reshape(len(times), n, 3)


# A tube under outer pressure


def elastica_of_a_ring(load: float | None, distance: float) -> tuple[float, float]:
    """Load and contact force on a quarter of an inextensible ring of radius 1 and bending stiffness 1 whose sides are at a distance.

    Without a load: that of the first touch, where the force is zero. The state is x, y, angle, curvature and the two forces.
    """

    def slopes(_s: Floats, state: Floats, p: float) -> Floats:
        x, _, angle, curvature, f_x, f_y = state
        return np.array([np.cos(angle), np.sin(angle), curvature, np.sin(angle) * f_x - np.cos(angle) * f_y,
                         p * np.sin(angle), -p * np.cos(angle)])  # fmt: skip

    def ends(a: Floats, b: Floats) -> Floats:
        return np.array([a[1], a[2] - np.pi / 2, a[4], b[0], b[2] - np.pi])

    s = np.linspace(0, np.pi / 2, 201)
    state = np.array([1.25 * np.cos(s), 0.75 * np.sin(s), np.pi / 2 + s + 0.5 * np.sin(2 * s), 1 + np.cos(2 * s), 0 * s, -3.2 * np.cos(s)])
    for p in np.linspace(3.2, 5.0, 20):
        state = solve_bvp(lambda s, y, p=p: slopes(s, y, p), lambda a, b: np.append(ends(a, b), b[5]), s, state, tol=1e-8).sol(s)
    touch = solve_bvp(lambda s, y, q: slopes(s, y, q[0]), lambda a, b, _: np.append(ends(a, b), [b[5], b[1] - distance / 2]),
                      s, state, p=[5.0], tol=1e-9)  # fmt: skip
    if load is None:
        return float(touch.p[0]), 0.0
    state = touch.sol(s)
    for p in np.linspace(touch.p[0], load, 10):
        state = solve_bvp(lambda s, y, p=p: slopes(s, y, p), lambda a, b: np.append(ends(a, b), b[1] - distance / 2), s, state, tol=1e-9).sol(s)
    return load, float(state[5, -1])


def tube(n: int, kind: str, contact: str, load: float) -> str:
    """Half of a tube with n elements around it, a little oval; SKIN is the inside. The load over D / R^3 is a following pressure."""

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        angle, radius = np.pi * (s - 0.5), 1 + WALL / 2 - WALL * t
        radius = radius + OVAL * np.cos(2 * angle)
        return radius * np.cos(angle), radius * np.sin(angle)

    slab = sheet("T", between(0, 1, n), between(0, 1, 1), place)
    pressure = load * 1e6 * WALL**3 / 12 / (1 - 0.3**2)
    half = flatten(slab, kind.endswith("8R"))
    half.node_sets["MIDDLE"] = np.flatnonzero(np.abs(half.nodes[:, 1]) < 1e-9)
    half.surfaces["SKIN"] = half.surfaces["T_TOP"]
    slab.node_sets["MIDDLE"] = np.flatnonzero(np.abs(slab.nodes[:, 2]) < 1e-9)
    slab.surfaces["SKIN"] = slab.surfaces["T_TOP"]
    across = 3 if kind == "C3D8I" else 2
    cards = fix("T_LEFT, 1", "T_RIGHT, 1", f"MIDDLE, {across}") + f"*DSLOAD\nT_BOTTOM, P, {pressure}\n"
    steps = contact + step(cards, 40, is_nlgeom=True)
    if kind == "C3D8I":
        return plane_deck([(slab, (1e6, 0.3))], "", steps).replace("TYPE=C3D8\n", f"TYPE={kind}\n")
    return flat_deck([(half, (1e6, 0.3))], kind, steps)


def test_elastica_of_the_reference() -> None:
    """The reference itself: opposite sides touch at the published load."""
    assert elastica_of_a_ring(None, 0.0)[0] == pytest.approx(CONTACT_LOAD, abs=5e-4)


@pytest.mark.parametrize(("form", "kind", "n"), [("SURFACE", "CPE8R", 48), ("SURFACE", "CPE8R", 96), ("NODE", "C3D8I", 72)])
def test_post_buckled_tube(run: Run, tmp_path: Path, form: str, kind: str, n: int) -> None:
    """A tube that buckles flat under pressure touches itself at the load of the elastica and then has its contact force.

    (The pressure on the outside is that on the middle line and a constant tension, which does not bend.)
    """
    load = 8.0
    with h5py.File(solve(run, tmp_path, tube(n, kind, self_pair(form), load))) as file:
        times, force = contact_forces(file)
    total = np.abs(force[..., 2 if kind == "C3D8I" else 1]).sum(axis=1) / (1e6 * WALL**3 / 12 / (1 - 0.3**2))
    first, expected = elastica_of_a_ring(None, WALL)[0], elastica_of_a_ring(load, WALL)[1]
    closed = total > 0
    assert not closed[times * load < (1 - TOL_TUBE) * first].any()
    rising = times[closed] * load
    onset = rising[0] - total[closed][0] * (rising[1] - rising[0]) / (total[closed][1] - total[closed][0])
    assert onset == pytest.approx(first, rel=TOL_TUBE)
    assert total[-1] == pytest.approx(expected, rel=TOL_TUBE)


# A C-shaped block whose slot closes


def c_block(n: int, kind: str, contact: str, cards: str, steps: int = 4, slot: float = 0.05) -> str:
    """Arms of length 2 and height 0.4 around a slot; SKIN is the slot, UPPER and LOWER its sides."""
    x, y = between(0, 2.4, 6 * n), np.concatenate([between(0, 0.4, n), between(0.4 + slot, 0.8 + slot, n)])
    index = np.arange(len(x) * len(y)).reshape(len(y), len(x))
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    keep = np.ones(quads.shape[:2], dtype=bool)
    keep[n, n:] = False
    number = np.full(keep.shape, -1)
    number[keep] = np.arange(keep.sum())
    block = Plane(np.stack([np.tile(x, len(y)), np.repeat(y, len(x))], axis=1), quads[keep])
    block.element_sets = {"C": np.arange(keep.sum()), "LOW": number[n - 1, n:], "HIGH": number[n + 1, n:], "BACK": number[n, n - 1:n],
                          "LID": number[-1]}  # fmt: skip
    block.surfaces = {"LOWER": [("LOW", 3)], "UPPER": [("HIGH", 1)], "SKIN": [("LOW", 3), ("HIGH", 1), ("BACK", 2)], "LID_S": [("LID", 3)]}
    block.node_sets = {"FLOOR": index[0], "TOP": index[-1, n + 1:]}
    return flat_deck([(block, (1000.0, 0.3))], kind, contact + "".join(step(c, steps, is_nlgeom=True) for c in cards.split("|")))


def displacements(path: Path) -> Floats:
    """At the end."""
    with h5py.File(path) as file:
        return np.asarray(file["VTKHDF/PointData/U"])[-int(file["VTKHDF/NumberOfPoints"][-1]):]


PRESS = fix("FLOOR, 1, 2") + "*DSLOAD\nLID_S, P, 20.\n"
NARROW = 0.001  #: slot of the cases with friction: a wide one closes in one increment, in which friction has several solutions
DRAG = fix("TOP, 1, 1, 0.02")


@pytest.mark.parametrize("mu", [0.0, 0.2])
@pytest.mark.parametrize("n", [2, 4])
@pytest.mark.parametrize("form", FORMS)
def test_slot_as_by_two_surfaces(run: Run, tmp_path: Path, form: str, n: int, mu: float) -> None:
    """One surface that touches itself gives what a pair of the slot's lower and upper side gives; general contact does, too."""
    cards, slot = (f"{PRESS}|{DRAG}", NARROW) if mu else (PRESS, 0.05)
    results = []
    for contact in (self_pair(form, mu), self_pair(form, mu, "LOWER, UPPER")):
        results.append(displacements(solve(run, tmp_path, c_block(n, "CPE4", contact, cards, slot=slot))))
    assert np.abs(results[0] - results[1]).max() <= EQUAL * np.abs(results[1]).max()


def test_slot_by_general_contact(run: Run, tmp_path: Path) -> None:
    """ALL EXTERIOR finds the slot without a pair in the deck."""
    by_hand = displacements(solve(run, tmp_path, c_block(4, "CPE4", self_pair("SURFACE", 0.2), f"{PRESS}|{DRAG}", slot=NARROW)))
    found = displacements(solve(run, tmp_path, c_block(4, "CPE4", general(0.2), f"{PRESS}|{DRAG}", slot=NARROW)))
    assert np.abs(found - by_hand).max() <= EQUAL * np.abs(by_hand).max()


@pytest.mark.parametrize("form", FORMS)
def test_friction_in_the_slot(run: Run, tmp_path: Path, form: str) -> None:
    """Where the dragged arm slips, friction is mu times the normal force; contact forces are pressures."""
    mu = 0.2
    path = solve(run, tmp_path, c_block(4, "CPE4", self_pair(form, mu), f"{PRESS}|{fix('TOP, 1, 1, 0.1')}", steps=10))
    names = ("force", "shear", "normal")
    with h5py.File(path) as file:
        n = len(file["AMONTONS/contact/node"])
        force, tangential, normal = (np.asarray(file[f"AMONTONS/contact/{name}"]).reshape(-1, n, 3)[-1] for name in names)
        status = np.asarray(file["AMONTONS/contact/status"]).reshape(-1, n)[-1]
    pressed = (force * normal).sum(axis=1)
    shear = np.linalg.norm(tangential, axis=1)
    slipping = (status == status.max()) & (pressed > 0)
    assert pressed.min() >= -1e-9 * pressed.max()
    assert slipping.sum() >= 3
    assert np.abs(shear - mu * pressed)[slipping].max() <= 1e-6 * pressed.max()


def test_slot_without_nlgeom(run: Run, tmp_path: Path) -> None:
    """Within small displacements general contact finds a slot narrower than an edge; the pair by hand gives the same."""
    decks = [c_block(4, "CPE4", contact, PRESS).replace(", NLGEOM", "") for contact in (self_pair("SURFACE"), general())]
    by_hand, found = (displacements(solve(run, tmp_path, deck)) for deck in decks)
    assert np.abs(found - by_hand).max() <= EQUAL * np.abs(by_hand).max()


# A bent strip whose arms meet: their faces do not face each other at the start

THICK, BEND, ARM = 0.05, 0.1, 0.9  #: of the strip: thickness, radius of the middle line, length of the straight arms


RUBBER = "*HYPERELASTIC, NEO HOOKE\n192.3, 0.0024"  #: E = 1000, nu = 0.3 at small strain


def bent_strip(contact: str, load: str, n: int, kind: str = "CPE8R", is_rubber: bool = False) -> str:
    """A strip bent by a right angle, clamped at one end; BOTTOM is its inside."""
    bend = BEND * np.pi / 2

    def place(s: Floats, t: Floats) -> tuple[Floats, Floats]:
        theta = np.clip((s - ARM) / BEND, 0, np.pi / 2)
        out = (t - 0.5) * THICK
        x = BEND - (BEND + out) * np.sin(theta) + np.maximum(ARM - s, 0)
        return x, BEND - (BEND + out) * np.cos(theta) + np.maximum(s - ARM - bend, 0)

    ends = [between(0, ARM, n), between(ARM, ARM + bend, n // 2)[1:], between(ARM + bend, 2 * ARM + bend, n)[1:]]
    strip = flatten(sheet("A", np.concatenate(ends), between(0, 1, 1), place), kind[3] in "68")
    deck = flat_deck([(strip, (1000.0, 0.3))], kind, contact + step(fix("A_LEFT, 1, 2") + load, 40, is_nlgeom=True))
    return re.sub(r"\*ELASTIC\n[^\n]*", RUBBER, deck) if is_rubber else deck


def deepest_overlap(path: Path) -> float:
    """How far nodes of the free arm lie below the inside of the clamped arm, which is nearly straight where they are."""
    with h5py.File(path) as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        place = np.asarray(file["VTKHDF/Points"])[-n:]
        now = place + np.asarray(file["VTKHDF/PointData/U"])[-n:]
    inside = np.flatnonzero((np.abs(place[:, 1] - THICK / 2) < 1e-9) & (place[:, 0] > BEND))
    inside = inside[np.argsort(now[inside, 0])]
    free = now[place[:, 1] > 2 * BEND]
    free = free[free[:, 0] < now[inside[-1], 0]]
    return float(np.max(np.interp(free[:, 0], now[inside, 0], now[inside, 1]) - free[:, 1]))


FOLD = "*BOUNDARY\nA_RIGHT, 1, 1, 0.85\nA_RIGHT, 2, 2, -0.95\n"
ROLL = "*DSLOAD\nA_TOP, P, 0.1\n"


@pytest.mark.parametrize(("n", "is_rubber"), [(10, True), (20, True), (10, False)])
def test_fold(run: Run, tmp_path: Path, n: int, is_rubber: bool) -> None:
    """Rubber that is folded by more than its thickness has a pair without a word in the deck; other strips with REACH."""
    free = solve(run, tmp_path, bent_strip("", FOLD, n, is_rubber=is_rubber))
    assert deepest_overlap(free) > 0.1 * THICK, "without contact it overlaps"
    contact = general() if is_rubber else general().replace("*CONTACT\n", "*CONTACT, REACH=0.1\n")
    path = solve(run, tmp_path, bent_strip(contact, FOLD, n, is_rubber=is_rubber))
    assert deepest_overlap(path) <= 0.25 * THICK / n, "gaps are closed in the mean over a face: the overlap shrinks with it"
    with h5py.File(path) as file:
        assert np.abs(contact_forces(file)[1][-1]).max() > 0


def test_roll_beyond_the_reach(run: Run, tmp_path: Path) -> None:
    """A pressure rolls the strip up farther than general contact looks: a sentence, before the arms overlap."""
    (tmp_path / "job.inp").write_text(bent_strip(general(), ROLL, 10))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 5
    assert "of the same body" in done.stdout + done.stderr
    assert "REACH of 0.07" in done.stdout + done.stderr


def test_analytic_tool_beside_a_slot(run: Run, root: Path, tmp_path: Path) -> None:
    """The snap fit of the manual without a named pair: as with it. With a pair with itself the analytic tool must have its type."""
    deck = (root / "input" / "snap_fit.inp").read_text()
    rules = "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PROPERTY ASSIGNMENT\n, , DRY\n"
    by_hand = displacements(solve(run, tmp_path, deck))
    deck = re.sub(r"\*CONTACT PAIR[^\n]*\n[^\n]*\n", rules, deck)
    found = displacements(solve(run, tmp_path, deck))
    assert np.abs(found - by_hand).max() <= EQUAL * np.abs(by_hand).max()
    (tmp_path / "job.inp").write_text(deck.replace("*CONTACT\n", "*CONTACT, REACH=20.\n"))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 4
    assert "Give both the same TYPE" in done.stdout + done.stderr


# Messages


@pytest.mark.parametrize(("contact", "message"), [
    (self_pair("NODE").replace("TYPE=", "SMALL SLIDING, TYPE="), "leave out SMALL SLIDING"),
    (self_pair("NODE").replace("TYPE=", "ADJUST=0.1, TYPE="), "ADJUST needs two surfaces"),
    (self_pair("NODE").replace("*CONTACT PAIR", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n100.\n*CONTACT PAIR"), "hard contact only"),
])  # fmt: skip
def test_wrong_input(run: Run, tmp_path: Path, contact: str, message: str) -> None:
    """What a surface in contact with itself cannot have."""
    (tmp_path / "job.inp").write_text(c_block(2, "CPE4", contact, PRESS))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 3
    assert message in done.stdout + done.stderr


@pytest.mark.parametrize(("change", "message"), [
    (("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n"), "Give *CONTACT, TYPE=SURFACE TO SURFACE"),
    (("NAME=I\n", "NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1000.\n"), "the interaction I is not hard"),
])  # fmt: skip
def test_bodies_without_self_contact(run: Run, tmp_path: Path, change: tuple[str, str], message: str) -> None:
    """General contact by nodes of quadratic elements, or by a law: the job ends where the tube meets itself."""
    (tmp_path / "job.inp").write_text(tube(24, "CPE8R", general().replace(*change), 8.0))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 5, done.stdout + done.stderr
    assert message in done.stderr + done.stdout


def test_mid_side_nodes(run: Run, tmp_path: Path) -> None:
    """Contact at nodes would keep all edges of the surface straight."""
    (tmp_path / "job.inp").write_text(tube(8, "CPE8R", self_pair("NODE"), 1.0))
    done = run(["--outdir", tmp_path, tmp_path / "job.inp"], tmp_path)
    assert done.returncode == 3
    assert "TYPE=SURFACE TO SURFACE" in done.stdout + done.stderr
