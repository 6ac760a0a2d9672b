"""Composite shells of the calculix dialect against CalculiX itself (ccx), where it is installed: displacements, stresses and strains
of all points of all layers.

Both programs have one solid for all layers: a parabola through the thickness, two points over each layer. S6 agrees to rounding,
S8R to its stabilization of 1e-5 of the stiffness across the thickness, which CalculiX has not: it counts most where a layer is soft.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from verify.decks.shells import Shell, held, shell
from verify.peers.test_mixed_decks import tables_by_both
from verify.readers.dat_frd_files import compare_block

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

Floats = npt.NDArray[np.float64]
Place = Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]

#: Of the largest value of a block: .dat files have seven digits; CalculiX stops at 1e-9 of the forces.
ALLOWED = {"S6": {"displacements": 1e-6, "stresses": 1e-6, "strains": 1e-6}, "S8R": {"displacements": 1e-5, "stresses": 5e-5, "strains": 2e-4}}
ISOTROPIC = """*MATERIAL, NAME=HARD
*ELASTIC
210000., .3
*EXPANSION
1.2e-5
*DENSITY
7.8e-6
*MATERIAL, NAME=SOFT
*ELASTIC
1000., .3
*DENSITY
1.e-6
*MATERIAL, NAME=MEDIUM
*ELASTIC
20000., .2
*EXPANSION
3.e-5
*DENSITY
2.e-6
"""
ORTHOTROPIC = """*MATERIAL, NAME=M
*ELASTIC, TYPE=ENGINEERING CONSTANTS
250000., 10000., 8000., .25, .3, .2, 5000., 4000.
2000.
*ORIENTATION, NAME=O0
1., 0., 0., 0., 1., 0.
*ORIENTATION, NAME=O90
0., 1., 0., -1., 0., 0.
*ORIENTATION, NAME=O45
1., 1., 0., -1., 1., 0.
"""
CRACKED = """*MATERIAL, NAME=COMPRESSION_ONLY
*USER MATERIAL, CONSTANTS=2
1.4e4, 1e-2
*DENSITY
2.35e-6
*MATERIAL, NAME=STEEL
*ELASTIC
2.1e5, 0.3
*DENSITY
7.8e-6
"""
THREE = ISOTROPIC + "*SHELL SECTION, ELSET=E, COMPOSITE{more}\n.1, , HARD\n.5, , SOFT\n.2, , MEDIUM\n"
PLIES = ORTHOTROPIC + "*SHELL SECTION, ELSET=E, COMPOSITE\n.05, , M, O45\n.2, , M, O90\n.1, , M, O0\n"
DECK = CRACKED + "*SHELL SECTION, ELSET=E, COMPOSITE\n.3, , COMPRESSION_ONLY\n.04, , STEEL\n.46, , COMPRESSION_ONLY\n"
PLASTIC = THREE.replace("210000., .3\n", "210000., .3\n*PLASTIC\n30., 0.\n60., .01\n")
CONTROLS = "*CONTROLS, PARAMETERS=FIELD\n1.e-9, 1.e-9\n*STATIC\n"
LINEAR = "*STEP\n*STATIC\n"
STEPWISE = f"*STEP, INC=1000\n{CONTROLS}.5, 1., , .5\n"
LARGE = f"*STEP, NLGEOM, INC=1000\n{CONTROLS}.5, 1., , .5\n"
GRAVITY = "*DLOAD\nE, GRAV, 9810., 0., .6, -.8\n"
PRESSURE = "*DLOAD\nE, P, .001\n"


def flat(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """A skew plate."""
    return 10 * u, 2 * v + 0.3 * u * v, 0 * u


def roof(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """A part of a cylinder."""
    return 10 * np.sin(0.7 * u), 12 * v, 10 * np.cos(0.7 * u)


def bend(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Two plates at a right angle: knots, where they meet."""
    return np.minimum(20 * u, 10), 4 * v, np.maximum(12 * (u - 0.5), 0)


