"""The decks of input/ are what their generator writes, they finish, and their contact passes an independent check.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.conftest import ROOT, Run
from verify.decks import make_decks
from verify.independent.deck import Deck, read_deck
from verify.independent.element import reference_gradients
from verify.independent.results import read_field, read_history, read_results
from verify.tools import picture
from verify.tools.contact_check import check_file

INPUT = ROOT / "input"


def test_input_is_what_the_generator_writes() -> None:
    """Meshes are not edited by hand: `python -m verify.decks.make_decks` writes input/ again."""
    for name, text in make_decks.input_decks().items():
        assert (INPUT / name).read_text() == text, f"input/{name} differs from the generator's"


@pytest.mark.parametrize("path", sorted(INPUT.glob("*.inp")), ids=lambda p: p.stem)
def test_decks_teach(path: Path) -> None:
    """A deck starts with comments that say what it shows and how long it runs, and it is not large."""
    text = path.read_text()
    head = [line for line in text.splitlines()[:12] if line.startswith("**")]
    assert len(head) >= 3
    assert any(word in " ".join(head) for word in ("second", "minute", "moment"))
    assert len(text) < 500_000


@pytest.mark.parametrize("n", [8, 10, 11, 14, 20])
def test_block_meshes(n: int) -> None:
    """The benchmark's blocks: about 6.7 n^3 unknowns, valid elements, no slave node on an edge of a master facet."""
    mesh = make_decks.block_mesh(n)
    assert make_decks.corner_volumes(mesh).min() > 0
    assert 0.9 < 3 * len(mesh.nodes) / (6.7 * n**3) < 1.6
    slaves, masters = mesh.node_sets["UPPER_BOTTOM"], mesh.node_sets["LOWER_TOP"]
    for axis in (0, 1):
        apart = mesh.nodes[slaves, axis][:, None] - mesh.nodes[masters, axis][None]
        assert np.abs(apart).min() > 1e-6
    assert mesh.nodes[slaves, 2] == pytest.approx(0) and mesh.nodes[masters, 2] == pytest.approx(0)


def test_octant_mesh_is_sound() -> None:
    """Volume of the octant between that of the ball and of its chords; elements valid; the pole in the origin."""
    lateral = np.linspace(0, 1, 9)
    ball = make_decks.ball_octant(2.0, lateral, 4, np.linspace(0, 1, 4), "BALL")
    assert make_decks.corner_volumes(ball).min() > 0
    kernel = reference_gradients(ball.nodes[ball.elements])[1].sum()
    assert 0.98 < kernel / (np.pi * 2.0**3 / 6) < 1.0
    assert np.linalg.norm(ball.nodes, axis=1).min() < 1e-12
    assert np.abs(ball.nodes[ball.node_sets["BALL_EQUATOR"], 2] - 2.0).max() < 1e-12


def solved(run: Run, name: str, folder: Path) -> tuple[Path, Deck]:
    """Runs a deck of input/ that has to finish; the result file and the deck's facts."""
    deck = INPUT / f"{name}.inp"
    done = run(["--quiet", "--outdir", folder, deck], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / f"{name}.vtkhdf", read_deck(deck.read_text(), INPUT)


def assert_contact_holds(path: Path) -> None:
    """The independent check finds nothing."""
    failures = [f"t = {c.time:.4g}: {failure}" for c in check_file(path) for failure in c.failures]
    assert not failures, "\n".join(failures)


def sums(path: Path, deck: Deck) -> tuple[np.ndarray, np.ndarray]:
    """(n_frames, 3) normal and tangential contact force, summed over the slave nodes."""
    slaves = deck.surface_nodes(deck.pairs[0].slave)
    return read_field(path, "CNORMF")[:, slaves].sum(axis=1), read_field(path, "CSHEARF")[:, slaves].sum(axis=1)


def test_three_cubes(run: Run, tmp_path: Path) -> None:
    """The cube sticks first and slides in the end, with friction mu N against the drag."""
    path, deck = solved(run, "three_cubes", tmp_path)
    assert_contact_holds(path)
    normal, shear = sums(path, deck)
    status = read_field(path, "CSTATUS")[:, deck.surface_nodes(deck.pairs[0].slave)]
    times = read_results(path).times
    assert (status[np.argmin(np.abs(times - 1.1))] == 1).any()
    assert (status[-1] == 2).all()
    assert shear[-1, 0] == pytest.approx(-0.3 * normal[-1, 2], rel=1e-2)


def test_a_picture_is_drawn(run: Run, tmp_path: Path) -> None:
    """Without a display, from a result file of the program."""
    path, _ = solved(run, "three_cubes", tmp_path)
    assert picture.main([str(path), "--output", str(tmp_path / "job.png"), "--increment", "12"]) == 0
    assert (tmp_path / "job.png").stat().st_size > 20_000
    assert picture.main([str(path), "--increment", "500"]) == 2


@pytest.mark.slow
def test_hertz_octant(run: Run, tmp_path: Path) -> None:
    """Hertz (1882) for the force found: pressure within 1 % of p0 over the inner half, edge within one element.

    The force itself is up to 10 % above the closed form of the approach, because the equator is not far away.
    """
    path, deck = solved(run, "hertz_octant", tmp_path)
    assert_contact_holds(path)
    radius, press, modulus = 50.0, 0.5, 20000 / (1 - 0.3**2)
    equator = deck.node_sets["BALL_EQUATOR"]
    force = -4 * read_field(path, "RF")[-1, equator, 2].sum()
    assert 1.0 < force / (4 / 3 * modulus * np.sqrt(radius) * press**1.5) < 1.1
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    p0 = 3 * force / (2 * np.pi * a**2)
    slaves = deck.surface_nodes(deck.pairs[0].slave)
    r = np.linalg.norm(deck.nodes[slaves, :2], axis=1)
    pressure = read_field(path, "CPRESS")[-1, slaves]
    inner = r < 0.5 * a
    assert np.abs(pressure[inner] - p0 * np.sqrt(1 - (r[inner] / a) ** 2)).max() < 0.01 * p0
    assert r[pressure > 0].max() == pytest.approx(a, abs=0.75)


@pytest.mark.slow
def test_ironing(run: Run, tmp_path: Path) -> None:
    """Twenty-seven facets of sliding: contact holds throughout; in steady sliding the force ripples less than 10 %."""
    path, deck = solved(run, "ironing", tmp_path)
    assert_contact_holds(path)
    normal, shear = sums(path, deck)
    times = read_results(path).times
    assert times[-1] == pytest.approx(2.0)
    steady = (times > 1.3) & (times < 1.9)
    force = normal[steady] + shear[steady]
    assert np.ptp(force[:, 2]) < 0.1 * force[:, 2].mean()
    assert 0.3 * 0.9 < (-force[:, 0] / force[:, 2]).mean() < 0.6


def test_history_has_the_same_times(run: Run, tmp_path: Path) -> None:
    """The rows of /AMONTONS/history that have a frame are those of the fields."""
    path, _ = solved(run, "three_cubes", tmp_path)
    history, results = read_history(path), read_results(path)
    frames = history["frame"] >= 0
    assert np.allclose(history["total_time"][frames], results.times[history["frame"][frames]])
