"""Assemblies without a pair named in the deck, with default settings: a bolted flange with a shell gasket, and a rubber lip.

SPDX-License-Identifier: GPL-3.0-or-later

(The snap fit is in test_self_contact.)
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.assemblies import FLANGE_PAIRS, GAP, PRELOAD, THICK, by_hand, flange, general, rubber_lip, snap_hook
from verify.decks.make_decks import Floats

EQUAL = 1e-6  #: over the largest value: the pairs are the same


def solve(run: Run, folder: Path, name: str, deck: str) -> Path:
    """Runs a deck; its result file."""
    (folder / f"{name}.inp").write_text(deck)
    done = run(["--outdir", folder, folder / f"{name}.inp"], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / f"{name}.vtkhdf"


def at_the_end(path: Path, field: str) -> Floats:
    """A field of the nodes at the end."""
    with h5py.File(path) as file:
        return np.asarray(file[f"VTKHDF/PointData/{field}"])[-int(file["VTKHDF/NumberOfPoints"][-1]) :]


def pair_forces(path: Path) -> Floats:
    """The normal force of each pair at the end: (pairs, 3)."""
    with h5py.File(path) as file:
        n = len(file["AMONTONS/pairs/slave"])
        return np.asarray(file["AMONTONS/pair_history/CFN"])[-n:]


def test_flange_with_a_shell_gasket(run: Run, tmp_path: Path) -> None:
    """The same as with four pairs by hand, and each of the four interfaces carries the pre-tension."""
    found = solve(run, tmp_path, "found", flange(general(0.15)))
    named = solve(run, tmp_path, "named", flange(by_hand(0.15, *FLANGE_PAIRS)))
    for field in ("U", "S", "CPRESS"):
        a, b = at_the_end(found, field), at_the_end(named, field)
        assert np.abs(a - b).max() <= EQUAL * np.abs(b).max(), field
    for path in (found, named):
        forces = np.abs(pair_forces(path)[:, 2])
        pressed = forces[forces > 1e-6 * PRELOAD]
        assert pressed == pytest.approx([PRELOAD] * 4, rel=1e-6)


@pytest.mark.parametrize("n", [2, pytest.param(4, marks=pytest.mark.slow)])
def test_rubber_lip(run: Run, tmp_path: Path, n: int) -> None:
    """The plate presses the tip on the base: nothing overlaps by more than a quarter of an element (gaps are closed in the mean over a
    face), the base takes the force of the plate, and the lip presses itself. Where the tip comes to rest depends on the mesh: the forces
    for n = 2, 3, 4, 6 are 0.784, 0.748, 0.787, 0.829, so that the limit is 8 %.
    """
    path = solve(run, tmp_path, "lip", rubber_lip(n, general(0.2)))
    with h5py.File(path) as file:
        m = int(file["VTKHDF/NumberOfPoints"][-1])
        at, force = np.asarray(file["VTKHDF/Points"])[-m:], np.asarray(file["VTKHDF/PointData/RF"])[-m:]
    now = at + at_the_end(path, "U")
    is_plate = at[:, 1] > at[:, 1].max() - 0.51
    plate = force[is_plate, 1].sum()
    assert plate == pytest.approx(-force[~is_plate, 1].sum(), rel=1e-6)
    is_free = ~is_plate & (at[:, 1] > THICK)
    over = is_free & (now[:, 0] > 1.2)
    is_top = ~is_plate & (np.abs(at[:, 1] - THICK / 2) < 1e-9)
    base = now[is_top][np.argsort(now[is_top, 0])]
    overlap = np.interp(now[over, 0], base[:, 0], base[:, 1]) - now[over, 1]
    assert now[over, 1].max() <= GAP + 0.25 * THICK / n
    assert -0.1 * THICK <= overlap.max() <= 0.25 * THICK / n  # it touches the base
    assert abs(plate) == pytest.approx(0.79, rel=0.08)
    assert np.abs(pair_forces(path)[-1]).max() > 0.1 * abs(plate)  # of the pair of the lip with itself



SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("form", "n"),
    [("general nodes", 3), ("pair", 1), ("pair", 2), ("general", 1), pytest.param("general", 3, marks=SLOW), pytest.param("pair", 4, marks=SLOW)],
)
def test_snap_hook(run: Run, tmp_path: Path, form: str, n: int) -> None:
    """The hook goes over the catch by increments of several edges; shorter ones are taken where bodies would cross. Behind the catch the
    arm is straight again: all of it moved by the way of its root, and no force is left. Coarse hooks by hand: the back of the catch,
    which faces the back of the hook, lies behind it by three edges of the catch and more; the hook in front of the catch does not see it.
    """
    way = 6.8
    contact = by_hand(0.0, "HOOK_SKIN, CATCH_SKIN") if form == "pair" else general(0.0)
    if form == "general nodes":
        contact = contact.replace("*CONTACT\n", "*CONTACT, TYPE=NODE TO SURFACE\n")
    path = solve(run, tmp_path, "snap", snap_hook(contact, 0.05, way, n))
    with h5py.File(path) as file:
        m = int(file["VTKHDF/NumberOfPoints"][-1])
        is_arm = np.asarray(file["VTKHDF/Points"])[-m:, 1] > -1.01
        is_arm &= np.asarray(file["VTKHDF/Points"])[-m:, 0] < 13.1
        forces = np.abs(np.asarray(file["VTKHDF/PointData/RF"]).reshape(-1, m, 3)[:, :, 1]).sum(axis=1) / 2
    u = at_the_end(path, "U")[is_arm]
    assert np.abs(u - [way, 0, 0]).max() <= 1e-9 * way
    assert forces.max() > 0.5  # it was bent
    assert np.abs(at_the_end(path, "RF")).max() <= 1e-9 * forces.max()


def test_snap_hook_passes_a_corner(run: Run, tmp_path: Path) -> None:
    """The coarsest hook by nodes clears the side of the catch by 0.05 and glides over it. Without friction the catch pushes along its
    normals, of which the flank's, at 40 degrees, is the most inclined one against the way: the push is at most tan(40 degrees) of the
    force across. A node that the side held above its upper corner would be pushed along the way, and the ratio would have no bound.
    """
    contact = by_hand(0.0, "HOOK_SKIN, CATCH_SKIN").replace("SURFACE TO SURFACE", "NODE TO SURFACE")
    path = solve(run, tmp_path, "corner", snap_hook(contact, 0.05, 6.8, 1))
    with h5py.File(path) as file:
        m = int(file["VTKHDF/NumberOfPoints"][-1])
        is_root = np.abs(np.asarray(file["VTKHDF/Points"])[-m:, 0]) < 1e-9
        force = np.asarray(file["VTKHDF/PointData/RF"]).reshape(-1, m, 3)[:, is_root].sum(axis=1)
    push, across = force[:, 0], -force[:, 1]
    assert across.max() > 0.5  # it was bent
    assert np.all(push <= np.tan(np.radians(40)) * across + 1e-6 * across.max())


def test_snap_hook_by_either_slave(run: Run, tmp_path: Path) -> None:
    """The sides of a hook are no sheet: behind its back flank and behind its top, which end at an inclined side, nodes of the catch lie
    beyond the hook and do not touch it. By nodes the catch may be the slave, too: the hook passes, and is bent by the same force within
    a tenth, which is what the chords of this mesh of four elements along the catch differ by.
    """
    bent = []
    for k, surfaces in enumerate(("HOOK_SKIN, CATCH_SKIN", "CATCH_SKIN, HOOK_SKIN")):
        contact = by_hand(0.0, surfaces).replace("SURFACE TO SURFACE", "NODE TO SURFACE")
        path = solve(run, tmp_path, f"slave{k}", snap_hook(contact, 0.05, 6.8, 1))
        with h5py.File(path) as file:
            m = int(file["VTKHDF/NumberOfPoints"][-1])
            is_root = np.abs(np.asarray(file["VTKHDF/Points"])[-m:, 0]) < 1e-9
            bent.append(-np.asarray(file["VTKHDF/PointData/RF"]).reshape(-1, m, 3)[:, is_root, 1].sum(axis=1))
        assert np.abs(at_the_end(path, "RF")).max() <= 1e-9 * bent[-1].max(), "behind the catch no force is left"
    assert bent[0].max() > 0.5
    assert bent[1].max() == pytest.approx(bent[0].max(), rel=0.1)