def end_load(body: Shell, dof: int, total: float) -> str:
    """A force or moment on the end u = 1."""
    return "*CLOAD\n" + "".join(f"{i + 1}, {dof}, {total * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())


#: Name: shape, cells, section, step, load.
CASES: dict[str, tuple[Place, tuple[int, int], str, str, Callable[[Shell], str]]] = {
    "cantilever": (flat, (6, 2), THREE.format(more=""), LINEAR, lambda body: end_load(body, 3, 0.5)),
    "cantilever-large": (flat, (6, 2), THREE.format(more=""), LARGE, lambda body: end_load(body, 3, 5.0)),
    "offset-moment": (flat, (6, 2), THREE.format(more=", OFFSET=.3"), LINEAR, lambda body: end_load(body, 5, 2.0)),
    "gravity": (flat, (6, 2), THREE.format(more=""), LINEAR, lambda _: GRAVITY),
    "edge-load": (flat, (6, 2), THREE.format(more=""), LINEAR, lambda _: "*DLOAD\nE, EDNOR2, .01\n"),
    "warm": (flat, (6, 2), THREE.format(more=""), LINEAR, lambda _: "*TEMPERATURE\nN, 100.\n"),
    "displaced": (flat, (6, 2), THREE.format(more=""), LINEAR, lambda body: held(body.where(0, 1.0), "3, 3, -.05") + held(body.where(0, 1.0), "1, 1, .001")),
    "turned": (flat, (6, 2), THREE.format(more=""), LINEAR, lambda body: held(body.where(0, 1.0), "5, 5, .02")),
    "roof": (roof, (6, 6), THREE.format(more=", OFFSET=-.5"), LINEAR, lambda _: GRAVITY + PRESSURE),
    "roof-large": (roof, (6, 6), THREE.format(more=""), LARGE, lambda _: GRAVITY + "*DLOAD\nE, P, .01\n"),
    "corner": (bend, (6, 2), THREE.format(more=""), LINEAR, lambda body: end_load(body, 1, -0.05)),
    "corner-large": (bend, (6, 2), THREE.format(more=""), LARGE, lambda body: end_load(body, 1, -1.5)),
    "plies": (flat, (6, 2), PLIES, LINEAR, lambda body: end_load(body, 3, 0.5)),
    "plies-large": (flat, (6, 2), PLIES, LARGE, lambda body: end_load(body, 3, 15.0)),
    "plies-roof": (roof, (6, 6), PLIES, LINEAR, lambda _: PRESSURE),
    "cracked": (flat, (6, 2), DECK, f"*STEP, INC=1000\n{CONTROLS}1., 1.\n", lambda _: "*DLOAD\nE, GRAV, 9810., 0., 0., -1.\n"),
    "plastic": (flat, (6, 2), PLASTIC.format(more=""), STEPWISE, lambda body: end_load(body, 3, 1.5)),
}  # fmt: skip


def compare_with_peer(run_deck: Callable[..., subprocess.CompletedProcess[str]], folder: Path, deck: str, allowed: dict[str, float]) -> None:
    """Every table of .dat, row by row."""
    ours, theirs = tables_by_both(run_deck, folder, deck)
    assert [(b.title, b.time) for b in ours] == [(b.title, b.time) for b in theirs] and ours
    for mine, reference in zip(ours, theirs, strict=True):
        assert mine.rows.keys() == reference.rows.keys(), f"{reference.title}: elements and points are counted otherwise"
        found = compare_block(mine, reference)
        assert found.deviation <= allowed.get(reference.title, 1e-6), f"{reference.title} at {reference.time}, {found.where}: {found.deviation:.2g}"


@pytest.mark.parametrize("kind", ["S8R", "S6"])
@pytest.mark.parametrize("name", CASES)
def test_layers(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, name: str, kind: str) -> None:
    """Displacements, and stresses and strains in all layers."""
    place, cells, section, step, load = CASES[name]
    body = shell(kind, cells, place)
    deck = body.cards() + section + held(body.where(0, 0.0), "1, 6")
    if name == "warm":
        deck += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nN, 0.\n"
    deck += step + load(body) + "*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS, E\n*EL PRINT, ELSET=E, TOTALS=YES\nEVOL\n*END STEP\n"
    allowed = ALLOWED[kind]
    if name == "plastic":
        allowed = {title: 5 * share for title, share in allowed.items()}  # the stabilization stays elastic
    compare_with_peer(run_deck, tmp_path, deck, allowed)


@pytest.mark.parametrize("kind", ["S8R", "S6"])
@pytest.mark.parametrize("other", ["MATERIAL=HARD\n.8\n", "COMPOSITE\n.4, , MEDIUM\n.4, , HARD\n", "COMPOSITE\n.1, , HARD\n.5, , SOFT\n"])
def test_other_layers_beside(run_deck: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, kind: str, other: str) -> None:
    """Elements of equal thickness share their nodes, whatever their layers; a step of the thickness is a knot."""
    body = shell(kind, (6, 2), lambda u, v: (18 * u, 4 * v, 0 * u))
    half = [e + 1 for e, nodes in enumerate(body.elements) if body.uv[nodes, 0].mean() > 0.5]
    sets = "*ELSET, ELSET=RIGHT\n" + "".join(f"{e},\n" for e in half)
    sets += "*ELSET, ELSET=LEFT\n" + "".join(f"{e + 1},\n" for e in range(len(body.elements)) if e + 1 not in half)
    sections = THREE.format(more="").replace("ELSET=E", "ELSET=LEFT") + f"*SHELL SECTION, ELSET=RIGHT, {other}"
    deck = body.cards() + sets + sections + held(body.where(0, 0.0), "1, 6") + LINEAR + end_load(body, 3, -0.1)
    deck += "*NODE PRINT, NSET=N\nU\n*EL PRINT, ELSET=E\nS, E\n*END STEP\n"
    allowed = {title: 3 * share for title, share in ALLOWED[kind].items()}  # a jump of the thickness strains beside it
    compare_with_peer(run_deck, tmp_path, deck, allowed)
