"""UMAT for the plane stress of shells, called above *TRANSVERSE SHEAR STIFFNESS as Abaqus calls it.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.conftest import Run
from verify.decks.shells import Shell, held, shell
from verify.library.common import ROOT
from verify.readers.dat_frd_files import read_dat

ROUTINE = ROOT / "verify" / "library" / "routines" / "plane_stress.f90"
KINDS = ["S3", "S4", "S4R", "S6", "S8", "S8R"]
E, NU, THICK, LENGTH, WIDTH = 1000.0, 0.3, 0.5, 10.0, 2.0
YIELD, HARDENING = 2.0, 50.0
SHEAR = 5 / 6 * E / (2 * (1 + NU)) * THICK
CARD = f"*TRANSVERSE SHEAR STIFFNESS\n{SHEAR:.15g}, {SHEAR:.15g}, 0.\n"
ELASTIC = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n"
USER = f"*MATERIAL, NAME=M\n*USER MATERIAL, CONSTANTS=2\n{E}, {NU}\n"
FLOWS = f"*MATERIAL, NAME=M\n*USER MATERIAL, CONSTANTS=4\n{E}, {NU}, {YIELD}, {HARDENING}\n*DEPVAR\n1\n"


def section(law: str, card: str = CARD, more: str = "") -> str:
    """MATERIAL and SHELL SECTION."""
    return f"{law}*SHELL SECTION, ELSET=E, MATERIAL=M{more}\n{THICK}\n{card}"


def strip(kind: str, cells: tuple[int, int] = (10, 2), skew: float = 0.0) -> Shell:
    """A strip along x, half as many quadratic cells as linear ones; skew ones with a length."""
    if kind[1] in "68":
        cells = (cells[0] // 2, cells[1] // 2)
    return shell(kind, cells, lambda u, v: (LENGTH * u + skew * v * np.sin(np.pi * u), WIDTH * v, 0 * u))


def solve(run: Run, folder: Path, deck: str, name: str, *options: str) -> Path:
    """Runs a deck; its result file."""
    (folder / f"{name}.inp").write_text(deck)
    done = run([name, *options], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / f"{name}.vtkhdf"


def displacements(folder: Path, name: str) -> np.ndarray:
    """Displacements of the nodes of the shell at the end."""
    return np.array([row[:3] for row in read_dat(folder / f"{name}.dat")[-1].rows.values()])


def cantilever(body: Shell, loads: str, *, nlgeom: bool) -> str:
    """A deck with a blank for MATERIAL and section, whose edge at 0 is clamped."""
    step = f"*STEP{', NLGEOM' if nlgeom else ''}\n*STATIC\n0.25, 1.\n*CLOAD\n{loads}*NODE PRINT, NSET=N, FREQUENCY=100\nU\n*END STEP\n"
    return f"{body.cards()}{{}}{held(body.where(0, 0.0), 'ENCASTRE')}{step}"


@pytest.mark.parametrize("nlgeom", [False, True], ids=["linear", "nlgeom"])
@pytest.mark.parametrize("kind", KINDS)
def test_elastic(run: Run, tmp_path: Path, kind: str, nlgeom: bool) -> None:
    """The elastic law is that of *ELASTIC in a cantilever that is bent in and out of its plane, pulled and twisted, at large
    displacements, too. The clamp holds the thickness, which moves with the strain in the plane of *ELASTIC alone; the volume changes."""
    body = strip(kind, skew=0.2)
    edge = body.edge_weights(0, 1.0)
    cases = {"bend": (3, 0.3 if nlgeom else 1e-3), "pull": (1, 0.5), "plane": (2, 0.1), "twist": (0, 0.02)}
    for name, (direction, force) in cases.items():
        loads = "".join(f"{i + 1}, {direction}, {force * w:.15g}\n" for i, w in edge.items())
        if name == "twist":
            loads = f"{body.at(1, 1) + 1}, 3, {force}\n{body.at(1, 0) + 1}, 3, {-force}\n"
        deck = cantilever(body, loads, nlgeom=nlgeom)
        solve(run, tmp_path, deck.format(section(ELASTIC)), "ours")
        solve(run, tmp_path, deck.format(section(USER)), "theirs", f"user={ROUTINE}")
        ours, theirs = displacements(tmp_path, "ours"), displacements(tmp_path, "theirs")
        if kind == "S3" and name in ("plane", "pull"):
            continue  # *ELASTIC is held by the one thickness of a node there: see the next test
        assert np.abs(ours - theirs).max() <= (5e-3 if kind[1] in "68" else 1e-3) * np.abs(ours).max() > 0, name


@pytest.mark.parametrize("direction", [1, 2])
def test_membrane_of_triangles(run: Run, tmp_path: Path, direction: int) -> None:
    """S3 moves in its plane as CPS3 does: each point is in plane stress, although the thickness of a node is one for its triangles."""
    body = strip("S3", skew=0.2)
    loads = "".join(f"{i + 1}, {direction}, {0.1 * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    solve(run, tmp_path, cantilever(body, loads, nlgeom=False).format(section(USER)), "shell", f"user={ROUTINE}")
    plane = cantilever(body, loads, nlgeom=False).format(f"{ELASTIC}*SOLID SECTION, ELSET=E, MATERIAL=M\n{THICK}\n")
    solve(run, tmp_path, plane.replace("S3", "CPS3").replace("ENCASTRE", "1, 2"), "plane")
    ours, theirs = displacements(tmp_path, "shell")[:, :2], displacements(tmp_path, "plane")[:, :2]
    assert np.abs(ours - theirs).max() <= 1e-6 * np.abs(theirs).max(), "digits of the .dat file"


def pulled(kind: str, law: str, ends: tuple[float, ...], *, nlgeom: bool, card: str = CARD, more: str = "") -> str:
    """A strip in uniaxial tension along x, whose end moves by given lengths in steps of 20 increments; reactions of that end, SDV."""
    body = strip(kind)
    corner, end = body.at(0, 0) + 1, body.where(0, 1.0)
    fixed = held(body.where(0, 0.0), "1") + f"{corner}, 2\n" + held(list(range(len(body.nodes))), "3, 5").replace("*BOUNDARY\n", "")
    deck = f"{body.cards()}*NSET, NSET=END\n" + "".join(f"{i + 1}\n" for i in end) + section(law, card, more) + fixed
    for u in ends:
        deck += f"*STEP{', NLGEOM' if nlgeom else ''}\n*STATIC\n0.05, 1., 0.05, 0.05\n*BOUNDARY\nEND, 1, 1, {u}\n"
        deck += "*NODE PRINT, NSET=END, TOTALS=ONLY, FREQUENCY=100\nRF\n" + ("*EL PRINT, ELSET=E, FREQUENCY=100\nSDV\n" if "DEPVAR" in law else "")
        deck += "*END STEP\n"
    return deck


def forces(folder: Path) -> list[float]:
    """Total reactions along x, step by step."""
    return [float(next(iter(block.rows.values()))[0]) for block in read_dat(folder / "job.dat") if "force" in block.title.lower()]


@pytest.mark.parametrize("kind", KINDS)
def test_finite_tension(run: Run, tmp_path: Path, kind: str) -> None:
    """The stress E ln(l) acts on the area of constant volume: F = E ln(l) A/l at 1.5 times the length."""
    solve(run, tmp_path, pulled(kind, USER, (0.5 * LENGTH,), nlgeom=True), "job", f"user={ROUTINE}")
    expected = E * np.log(1.5) * WIDTH * THICK / 1.5
    assert forces(tmp_path)[-1] == pytest.approx(expected, rel=2e-4), "the increments of strain of Hughes and Winget: 3e-5"


@pytest.mark.parametrize("kind", KINDS)
def test_plastic_tension(run: Run, tmp_path: Path, kind: str) -> None:
    """Plasticity in plane stress, loaded and unloaded: sigma = (E H e + E Y)/(E + H), then back by E; STATEV is the plastic strain."""
    solve(run, tmp_path, pulled(kind, FLOWS, (0.01 * LENGTH, 0.009 * LENGTH), nlgeom=False), "job", f"user={ROUTINE}")
    plastic = (E * 0.01 - YIELD) / (E + HARDENING)
    stress = YIELD + HARDENING * plastic
    found = forces(tmp_path)
    assert found[0] == pytest.approx(stress * WIDTH * THICK, rel=1e-6)
    assert found[1] == pytest.approx((stress - E * 0.001) * WIDTH * THICK, rel=1e-6)
    state = [float(x) for block in read_dat(tmp_path / "job.dat") if "force" not in block.title.lower() for row in block.rows.values() for x in row[-1:]]
    assert np.abs(np.array(state) - plastic).max() <= 1e-6 * plastic


@pytest.mark.parametrize("kind", ["S4", "S6", "S8", "S8R"])
def test_plastic_bending(run: Run, tmp_path: Path, kind: str) -> None:
    """A strip bent far beyond yield at large displacements: the reactions of *PLASTIC in solids, within 1.5 %; few iterations, so the
    tangent is right."""
    body = strip(kind, (20, 4))
    end = body.where(0, 1.0)
    deck = f"{body.cards()}*NSET, NSET=END\n" + "".join(f"{i + 1}\n" for i in end) + "{}" + held(body.where(0, 0.0), "ENCASTRE")
    deck += "*STEP, NLGEOM\n*STATIC\n0.1, 1., 0.1, 0.1\n*BOUNDARY\nEND, 3, 3, 1.5\n*NODE PRINT, NSET=END, TOTALS=ONLY\nRF\n*END STEP\n"
    plastic = f"{ELASTIC}*PLASTIC\n{YIELD}, 0.\n{YIELD + HARDENING}, 1.\n"
    found = []
    for law, options in ((section(plastic, ""), ()), (section(FLOWS), (f"user={ROUTINE}",))):
        solve(run, tmp_path, deck.format(law), "job", *options)
        found.append([float(next(iter(block.rows.values()))[2]) for block in read_dat(tmp_path / "job.dat")])
    assert np.array(found[1]) == pytest.approx(np.array(found[0]), rel=0.015)
    elastic = 3 * E * WIDTH * THICK**3 / 12 / LENGTH**3 * 1.5
    assert found[1][-1] < 0.7 * elastic, "the clamp flows"
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert max(file["AMONTONS/history/n_iterations"][:]) <= 7


@pytest.mark.parametrize(
    ("law", "kind", "more", "words"),
    [
        (USER.replace("CONSTANTS", "SPATIAL, CONSTANTS"), "S4", "", "is by UMAT in space"),
        (USER, "SAX1", "", "SAX1 and SAX2 of a *USER MATERIAL take no"),
        (USER, "S4", "COMPOSITE", "all have the same material and angle"),
    ],
)
def test_refused(run_deck: Run, law: str, kind: str, more: str, words: str) -> None:
    """What has no plane stress, or layers whose shear moduli are not known."""
    body = strip("S4") if kind == "S4" else None
    mesh = body.cards() if body else f"*NODE, NSET=N\n1, 0., 0.\n2, 1., 0.\n*ELEMENT, TYPE={kind}, ELSET=E\n1, 1, 2\n"
    rows = f"{law}*SHELL SECTION, ELSET=E, COMPOSITE\n0.1, , M, 0.\n0.1, , M, 90.\n{CARD}" if more else section(law)
    done = run_deck(f"{mesh}{rows}*BOUNDARY\n1, ENCASTRE\n*STEP\n*STATIC\n*CLOAD\n2, 2, 1.\n*END STEP\n", f"user={ROUTINE}")
    assert done.returncode == 3, done.stdout
    assert words in " ".join((done.stdout + done.stderr).split())


def test_layers_of_one_law(run: Run, tmp_path: Path) -> None:
    """Two layers of one material and angle bend as the whole shell; no note says that the routine is called in space."""
    body = strip("S4")
    loads = "".join(f"{i + 1}, 3, {1e-3 * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items())
    half = f"{THICK / 2}, , M, 0.\n"
    layers = f"{USER}*SHELL SECTION, ELSET=E, COMPOSITE\n{half}{half}{CARD}"
    solve(run, tmp_path, cantilever(body, loads, nlgeom=False).format(section(USER)), "whole", f"user={ROUTINE}")
    solve(run, tmp_path, cantilever(body, loads, nlgeom=False).format(layers), "layers", f"user={ROUTINE}")
    whole, parted = displacements(tmp_path, "whole"), displacements(tmp_path, "layers")
    assert np.abs(whole - parted).max() <= 0.01 * np.abs(whole).max()
    done = run(["whole", "--check", f"user={ROUTINE}"], cwd=tmp_path)
    assert "NTENS = 6" not in done.stdout + done.stderr
