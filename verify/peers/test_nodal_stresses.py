"""Displacements and stresses at the nodes into which shells and beams expand, in the calculix dialect, against CalculiX itself (ccx).

All decks of ../shared/decks/shells (see test_static_decks), and strips and cantilevers of each element and section: each field of the .frd
files within 1 % of its largest value, node by node. Nodes are paired by their places; of several at one place the nearest value counts.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from verify.decks.beams import beam, box, circle, pipe, rectangle
from verify.decks.shells import section, shell
from verify.peers.conftest import AGREES
from verify.peers.test_mixed_decks import CCX, run_both
from verify.peers.test_static_decks import DECKS
from verify.readers.dat_frd_files import read_frd, read_frd_places

pytestmark = pytest.mark.skipif(CCX is None, reason="CalculiX (ccx) is not installed")

RunDeck = Callable[..., subprocess.CompletedProcess[str]]
FILES = sorted((DECKS / "shells").glob("*.inp"))
REQUESTS = "*NODE FILE, OUTPUT=3D\nU\n*EL FILE\nS\n"
NOISE = 1e-12  #: of the modulus: stresses of nothing but rounding
ROUNDED = {"solidshell1": "moved as a rigid body: its stresses are rounding"}


def with_requests(deck: str) -> str:
    """The deck with the fields of all expanded nodes in its .frd file, and without its own requests."""
    deck = re.sub(r"^\*(NODE|EL)\s+(FILE|OUTPUT)[^\n]*\n(?:(?!\*)[^\n]*\n)*", "", deck, flags=re.M | re.I)
    return re.sub(r"^\*END\s+STEP", REQUESTS + "*END STEP", deck, flags=re.M | re.I)


def fields(path: Path) -> tuple[list[tuple[str, float, np.ndarray]], np.ndarray]:
    """Fields by name and time, in the order of the nodes, and the places of these."""
    places = read_frd_places(path)
    blocks = [b for b in read_frd(path) if b.title in ("DISP", "STRESS")]
    missing = [np.nan] * 6
    rows = [(b.title, b.time, np.array([[*b.rows.get((k,), missing), *missing][:6] for k in places])) for b in blocks]
    return rows, np.array(list(places.values()))


def compare(run_deck: RunDeck, folder: Path, deck: str, only: tuple[str, ...] = ("DISP", "STRESS")) -> None:
    """Runs both and compares all fields of both."""
    deck = with_requests(deck)
    run_both(run_deck, folder, deck)
    ours, places = fields(folder / "job.frd")
    theirs, wanted = fields(folder / "ccx" / "job.frd")
    near = [np.flatnonzero(np.abs(places - x).max(axis=1) < 2e-5 * np.ptp(wanted, axis=0).max()) for x in wanted]
    assert all(len(nodes) > 0 for nodes in near), "all of its nodes are here"
    n = 0
    for name, time, values in theirs:
        if name not in only:
            continue
        _, _, mine = min((f for f in ours if f[0] == name), key=lambda f: abs(f[1] - time))
        largest = np.nanmax(np.abs(values))
        m = 3 if name == "DISP" else 6
        differ = [np.abs(mine[nodes, :m] - row[:m]).max(axis=1).min() for nodes, row in zip(near, values, strict=True) if not np.isnan(row[0])]
        assert np.max(differ) <= AGREES * largest, f"{name} at {time:g}: {100 * np.max(differ) / largest:.3g} % of {largest:.4g}"
        n += 1
    assert n >= len(only)


@pytest.mark.skipif(not FILES, reason=f"no decks in {DECKS}")
@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_decks_of_shells_and_beams(run_deck: RunDeck, tmp_path: Path, path: Path) -> None:
    """CalculiX's own decks."""
    compare(run_deck, tmp_path, path.read_text(errors="replace"), ("DISP",) if path.stem in ROUNDED else ("DISP", "STRESS"))


LOADS = {"force": "*CLOAD\nEND, 3, -.5\n", "turn": "*CLOAD\nEND, 4, 1.\nEND, 5, 1.\nEND, 6, 2.\n", "heat": "*TEMPERATURE\nN, 100., 20.\n",
         "weight": "*DLOAD\nE, GRAV, .1, 0., 0., -1.\n", "line": "*DLOAD\nE, P1, .01\nE, P2, .02\n"}  # fmt: skip


def loaded(load: str, more: str = "") -> str:
    """Temperatures from zero, and one step."""
    return f"*INITIAL CONDITIONS, TYPE=TEMPERATURE\nN, 0.\n*STEP{more}\n*STATIC\n{LOADS[load]}*END STEP\n"


def expanding(deck: str) -> str:
    """The deck with an expansion of its material."""
    return re.sub(r"(\*ELASTIC\n[^\n]*\n)", r"\1*EXPANSION\n1e-5\n", deck)


@pytest.mark.parametrize("load", ["force", "heat", "weight"])
@pytest.mark.parametrize(("kind", "is_curved"), [
    *((kind, False) for kind in ("S3", "S4", "S4R", "S6", "S8", "S8R")), *((kind, True) for kind in ("S3", "S6", "S8", "S8R"))])
def test_strips(run_deck: RunDeck, tmp_path: Path, kind: str, is_curved: bool, load: str) -> None:
    """Strips that are clamped at one end. Solids of S4 and S4R on curved shells are left out: they are skew, which CalculiX 2.20 integrates in another way
    (doc/manual/from_calculix.md).
    """
    body = shell(kind, (4, 2), lambda u, v: (10 * np.sin(u), 4 * v, 10 - 10 * np.cos(u)) if is_curved else (10 * u, 4 * v, 0 * u))
    sets = "".join(f"*NSET, NSET={name}\n" + "".join(f"{i + 1}\n" for i in body.where(0, u)) for name, u in (("ROOT", 0.0), ("END", 1.0)))
    deck = body.cards() + sets + section(2.1e5, 0.3, 0.4, 1.0) + "*BOUNDARY\nROOT, 1, 6\n"
    compare(run_deck, tmp_path, expanding(deck) + loaded(load))


SECTIONS = {"rect": (rectangle(0.4, 0.6), ""), "circ": (circle(0.3), ".6, .6"), "pipe": (pipe(0.3, 0.05), ""), "box": (box(0.6, 0.4, (0.02, 0.04, 0.03, 0.02)), "")}
BEAMS = [("B31", "rect"), ("B31R", "rect"), ("B32", "rect"), ("B32", "circ"), ("B32R", "rect"), ("B32R", "circ"), ("B32R", "pipe"), ("B32R", "box")]


@pytest.mark.parametrize("load", ["force", "turn", "weight", "line"])
@pytest.mark.parametrize(("kind", "name"), BEAMS)
def test_cantilevers(run_deck: RunDeck, tmp_path: Path, kind: str, name: str, load: str) -> None:
    """Bent, twisted, under their weight, and under forces per length along both directions of the section. B31R has one point, at which bending leaves no stress."""
    deck = beam(kind, *SECTIONS[name], n=4) + "*BOUNDARY\n1, 1, 6\n"
    compare(run_deck, tmp_path, deck + loaded(load), ("DISP",) if kind == "B31R" else ("DISP", "STRESS"))
