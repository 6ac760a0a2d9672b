"""Routines of the user: compiled and loaded, called with the arguments of Abaqus, equal to what our own cards give.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import signal
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

import amontons
from verify.conftest import Run
from verify.library.common import ROOT, same_results
from verify.readers.sta_cvg_files import read_cvg

ROUTINES = ROOT / "verify" / "library" / "routines"
USAGE, INPUT, SETUP, NOT_CONVERGED, IO = 2, 3, 4, 5, 7

PLASTIC = "*ELASTIC\n210000., 0.3\n*PLASTIC\n200., 0.\n2200., 1.\n"
J2 = "*USER MATERIAL, CONSTANTS=4\n210000., 0.3, 200., 2000.\n*DEPVAR\n1\n1, PEEQ, equivalent plastic strain\n"
RUBBER = "*HYPERELASTIC, NEO HOOKE\n0.5, 0.4\n"
USER_RUBBER = "*USER MATERIAL, CONSTANTS=2\n0.5, 0.4\n"
STRETCH = np.array([0.001, -0.0003, -0.0003])


def solid_deck(kind: str, material: str, *, nlgeom: bool = False, top: tuple[float, float] = (0.01, -0.006)) -> str:
    """A skew block of one kind of element, sheared and pressed, then unloaded by half."""
    from verify.decks import make_decks, solids

    n = 2 if kind in ("C3D8", "C3D8R") else 1
    ticks = np.linspace(0.0, 1.0, n + 1)
    body = solids.as_kind(make_decks.block(ticks, ticks, 1.3 * ticks, "BODY"), kind)
    nodes = body.nodes.copy()
    nodes[:, 2] += 0.05 * nodes[:, 0] * nodes[:, 1]
    bottom = np.flatnonzero(body.nodes[:, 2] < 1e-9) + 1
    upper = np.flatnonzero(body.nodes[:, 2] > 1.3 - 1e-9) + 1
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i}, {x:.17g}, {y:.17g}, {z:.17g}" for i, (x, y, z) in enumerate(nodes, 1)]
    lines += [f"*ELEMENT, TYPE={kind}, ELSET=BODY"]
    for i, element in enumerate(body.elements, 1):
        words = [str(i), *(str(n + 1) for n in element)]
        lines += [", ".join(words[:16]) + ("," if len(words) > 16 else "")] + ([", ".join(words[16:])] if len(words) > 16 else [])
    return "\n".join([*lines, "*NSET, NSET=BOTTOM", *map(str, bottom), "*NSET, NSET=TOP", *map(str, upper),
                      "*MATERIAL, NAME=STUFF", material.strip(), "*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF",
                      "*BOUNDARY", "BOTTOM, 1, 3",
                      *(line for x, z in (top, (0.5 * top[0], 0.5 * top[1]))
                        for line in ("*STEP" + (", NLGEOM" if nlgeom else ""), "*STATIC", "0.25, 1.",
                                     "*BOUNDARY", f"TOP, 1, 1, {x}", f"TOP, 3, 3, {z}", "*END STEP")), ""])  # fmt: skip


def sheet_deck(kind: str, material: str) -> str:
    """Four elements in the plane, pulled and unloaded by half."""
    nodes = [f"{1 + i + 3 * j}, {1 + 0.5 * i}, {0.5 * j + 0.1 * i * j}" for j in range(3) for i in range(3)]
    corner = [1, 2, 4, 5]
    elements = [f"{k}, {c}, {c + 1}, {c + 4}, {c + 3}" for k, c in enumerate(corner, 1)]
    steps = [f"*STEP\n*STATIC\n0.25, 1.\n*BOUNDARY\n7, 2, 2, {u}\n8, 2, 2, {u}\n9, 2, 2, {u}\n*END STEP" for u in (0.004, 0.002)]
    return "\n".join(["*NODE", *nodes, f"*ELEMENT, TYPE={kind}, ELSET=BODY", *elements, "*MATERIAL, NAME=STUFF", material.strip(),
                      "*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF", "1.", "*BOUNDARY", "1, 1, 2", "2, 2, 2", "3, 2, 2",
                      *steps, ""])  # fmt: skip


def run_two(run: Run, folder: Path, ours: str, theirs: str, routines: Path) -> tuple[Path, Path]:
    """Runs a deck with our law and one with the user's; the result files."""
    (folder / "ours.inp").write_text(ours)
    (folder / "theirs.inp").write_text(theirs)
    done = run(["ours"], cwd=folder)
    assert done.returncode == 0, done.stdout
    done = run(["theirs", f"user={routines}"], cwd=folder)
    assert done.returncode == 0, done.stdout
    return folder / "ours.vtkhdf", folder / "theirs.vtkhdf"


def assert_equal(ours: Path, theirs: Path, tolerance: float) -> None:
    """Displacements, reactions, stresses and strains of all frames, relative to the largest; the same iterations."""
    with h5py.File(ours) as a, h5py.File(theirs) as b:
        for name in a["VTKHDF/PointData"]:
            if name not in ("U", "RF", "S", "E", "LE"):
                continue
            x, y = a["VTKHDF/PointData"][name][:], b["VTKHDF/PointData"][name][:]
            assert np.abs(x).max() > 0, name
            assert np.abs(x - y).max() <= tolerance * np.abs(x).max(), name
        assert a["AMONTONS/history/n_iterations"][:].tolist() == b["AMONTONS/history/n_iterations"][:].tolist()


@pytest.mark.parametrize("kind", ["C3D4", "C3D6", "C3D8", "C3D10", "C3D15", "C3D20R"])
def test_plasticity_by_umat_is_plastic(run: Run, tmp_path: Path, kind: str) -> None:
    """Radial return with linear hardening, loaded and unloaded: our PLASTIC to 1e-10, SDV1 is PEEQ; small strain, where
    both integrate the same equations exactly. (The hourglass stiffness of C3D8R follows our law, not a user's.)"""
    ours, theirs = run_two(run, tmp_path, solid_deck(kind, PLASTIC), solid_deck(kind, J2), ROUTINES / "j2.f")
    assert_equal(ours, theirs, 1e-10)
    with h5py.File(ours) as a, h5py.File(theirs) as b:
        peeq = a["AMONTONS/integration_points/PEEQ"][:].ravel()
        assert peeq.max() > 1e-3
        assert np.abs(peeq - b["AMONTONS/integration_points/SDV"][:].ravel()).max() <= 1e-10 * peeq.max()


@pytest.mark.parametrize("kind", ["CPE4", "CAX4", "CPS4", "CPE4I", "CAX4I", "CPS4I"])
def test_umat_in_the_plane(run: Run, tmp_path: Path, kind: str) -> None:
    """The same in plane strain and around an axis (NTENS = 4); in plane stress with SPATIAL, where the law is called as in space
    and the strain across is ours to find."""
    theirs = sheet_deck(kind, J2.replace("CONSTANTS", "SPATIAL, CONSTANTS") if kind.startswith("CPS") else J2)
    ours, theirs = run_two(run, tmp_path, sheet_deck(kind, PLASTIC), theirs, ROUTINES / "j2.f")
    assert_equal(ours, theirs, 1e-9 if kind.startswith("CPS") else 1e-10)


def test_umat_in_shells(run: Run, tmp_path: Path) -> None:
    """Shells and beams are solids: J2 in space serves and gives our own plasticity. Abaqus would call it for plane stress: a note says
    so, but not with SPATIAL."""
    nodes = "".join(f"{1 + i + 5 * j}, {i}., {j}., 0.\n" for j in range(2) for i in range(5))
    cells = "".join(f"{i}, {i}, {i + 1}, {i + 6}, {i + 5}\n" for i in range(1, 5))
    deck = f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE=S4, ELSET=E\n{cells}*SHELL SECTION, ELSET=E, MATERIAL=M\n0.2\n*MATERIAL, NAME=M\nLAW"
    deck += "*BOUNDARY\n1, 1, 6\n6, 1, 6\n*STEP\n*STATIC\n0.25, 1.\n*BOUNDARY\n5, 3, 3, 0.2\n10, 3, 3, 0.2\n*END STEP\n"
    ours, theirs = run_two(run, tmp_path, deck.replace("LAW", PLASTIC), deck.replace("LAW", J2), ROUTINES / "j2.f")
    with h5py.File(ours) as a, h5py.File(theirs) as b:
        x, y = a["VTKHDF/PointData/RF"][:], b["VTKHDF/PointData/RF"][:]
        assert np.abs(x - y).max() <= 1e-6 * np.abs(x).max() > 0
    for word, is_noted in (("", True), ("SPATIAL, ", False)):
        (tmp_path / "job.inp").write_text(deck.replace("LAW", J2.replace("CONSTANTS", word + "CONSTANTS")))
        done = run(["job", "--check", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
        assert ("NTENS = 6 in shells and beams" in " ".join((done.stdout + done.stderr).split())) == is_noted


COMPONENTS = {"C3D8": "3., 3.", "CPE4": "3., 1.", "CPE4R": "3., 1.", "CAX8": "3., 1.", "CPS3": "2., 1.", "CPS4": "2., 1.",
              "CPS4R": "2., 1.", "CPS8": "2., 1."}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("kind", COMPONENTS)
def test_components_of_each_element(run: Run, tmp_path: Path, kind: str) -> None:
    """A law that gets NDI and NSHR as in Abaqus, and stops if they differ: displacements, reactions and stresses are
    those of ELASTIC, in as many iterations; so the tangent, and what holds elements of one point, are right too."""
    from verify.decks import make_decks  # noqa: F401

    law = f"*USER MATERIAL, CONSTANTS=4\n70000., 0.25, {COMPONENTS[kind]}\n*DEPVAR\n2\n"
    make = solid_deck if kind == "C3D8" else plane_deck
    ours, theirs = run_two(run, tmp_path, make(kind, "*ELASTIC\n70000., 0.25\n"), make(kind, law), ROUTINES / "elastic.f")
    with h5py.File(ours) as a, h5py.File(theirs) as b:
        for name in ("U", "RF", "S"):
            x, y = a["VTKHDF/PointData"][name][:], b["VTKHDF/PointData"][name][:]
            assert np.abs(x).max() > 0, name
            assert np.abs(x - y).max() <= 1e-10 * np.abs(x).max(), name
        assert a["AMONTONS/history/n_iterations"][:].tolist() == b["AMONTONS/history/n_iterations"][:].tolist()


def plane_deck(kind: str, material: str) -> str:
    """A quarter of a square in the plane, as sheet_deck, of any kind."""
    deck = sheet_deck("CPS4" if kind.endswith(("4", "4R", "4I")) else kind, material)
    if kind.endswith(("4", "4R", "4I")):
        return deck.replace("TYPE=CPS4", f"TYPE={kind}")
    corners = {1: (1.0, 0.0), 2: (1.5, 0.0), 3: (2.0, 0.0), 4: (1.0, 0.5), 5: (1.5, 0.55), 6: (2.0, 0.6), 7: (1.0, 1.0), 8: (1.5, 1.1),
               9: (2.0, 1.2)}  # fmt: skip
    nodes, elements = dict(corners), []
    for c in (1, 2, 4, 5):
        quad = [c, c + 1, c + 4, c + 3]
        if kind.endswith("3"):
            elements += [quad[:3], [quad[0], *quad[2:]]]
            continue
        middles = []
        for i, j in zip(quad, quad[1:] + quad[:1], strict=True):
            place = tuple(0.5 * (x + y) for x, y in zip(corners[i], corners[j], strict=True))
            known = [n for n, at in nodes.items() if at == place]
            if not known:
                nodes[len(nodes) + 1] = place
            middles.append(known[0] if known else len(nodes))
        elements.append(quad + middles)
    head = ["*NODE", *(f"{n}, {x}, {y}" for n, (x, y) in nodes.items()), f"*ELEMENT, TYPE={kind}, ELSET=BODY",
            *(", ".join(map(str, [i, *e])) for i, e in enumerate(elements, 1))]  # fmt: skip
    low = [n for n, (_, y) in nodes.items() if y == 0]
    top = [n for n, (x, y) in nodes.items() if abs(y - 1 - 0.2 * (x - 1)) < 1e-12]
    steps = [f"*STEP\n*STATIC\n0.25, 1.\n*BOUNDARY\n" + "\n".join(f"{n}, 2, 2, {u}" for n in top) + "\n*END STEP" for u in (0.004, 0.002)]
    return "\n".join([*head, "*MATERIAL, NAME=STUFF", material.strip(), "*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF", "1.",
                      "*BOUNDARY", "1, 1, 1", *(f"{n}, 2, 2" for n in low), *steps, ""])  # fmt: skip


LINEAR_LAW = "*USER MATERIAL, CONSTANTS=4{}\n-1., 1000., 0.3, 0.2\n"
FRICTIONAL = "*USER MATERIAL, CONSTANTS=4{}\n0.9, 1000., 0.3, 1.\n"
UNSYMMETRIC = ["C3D4", "C3D6", "C3D8", "C3D8I", "C3D8R", "C3D10", "C3D15", "C3D20R", "CPE3", "CPE4", "CPE4R", "CAX4", "CAX4R", "CPS4", "CPS4I",
               "CPE4I", "CAX4I", "CPE8", "CAX8R"]  # fmt: skip


def unsymmetric_deck(kind: str, law: str) -> str:
    """Of any kind of element; in plane stress the strain across is ours to find."""
    law = law.format(", SPATIAL" if kind.startswith("CPS") else "")
    return solid_deck(kind, law) if kind.startswith("C3D") else plane_deck(kind, law)


@pytest.mark.slow
@pytest.mark.parametrize("kind", UNSYMMETRIC)
def test_an_unsymmetric_law_that_is_linear(run: Run, tmp_path: Path, kind: str) -> None:
    """The tangent of every kind of element has all of DDSDDE: a linear problem takes one iteration in each increment."""
    (tmp_path / "job.inp").write_text(unsymmetric_deck(kind, LINEAR_LAW))
    done = run(["job", f"user={ROUTINES / 'unsymmetric.f90'}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["AMONTONS/history/n_iterations"][1:].tolist() == [1] * 8


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["C3D8", "C3D8I", "C3D8R", "C3D10", "C3D20R", "CPE4", "CAX4R"])
def test_flow_without_dilatancy_converges_quadratically(run: Run, tmp_path: Path, kind: str) -> None:
    """Drucker and Prager's law with flow that keeps the volume: its tangent is far from symmetric. The residual, over the largest
    force, falls with its square once it is below 1e-2; with the symmetric part of the tangent such jobs take many times longer, or fail."""
    deck = unsymmetric_deck(kind, FRICTIONAL)
    if kind == "C3D8I":  # its modes find no balance under this law when the load turns: the first step alone
        deck = deck[: deck.rindex("*STEP")]
    (tmp_path / "job.inp").write_text(deck.replace("0.25, 1.", "0.5, 1.\n*CONTROLS, PARAMETERS=FIELD\n1e-12, 1e-12, , , 1e-12"))
    done = run(["job", f"user={ROUTINES / 'unsymmetric.f90'}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    seen: dict[tuple[int, int, int], list[float]] = {}
    for row in read_cvg(tmp_path / "job.cvg"):
        seen.setdefault((row.step, row.increment, row.attempt), []).append(0.01 * row.residual)
    pairs = [(a, b) for history in seen.values() for a, b in zip(history, history[1:], strict=False) if 1e-9 < a < 1e-2]
    assert len(pairs) >= 2
    assert all(b <= max(100 * a**2, 1e-13) for a, b in pairs), pairs


def test_flow_without_dilatancy_in_closed_form(run: Run, tmp_path: Path) -> None:
    """A cube under a pressure P from its sides is pressed until it flows: the stress along it is -(k + P + 2 a P/3) / (1 - a/3), and
    the change of volume is that of the mean stress alone, 3 (1 - 2 nu) p / E."""
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    a, young, nu, k, pressure = 0.9, 1000.0, 0.3, 1.0, 0.5
    (tmp_path / "job.inp").write_text("\n".join([
        "*NODE", *(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(corners, 1)), "*ELEMENT, TYPE=C3D8, ELSET=BODY", "1, 1, 2, 3, 4, 5, 6, 7, 8",
        "*MATERIAL, NAME=SAND", FRICTIONAL.format("").strip(), "*SOLID SECTION, ELSET=BODY, MATERIAL=SAND", "*BOUNDARY", "1, 1", "4, 1", "5, 1",
        "8, 1", "1, 2", "2, 2", "5, 2", "6, 2", "1, 3", "2, 3", "3, 3", "4, 3", "*STEP", "*STATIC", "0.25, 1.", "*DLOAD", "BODY, P4, 0.5",
        "BODY, P5, 0.5", "*BOUNDARY", *(f"{n}, 3, 3, -0.01" for n in range(5, 9)), "*END STEP", ""]))  # fmt: skip
    done = run(["job", f"user={ROUTINES / 'unsymmetric.f90'}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    along = -(k + pressure + 2 * a * pressure / 3) / (1 - a / 3)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        stress, u = file["VTKHDF/PointData/S"][-8:], file["VTKHDF/PointData/U"][-8:]
    assert np.abs(stress - np.array([-pressure, -pressure, along, 0, 0, 0])).max() <= 1e-5 * abs(along)
    volume = u[6].sum()
    assert abs(volume - (along - 2 * pressure) * (1 - 2 * nu) / young) <= 1e-5 * abs(u).max()


@pytest.mark.parametrize("kind", ["CPS4", "T3D2"])
def test_volume_stays_where_umat_knows_no_strain_across(run: Run, tmp_path: Path, kind: str) -> None:
    """A bar of length 2 and section 0.3 under NLGEOM is pulled by a fifth with NTENS = 3 and 1. The stress is E ln(1.2), to the
    order of an increment's strain cubed; the force is that over the section that keeps the volume, A = A0/1.2."""
    nodes = "*NODE\n1, 0., 0.\n2, 2., 0.\n3, 2., 0.3\n4, 0., 0.3\n"
    if kind == "CPS4":
        mesh = nodes + "*ELEMENT, TYPE=CPS4, ELSET=BODY\n1, 1, 2, 3, 4\n"
        section, held, pulled, law = "1.", "1, 1, 2\n4, 1, 1\n", "2, 1, 1, 0.4\n3, 1, 1, 0.4\n", "2., 1."
    else:
        mesh = "*NODE\n1, 0., 0.\n2, 2., 0.\n*ELEMENT, TYPE=T3D2, ELSET=BODY\n1, 1, 2\n"
        section, held, pulled, law = "0.3", "1, 1, 3\n2, 2, 3\n", "2, 1, 1, 0.4\n", "1., 0."
    (tmp_path / "job.inp").write_text(
        mesh + f"*MATERIAL, NAME=STUFF\n*USER MATERIAL, CONSTANTS=4\n1000., 0.3, {law}\n*DEPVAR\n2\n"
        f"*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF\n{section}\n*BOUNDARY\n{held}"
        f"*STEP, NLGEOM, INC=200\n*STATIC, DIRECT\n0.02, 1.\n*BOUNDARY\n{pulled}*END STEP\n")
    done = run(["job", f"user={ROUTINES / 'elastic.f'}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        stress = file["AMONTONS/integration_points/S"][-1, 0]
        force = file["VTKHDF/PointData/RF"][-n:, 0]
    expected = 1000.0 * np.log(1.2)
    assert stress == pytest.approx(expected, rel=50 * 0.004**3 / 12 / np.log(1.2) + 1e-9)
    assert force[force > 0].sum() == pytest.approx(stress * 0.3 / 1.2, rel=1e-6)


def test_libraries_on_the_card(run: Run, tmp_path: Path) -> None:
    """LIBRARY= names a file for each material, beside the deck, and counts before that of the command line; two materials may
    name the same one. Bitwise the same as with the file on the command line; one that is missing, or lacks UMAT, is reported."""
    folder = tmp_path / "deck"
    folder.mkdir()
    for name in ("j2.f", "neo_hooke.f90"):
        (folder / name).write_text((ROUTINES / name).read_text())
    deck = solid_deck("C3D8", J2)
    card = deck.replace("*USER MATERIAL,", "*USER MATERIAL, LIBRARY=j2.f,")
    second = "*MATERIAL, NAME=OTHER\n" + J2.replace("*USER MATERIAL,", "*USER MATERIAL, LIBRARY=j2.f,")
    (folder / "plain.inp").write_text(deck)
    (folder / "card.inp").write_text(card.replace("*SOLID SECTION", second + "*SOLID SECTION", 1))
    for words in (["deck/plain", f"user={ROUTINES / 'j2.f'}"], ["deck/card", f"user={ROUTINES / 'neo_hooke.f90'}"]):
        done = run(words, cwd=tmp_path)
        assert done.returncode == 0, done.stdout
    a, b = folder / "plain.vtkhdf", folder / "card.vtkhdf"
    assert [name for name in same_results(a, b) if "PointData" in name or "integration" in name] == []
    (folder / "card.vtkhdf").unlink()
    (folder / "fric.f90").write_text("subroutine fric\nend subroutine fric\n")
    for library, code, sentence in (("nothing.f", IO, "nothing.f do not exist"), ("fric.f90", SETUP, "needs the user routine UMAT")):
        (folder / "card.inp").write_text(card.replace("j2.f", library))
        done = run(["deck/card", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path)
        assert done.returncode == code, done.stdout
        assert sentence in done.stdout
        assert not (folder / "card.vtkhdf").exists()


def test_statev_at_the_start(run: Run, tmp_path: Path) -> None:
    """INITIAL CONDITIONS, TYPE=SOLUTION: from data lines, of a set and of an element, and by SDVINI, from place and number of
    the point."""
    law = "*USER MATERIAL, CONSTANTS=2\n70000., 0.25\n*DEPVAR\n11\n"
    lines = "*INITIAL CONDITIONS, TYPE=SOLUTION\nBODY, 1., 2., 3., 4., 5., 6., 7.\n8., 9., 10., 11.\n2, 21., 22.\n28.,\n"
    deck = solid_deck("C3D8", law)
    (tmp_path / "lines.inp").write_text(deck.replace("*STEP", lines + "*STEP", 1))
    (tmp_path / "routine.inp").write_text(deck.replace("*STEP", "*INITIAL CONDITIONS, TYPE=SOLUTION, USER\n*STEP", 1))
    for name in ("lines", "routine"):
        done = run([name, f"user={ROUTINES / 'elastic.f'}"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "lines.vtkhdf") as file:
        statev = file["AMONTONS/integration_points/SDV"][-64:]
    assert np.all(statev[:8] == np.arange(1, 12))
    assert np.all(statev[8:16] == [21, 22, 0, 0, 0, 0, 0, 28, 0, 0, 0])
    with h5py.File(tmp_path / "routine.vtkhdf") as file:
        statev = file["AMONTONS/integration_points/SDV"][-64:]
    assert np.all(statev[:, 1] == [100 * e + p for e in range(1, 9) for p in range(1, 9)])
    low, high = 0.25 - 0.25 / 3**0.5, 0.25 + 0.25 / 3**0.5
    assert statev[0, 0] == pytest.approx(low + 10 * low, rel=1e-12)
    assert statev[1, 0] == pytest.approx(high + 10 * low, rel=1e-12)
    for bad, sentence in (("TYPE=SOLUTION\nBODY, 1., 2., 3., 4., 5., 6., 7., 8.", "at most 8"), ("TYPE=STRESS, USER", "SOLUTION alone")):
        (tmp_path / "bad.inp").write_text(deck.replace("*STEP", f"*INITIAL CONDITIONS, {bad}\n*STEP", 1))
        done = run(["bad", f"user={ROUTINES / 'elastic.f'}"], cwd=tmp_path)
        assert done.returncode == 3, done.stdout
        assert sentence in done.stdout
    (tmp_path / "bad.inp").write_text(solid_deck("C3D8", J2).replace("*STEP", "*INITIAL CONDITIONS, TYPE=SOLUTION, USER\n*STEP", 1))
    done = run(["bad", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path)
    assert done.returncode == SETUP, done.stdout
    assert "needs the user routine SDVINI" in done.stdout


@pytest.mark.parametrize("kind", ["C3D8", "C3D10"])
def test_rubber_by_umat_is_hyperelastic(run: Run, tmp_path: Path, kind: str) -> None:
    """Neo-Hookean rubber from DFGRD1 at shears of 0.4: stresses as HYPERELASTIC's; as many iterations, so that the
    tangent of Jaumann's rate is taken over rightly."""
    top = (0.5, -0.2)
    ours, theirs = run_two(run, tmp_path, solid_deck(kind, RUBBER, nlgeom=True, top=top),
                           solid_deck(kind, USER_RUBBER, nlgeom=True, top=top), ROUTINES / "neo_hooke.f90")  # fmt: skip
    assert_equal(ours, theirs, 1e-8)
    with h5py.File(ours) as a, h5py.File(theirs) as b:
        energy = a["AMONTONS/integration_points/energy"][:]
        assert np.abs(energy - b["AMONTONS/integration_points/energy"][:]).max() <= 1e-8 * energy.max()


def turning_deck(material: str, angles: np.ndarray, orientation: str = "") -> str:
    """A cube that is pulled in the first increment, then turned about z: an affine motion of all its nodes."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    lines = ["*NODE"] + [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(corners, 1)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BODY", "1, 1, 2, 4, 3, 5, 6, 8, 7", orientation.strip(), "*MATERIAL, NAME=STUFF",
              material.strip(), "*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF" + (", ORIENTATION=AXES" if orientation else "")]  # fmt: skip
    tables = []
    for i, place in enumerate(corners):
        stretched = place * (1 + STRETCH)
        for k in range(3):
            values = [(0.0, 0.0)]
            for time, angle in enumerate(angles, 1):
                c, s = np.cos(angle), np.sin(angle)
                turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ stretched
                values.append((float(time), turned[k] - place[k]))
            tables.append(f"*AMPLITUDE, NAME=A{3 * i + k}\n" + "\n".join(f"{t}, {v:.15g}" for t, v in values))
    lines += [*tables, "*STEP, NLGEOM, INC=100", "*STATIC, DIRECT", f"1., {len(angles)}."]
    for i in range(8):
        for k in range(3):
            lines.append(f"*BOUNDARY, AMPLITUDE=A{3 * i + k}\n{i + 1}, {k + 1}, {k + 1}, 1.")
    return "\n".join([line for line in lines if line] + ["*END STEP", ""])


def mean_stresses(results: Path) -> np.ndarray:
    """The mean over the eight points of the cube, frame by frame: xx yy zz xy yz xz."""
    with h5py.File(results) as file:
        return file["AMONTONS/integration_points/S"][:].reshape(-1, 8, 6).mean(axis=1)


def as_tensor(stress: np.ndarray) -> np.ndarray:
    """Six components as a symmetric matrix."""
    xx, yy, zz, xy, yz, xz = stress
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def test_stress_turns_with_the_material(run: Run, tmp_path: Path) -> None:
    """A rate law under NLGEOM: a cube is pulled, then turned by a quarter in 45 increments of 2 degrees. Its stress turns
    with it; Hughes and Winget's rotation makes an error of the order of the cube of an increment's angle each."""
    angles = np.radians(np.arange(0, 91, 2))
    law = "*USER MATERIAL, CONSTANTS=4\n210000., 0.3, 1e9, 1.\n*DEPVAR\n1\n"
    (tmp_path / "job.inp").write_text(turning_deck(law, angles))
    done = run(["job", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    stress = mean_stresses(tmp_path / "job.vtkhdf")
    pulled, turned = stress[1], stress[-1]
    lame, shear = 210000 * 0.3 / 1.3 / 0.4, 210000 / 2.6
    expected = lame * STRETCH.sum() + 2 * shear * STRETCH
    assert np.abs(pulled[:3] - expected).max() < 1.5e-3 * expected.max()  # the strains are logarithms, to their order
    angle = np.radians(2)
    bound = len(angles) * angle**3 / 12 * np.abs(pulled).max() + 1e-9
    assert np.abs(turned[[1, 0, 2, 3, 4, 5]] - pulled).max() < 2 * bound


FIBRES = "*ORIENTATION, NAME=AXES\n2., 1., 0.5, -1., 2., 0.3\n"
WOOD = "12000., 900., 1100., 800., 500., 1000., 700., 650., 80.\n"


def test_local_axes_turn_with_the_material(run: Run, tmp_path: Path) -> None:
    """An orthotropic law in local axes that stand askew, NLGEOM: the cube is pulled, then turned by a quarter in
    increments of 30 degrees. Pulled it has the stress that our own orthotropic law has at small strain, to the order of
    the strain; turned it has R s R^T to rounding, because the rotation of a rigid turn is exact. The routine stops the job
    if DROT is not 1."""
    angles = np.radians([0.0, 30.0, 60.0, 90.0])
    (tmp_path / "turned.inp").write_text(turning_deck("*USER MATERIAL, CONSTANTS=9\n" + WOOD.replace(" 80.", "\n80."), angles, FIBRES))
    done = run(["turned", f"user={ROUTINES / 'orthotropic.f'}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    small = turning_deck("*ELASTIC, TYPE=ORTHO\n" + WOOD.replace(" 80.", "\n80."), angles[:1], FIBRES).replace(", NLGEOM", "")
    (tmp_path / "small.inp").write_text(small)
    assert run(["small"], cwd=tmp_path).returncode == 0
    pulled, expected = mean_stresses(tmp_path / "turned.vtkhdf")[1], mean_stresses(tmp_path / "small.vtkhdf")[1]
    assert np.abs(pulled - expected).max() < 2e-3 * np.abs(expected).max()
    assert np.abs(pulled[3:]).min() > 0.01 * np.abs(pulled).max()  # the axes do stand askew
    for k, angle in enumerate(angles):
        c, s = np.cos(angle), np.sin(angle)
        rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        stress = as_tensor(mean_stresses(tmp_path / "turned.vtkhdf")[k + 1])
        assert np.abs(stress - rotation @ as_tensor(pulled) @ rotation.T).max() < 1e-10 * np.abs(pulled).max()


@pytest.mark.slow
@pytest.mark.parametrize("system", [FIBRES, "*ORIENTATION, NAME=AXES, SYSTEM=CYLINDRICAL\n-1., 0., 0., -1., 0.2, 1.\n"])
def test_local_axes_do_not_matter_to_what_is_isotropic(run: Run, tmp_path: Path, system: str) -> None:
    """Rubber from DFGRD1 and plasticity from DSTRAN, at shears of 0.4, both with axes that stand askew: what HYPERELASTIC
    gives, and what the same routine gives without the axes; so DFGRD1 is Q^T F Q, and the tangent is turned back."""
    top = (0.5, -0.2)
    theirs = solid_deck("C3D8", USER_RUBBER, nlgeom=True, top=top)
    theirs = theirs.replace("*MATERIAL", system + "*MATERIAL").replace("MATERIAL=STUFF", "MATERIAL=STUFF, ORIENTATION=AXES")
    ours = solid_deck("C3D8", RUBBER, nlgeom=True, top=top)
    assert_equal(*run_two(run, tmp_path, ours, theirs, ROUTINES / "neo_hooke.f90"), 1e-8)
    plain = solid_deck("C3D8", J2, nlgeom=True, top=(0.2, -0.1))
    turned = plain.replace("*MATERIAL", system + "*MATERIAL").replace("MATERIAL=STUFF", "MATERIAL=STUFF, ORIENTATION=AXES")
    for name, deck in (("plain", plain), ("turned", turned)):
        (tmp_path / f"{name}.inp").write_text(deck)
        done = run([name, f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
    assert_equal(tmp_path / "plain.vtkhdf", tmp_path / "turned.vtkhdf", 1e-8)


UEXTERNALDB = """subroutine uexternaldb(lop, lrestart, time, dtime, kstep, kinc)
  include 'aba_param.inc'
  dimension time(2)
  open (99, file='calls.txt', position='append')
  write (99, '(i0, 3f9.5, 2(1x, i0))') lop, time, dtime, kstep, kinc
  close (99)
  if (kstep == 9) call xit
end subroutine uexternaldb
"""


def external_database(folder: Path, extra: str = "") -> Path:
    """The elastic UMAT in a file with a UEXTERNALDB that lists its calls, and a job of two steps."""
    (folder / "db.f90").write_text(UEXTERNALDB.replace("kstep == 9", extra or "kstep == 9") + free_form_elastic())
    (folder / "job.inp").write_text(solid_deck("C3D8", "*USER MATERIAL, CONSTANTS=2\n210000., 0.3\n*DEPVAR\n1\n"))
    return folder / "db.f90"


def free_form_elastic() -> str:
    """Hooke's law; STATEV(1) requests once a half of the first increment."""
    return """subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, &
  temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
  noel, npt, layer, kspt, jstep, kinc)
  include 'aba_param.inc'
  character(80) :: cmname
  dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), stran(ntens), dstran(ntens), &
    time(2), predef(1), dpred(1), props(nprops), coords(3), drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
  g = props(1) / (2 * (1 + props(2)))
  ddsdde = 0
  ddsdde(1:3, 1:3) = 2 * g * props(2) / (1 - 2 * props(2))
  do i = 1, 3
    ddsdde(i, i) = ddsdde(i, i) + 2 * g
    ddsdde(i + 3, i + 3) = g
  end do
  stress = stress + matmul(ddsdde, dstran)
  if (jstep(1) == 1 .and. kinc == 1 .and. dtime > 0.2d0 .and. any(abs(dstran) > 0)) pnewdt = 0.5d0
end subroutine umat
"""


def test_calls_of_uexternaldb(run: Run, tmp_path: Path) -> None:
    """Start of the job, steps, attempts (the first is cut back), increments, ends; with the times of each."""
    routines = external_database(tmp_path)
    done = run(["job", f"user={routines}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    calls = [[float(word) for word in line.split()] for line in (tmp_path / "calls.txt").read_text().splitlines()]
    assert calls[:4] == [[0, 0, 0, 0, 0, 0], [5, 0, 0, 0, 1, 0], [1, 0, 0, 0.25, 1, 1], [1, 0, 0, 0.125, 1, 1]]
    assert calls[4] == [2, 0.125, 0.125, 0.125, 1, 1]
    assert [call[0] for call in calls].count(5) == [call[0] for call in calls].count(6) == 2
    attempts = [call for call in calls if call[0] == 1]
    ends = [call for call in calls if call[0] == 2]
    assert len(attempts) == len(ends) + 1
    for start, end in zip(attempts[1:], ends, strict=True):
        assert end[1] == pytest.approx(start[1] + start[3], abs=2e-5) and end[4:] == start[4:]
    assert calls[-3][0:3:2] == [2, 2] and calls[-2][0] == 6 and calls[-1][0] == 3


@pytest.mark.parametrize(("when", "code"), [("lop == 0", SETUP), ("lop == 2 .and. kinc == 2", NOT_CONVERGED)])
def test_uexternaldb_ends_the_job(run: Run, tmp_path: Path, when: str, code: int) -> None:
    """XIT before the start, and after an increment, which is on disk: there the job continues, with LOP 0 and 4."""
    done = run(["job", f"user={external_database(tmp_path, when)}"], cwd=tmp_path)
    assert done.returncode == code, done.stdout
    assert "XIT" in done.stdout
    if code == SETUP:
        return
    (tmp_path / "calls.txt").unlink()
    done = run(["job", f"user={external_database(tmp_path)}", "--resume"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    calls = [[float(word) for word in line.split()] for line in (tmp_path / "calls.txt").read_text().splitlines()]
    assert [call[0] for call in calls[:3]] == [0, 4, 1]
    assert calls[1][1:3] == [0.25, 0.25] and calls[1][4:] == [1, 2] and calls[2][4:] == [1, 3]


def test_a_shared_library(run: Run, tmp_path: Path) -> None:
    """A library that the user has built, on the card's side of things the same."""
    built = tmp_path / "mine.so"
    (tmp_path / "aba_param.inc").write_text("      implicit real*8(a-h,o-z)\n")
    (tmp_path / "ABA_PARAM.INC").write_text("      implicit real*8(a-h,o-z)\n")
    subprocess.run(["gfortran", "-shared", "-fPIC", "-std=legacy", "-w", f"-I{tmp_path}", "-o", str(built), str(ROUTINES / "j2.f")],
                   check=True)  # fmt: skip
    deck = solid_deck("C3D8", J2)
    (tmp_path / "one.inp").write_text(deck)
    (tmp_path / "two.inp").write_text(deck)
    assert run(["one", "--user", built], cwd=tmp_path).returncode == 0
    assert run(["two", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path).returncode == 0
    assert same_results(tmp_path / "one.vtkhdf", tmp_path / "two.vtkhdf") == []


WRONG = {
    "missing.f": (None, IO, "no such file"),
    "syntax.f": ("      SUBROUTINE UMAT(\n      END\n", IO, "do not compile"),
    "text.so": ("no library at all\n", IO, "cannot be loaded"),
    "empty.f90": ("subroutine other\nend subroutine other\n", SETUP, "none of UMAT"),
    "fric.f90": ("subroutine fric\nend subroutine fric\n", SETUP, "needs the user routine UMAT"),
    "unknown.f90": ("subroutine umat\ncall nowhere\nend subroutine umat\n", IO, "cannot be loaded.*nowhere"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_libraries_are_reported(run: Run, tmp_path: Path, name: str) -> None:
    """Each with its sentence and exit code; no result file is begun."""
    text, code, sentence = WRONG[name]
    if text is not None:
        (tmp_path / name).write_text(text)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={name}"], cwd=tmp_path)
    assert done.returncode == code, done.stdout
    assert re.search(sentence, done.stdout), done.stdout
    assert "*ERROR" in done.stdout
    assert not (tmp_path / "job.vtkhdf").exists()


def test_library_of_another_machine(run: Run, tmp_path: Path) -> None:
    """The head of a library says that it is for another processor."""
    subprocess.run(["gfortran", "-shared", "-fPIC", "-std=legacy", "-w", "-x", "f77", "-", "-o", str(tmp_path / "other.so")],
                   input="      SUBROUTINE UMAT\n      END\n", text=True, check=True)  # fmt: skip
    image = bytearray((tmp_path / "other.so").read_bytes())
    image[18:20] = b"\xf3\x00"  # e_machine: RISC-V
    (tmp_path / "other.so").write_bytes(image)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", "--user=other.so"], cwd=tmp_path)
    assert done.returncode == IO, done.stdout
    assert "cannot be loaded" in done.stdout


def test_no_library_is_named(run: Run, tmp_path: Path) -> None:
    """The deck needs UMAT, the command line has none."""
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == USAGE, done.stdout
    assert "amontons job user=" in done.stdout


def with_lines(lines: str, folder: Path) -> Path:
    """The routine of plasticity with some lines before its first."""
    text = (ROUTINES / "j2.f").read_text()
    path = folder / "changed.for"
    path.write_text(text.replace("      EMOD=PROPS(1)\n", lines + "      EMOD=PROPS(1)\n", 1))
    return path


def test_pnewdt_cuts_back(run: Run, tmp_path: Path) -> None:
    """PNEWDT = 0.4 for increments longer than 0.15: 0.25 becomes 0.1, with the reason in the file."""
    routines = with_lines("      IF (DTIME.GT.0.15D0) PNEWDT=0.4D0\n", tmp_path)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={routines}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        dt = file["AMONTONS/history/dt"][:].ravel()
        failed = file["AMONTONS/history/is_converged"][:].ravel() == 0
        reason = file["AMONTONS/history/reason"][:]
    rows = np.flatnonzero(failed & (dt > 0))
    assert rows.size > 0
    assert dt[rows[0]] == 0.25
    assert dt[rows[0] + 1] == pytest.approx(0.1, rel=1e-14)
    assert b"PNEWDT is 0.4" in bytes(reason[rows[0]])
    assert dt[~failed].max() <= 0.15 + 1e-12


def test_xit_ends_the_job(run: Run, tmp_path: Path) -> None:
    """XIT in the second increment: exit code 5, the first increment is on disk, and STDB_ABQERR's sentence is printed."""
    routines = with_lines("      IF (TIME(2).GT.0.2D0) THEN\n"
                          "      CALL STDB_ABQERR(-1,'Element %I at %R in %S',NOEL,\n     1 TIME(2),CMNAME)\n"
                          "      CALL XIT\n      END IF\n", tmp_path)  # fmt: skip
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={routines}"], cwd=tmp_path)
    assert done.returncode == NOT_CONVERGED, done.stdout
    assert "WARNING: Element 1 at 0.25 in STUFF" in done.stdout
    assert done.stdout.splitlines()[-1].startswith("*ERROR: A user routine has ended the job")
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["VTKHDF/Steps/Values"][:].ravel().tolist() == [0.0, 0.25]


CRASHES = {
    "index": ("      K=100000000*KINC\n      STATEV(K)=1.D0\n", "it used memory that it does not own"),
    "stack": ("      CALL DEEP(STATEV,NOEL)\n", "arrays too large for the stack"),
    "division": ("      K=NOEL/(2-KINC)\n      STATEV(1)=K\n", "it divided an integer by zero"),
    "stop": ("      STOP\n", "it ended the process, by STOP or by an error of the Fortran library"),
    "read": ("      OPEN(15,FILE='none')\n      READ(15,*) K\n", "it ended the process, by STOP or by an error of the Fortran library"),
    "library": ("      CALL CRASH\n", "it used memory that it does not own"),
}
DEEP = """
      SUBROUTINE DEEP(A,N)
      REAL*8 A(*),B(20000000)
      B(N)=A(1)
      CALL DEEP(B,N+1)
      A(1)=B(N+1)
      END
      SUBROUTINE CRASH
      USE ISO_C_BINDING
      INTERFACE
      SUBROUTINE MEMSET(P,K,N) BIND(C)
      USE ISO_C_BINDING
      INTEGER(C_INTPTR_T), VALUE :: P
      INTEGER(C_INT), VALUE :: K
      INTEGER(C_SIZE_T), VALUE :: N
      END SUBROUTINE
      END INTERFACE
      CALL MEMSET(8_C_INTPTR_T,0_C_INT,4096_C_SIZE_T)
      END
"""


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", CRASHES)
def test_routines_that_crash(run: Run, tmp_path: Path, name: str, threads: int) -> None:
    """In the second increment: routine, file, element, point and increment are named. The first increment is on disk where the routine can
    be left, else in the checkpoint."""
    lines, cause = CRASHES[name]
    routines = with_lines(f"      IF (TIME(2).GT.0.2D0) THEN\n{lines}      END IF\n", tmp_path)
    routines.write_text(routines.read_text() + DEEP)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={routines.name}"], cwd=tmp_path, threads=threads)
    assert done.returncode == NOT_CONVERGED, done.stdout
    last = done.stdout.splitlines()[-1]
    pattern = r"\*ERROR: The routine UMAT of changed.for has crashed at element [1-8], integration point [1-8] in increment 2 of step 1: "
    assert re.match(pattern, last), done.stdout
    assert cause in last
    assert "Backtrace" not in done.stderr or name == "read"
    if name in ("stop", "read", "library"):
        routines.write_text((ROUTINES / "j2.f").read_text())
        assert run(["--resume", "job", f"user={routines.name}"], cwd=tmp_path, threads=threads).returncode == 0
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["VTKHDF/Steps/Values"][:2].ravel().tolist() == [0.0, 0.25]


def test_crash_in_the_first_call(run: Run, tmp_path: Path) -> None:
    """The call at rest is named, and the remedy is printed."""
    routines = with_lines("      K=-100000000\n      PROPS(K)=STATEV(K)\n", tmp_path)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={routines.name}"], cwd=tmp_path)
    assert done.returncode == SETUP, done.stdout
    assert "In the call at rest for the material 'STUFF': The routine UMAT of changed.for has crashed" in done.stdout
    assert "Set AMONTONS_FFLAGS to -fcheck=all" in done.stdout


def test_writes_behind_statev(run: Run, tmp_path: Path) -> None:
    """A routine that fills more state variables than *DEPVAR gives: named in the call at rest."""
    routines = with_lines("      DO K=1,NSTATV+3\n      STATEV(K)=1.D0*K\n      END DO\n", tmp_path)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={routines.name}"], cwd=tmp_path)
    assert done.returncode == SETUP, done.stdout
    assert "In the call at rest for the material 'STUFF': The routine UMAT of changed.for is wrong" in done.stdout
    assert "it wrote STATEV(4), but *DEPVAR gives it 1 state variable." in done.stdout


@pytest.mark.parametrize("threads", [1, 2])
def test_writes_behind_statev_when_it_flows(run: Run, tmp_path: Path, threads: int) -> None:
    """The same in the second increment: the memory of the job is not damaged, and the first increment is on disk."""
    routines = with_lines("      IF (TIME(2).GT.0.2D0) STATEV(NSTATV+10)=1.D0\n", tmp_path)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    done = run(["job", f"user={routines.name}"], cwd=tmp_path, threads=threads)
    assert done.returncode == NOT_CONVERGED, done.stdout
    last = done.stdout.splitlines()[-1]
    assert re.match(r"\*ERROR: The routine UMAT of changed.for is wrong at element [1-8], integration point [1-8] in increment 2 of step 1: ", last)
    assert "it wrote STATEV(11), but *DEPVAR gives it 1 state variable." in last
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["VTKHDF/Steps/Values"][:].ravel().tolist() == [0.0, 0.25]


def test_checks_of_the_compiler(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The remedy for a crash: flags for the compiler that name line and array."""
    routines = with_lines("      K=7*KINC\n      STRESS(K)=0.D0\n", tmp_path)
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2))
    monkeypatch.setenv("AMONTONS_FFLAGS", "-fcheck=all -O0")
    done = run(["job", f"user={routines.name}"], cwd=tmp_path)
    assert done.returncode == NOT_CONVERGED, done.stdout
    assert "above upper bound of 6" in done.stderr and "changed.for" in done.stderr and "'stress'" in done.stderr
    assert "it ended the process, by STOP or by an error of the Fortran library" in done.stdout.splitlines()[-1]


LEGACY = {
    "long line": "      EMOD=PROPS(1)                                                                        *1.0D0\n",
    "constants": "      EMOD=SIGN(1.0,PROPS(1))*MAX(PROPS(1),0.0)\n",
    "include": "      EMOD=PROPS(1)\n",
    "mismatch": "      EMOD=PROPS(1)\n      CALL ANY(EMOD)\n      CALL ANY(1)\n",
    "hollerith": "      EMOD=PROPS(1)\n      DATA TEXT/4HTEXT/\n      IF(EMOD)10,10,10\n   10 CONTINUE\n",
    "cards": "      EMOD=PROPS(1)                                                     UMAT0010\n",
    "tabulators": "\t\t\tEMOD=PROPS(1)+0.D0*(PROPS(2)-PROPS(3)+PROPS(2)-PROPS(3)+PROPS(2)-PROPS(3)+PROPS(2)-PROPS(3)+PROPS(2)-PROPS(3)+PROPS(4))\n",
}


@pytest.mark.parametrize("name", LEGACY)
def test_files_of_other_compilers(run: Run, tmp_path: Path, name: str) -> None:
    """Long lines, tabulators, numbers of cards, constants of single precision, lines of the preprocessor: the same result."""
    text = (ROUTINES / "j2.f").read_text().replace("      EMOD=PROPS(1)\n", LEGACY[name], 1)
    if name == "include":
        text = text.replace("      INCLUDE 'ABA_PARAM.INC'\n", '#include "aba_param.inc"\n', 1)
    (tmp_path / "old.for").write_text(text + "      SUBROUTINE ANY(X)\n      END\n")
    theirs, ours = run_two(run, tmp_path, solid_deck("C3D8", PLASTIC), solid_deck("C3D8", J2), tmp_path / "old.for")
    assert_equal(theirs, ours, 1e-9)


@pytest.mark.parametrize("mark", ["!DIR$ FREEFORM\n", "!dec$ freeform\n", ""])
def test_free_form_in_a_file_of_fixed_form(run: Run, tmp_path: Path, mark: str) -> None:
    """A file .for in free form, said by a directive or not; with the directive messages of the compiler are those of free form."""
    text = (ROUTINES / "unsymmetric.f90").read_text()
    results = []
    for name in ("their.f90", "free.for"):
        (tmp_path / name).write_text(mark + text)
        (tmp_path / "job.inp").write_text(solid_deck("C3D8", LINEAR_LAW.format("")))
        done = run(["job", f"user={name}"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
        with h5py.File(tmp_path / "job.vtkhdf") as file:
            results.append(file["VTKHDF/PointData/U"][:].tobytes())
    assert results[0] == results[1]
    (tmp_path / "free.for").write_text(mark + text + "subroutine any(x\nend\n")
    done = run(["job", "user=free.for"], cwd=tmp_path)
    assert done.returncode == IO
    assert "subroutine any(x" in done.stdout + done.stderr or not mark


def test_utility_routines(run: Run, tmp_path: Path) -> None:
    """SINV, SPRINC, SPRIND, ROTSIG and a mutex inside UMAT: the routine stops if they contradict each other."""
    routines = with_lines("""\
      CALL MUTEXINIT(1)
      CALL MUTEXLOCK(1)
      CALL CHECK(STRESS,DROT,NDI,NSHR)
      CALL MUTEXUNLOCK(1)
""", tmp_path)  # fmt: skip
    routines.write_text(routines.read_text() + """
      SUBROUTINE CHECK(S,R,NDI,NSHR)
      IMPLICIT REAL*8(A-H,O-Z)
      DIMENSION S(6),R(3,3),T(6),P(3),Q(3),A(3,3)
      CALL ROTSIG(S,R,T,1,NDI,NSHR)
      CALL SINV(S,SMEAN,SMISES,NDI,NSHR)
      CALL SINV(T,TMEAN,TMISES,NDI,NSHR)
      CALL SPRINC(S,P,1,NDI,NSHR)
      CALL SPRIND(T,Q,A,1,NDI,NSHR)
      IF (ABS(SMEAN-TMEAN)+ABS(SMISES-TMISES).GT.1.D-9*(1.D0+SMISES)) CALL XIT
      IF (ABS(SUM(P)-3.D0*SMEAN)+ABS(SUM(Q)-3.D0*TMEAN).GT.1.D-9*(1.D0+SMISES)) CALL XIT
      IF (MAXVAL(ABS(MATMUL(A,TRANSPOSE(A)))).GT.1.D0+1.D-12) CALL XIT
      END
""")
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2, nlgeom=True))
    done = run(["job", f"user={routines.name}"], cwd=tmp_path, threads=2)
    assert done.returncode == 0, done.stdout


def test_arguments_of_umat(run: Run, tmp_path: Path) -> None:
    """Times, numbers, places and names: a routine that stops when one of them is not what it should be."""
    routines = with_lines("""\
      IF (CMNAME.NE.'STUFF') CALL STDB_ABQERR(-3,'CMNAME',0,0.D0,' ')
      IF (NDI.NE.3.OR.NSHR.NE.3.OR.NTENS.NE.6) CALL STDB_ABQERR(-3,
     1 'NTENS',0,0.D0,' ')
      IF (NPROPS.NE.4.OR.NSTATV.NE.1) CALL XIT
      IF (NOEL.LT.1.OR.NOEL.GT.8.OR.NPT.LT.1.OR.NPT.GT.8) CALL XIT
      IF (MINVAL(COORDS).LT.0.D0.OR.MAXVAL(COORDS).GT.1.35D0) CALL XIT
      IF (KINC.GE.1.AND.CELENT.LT.0.4D0) CALL XIT
      IF (JSTEP(1).EQ.2.AND.ABS(TIME(2)-TIME(1)-1.D0).GT.1D-12) CALL XIT
      IF (JSTEP(1).EQ.1.AND.ABS(TIME(2)-TIME(1)).GT.1D-12) CALL XIT
      IF (ABS(TIME(1)-.25D0*(KINC-1)).GT.1D-12.AND.KINC.LE.4) CALL XIT
""", tmp_path)  # fmt: skip
    (tmp_path / "job.inp").write_text(solid_deck("C3D8", J2).replace("0.25, 1.", "0.25, 1., 1e-5, 0.25"))
    done = run(["job", f"user={routines}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout


def test_routines_and_rollback(tmp_path: Path) -> None:
    """Through the library: after a rollback the same step gives the same bits, STATEV included."""
    with amontons.Job(text=solid_deck("C3D8", J2), user=ROUTINES / "j2.f") as job:
        job.advance()
        job.try_step(0.5)
        first = [job.get(name).tobytes() for name in ("U", "S", "RF")]
        job.rollback()
        job.try_step(0.25)
        job.rollback()
        job.try_step(0.5)
        assert [job.get(name).tobytes() for name in ("U", "S", "RF")] == first


@pytest.mark.slow
def test_killed_jobs_with_umat_resume(program: Path, run: Run, tmp_path: Path) -> None:
    """kill -9 while UMAT runs: the job resumes bitwise, since STATEV are in the checkpoint."""
    slow = with_lines("      IF (KINC.EQ.3) CALL SLEEP(1)\n", tmp_path)
    deck = solid_deck("C3D4", J2)
    for name in ("whole", "killed"):
        (tmp_path / f"{name}.inp").write_text(deck)
    assert run(["whole", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path).returncode == 0
    job = subprocess.Popen([str(program), "killed", f"user={slow}"], cwd=tmp_path, stdout=subprocess.DEVNULL)
    for _ in range(400):
        sta = tmp_path / "killed.sta"
        if sta.exists() and len(sta.read_text().splitlines()) >= 4:
            break
        try:
            job.wait(timeout=0.05)
        except subprocess.TimeoutExpired:
            continue
    job.send_signal(signal.SIGKILL)
    job.wait()
    assert (tmp_path / "killed.restart").exists()
    assert run(["--resume", "killed", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path).returncode == 0
    assert same_results(tmp_path / "whole.vtkhdf", tmp_path / "killed.vtkhdf") == []


@pytest.mark.parametrize(("card", "sentence"), [
    ("*USER MATERIAL, CONSTANTS=9\n1., 2., 3., 4.\n", "CONSTANTS is 9"),
    ("*USER MATERIAL\n1., 2.\n", "CONSTANTS"),
    ("*USER MATERIAL, CONSTANTS=2\n1., x\n", "constant"),
    ("*USER MATERIAL, CONSTANTS=2\n1., 2.\n*ELASTIC\n1., 0.3\n", "beside laws of ours"),
    ("*USER MATERIAL, CONSTANTS=2, TYPE=THERMAL\n1., 2.\n", "no heat transfer"),
    ("*ELASTIC\n1., 0.3\n*DEPVAR\n2\n", "no \\*USER MATERIAL"),
    ("*USER MATERIAL, CONSTANTS=2\n1., 2.\n*DEPVAR\n0\n", "DEPVAR needs"),
    ("*USER MATERIAL, CONSTANTS=1\n1.\n*USER MATERIAL, CONSTANTS=1\n1.\n", "give one"),
    ("*HYPERELASTIC, NEO HOOKE\n1., 1.\n*HYPERELASTIC, NEO HOOKE\n1., 1.\n", "give one"),
    ("*ELASTIC\n1., 0.3\n*HYPERFOAM\n1., 1., 0.\n", "give one"),
])  # fmt: skip
def test_cards_that_are_wrong(run: Run, tmp_path: Path, card: str, sentence: str) -> None:
    """Errors of USER MATERIAL and DEPVAR are reported with the line."""
    import re

    (tmp_path / "job.inp").write_text(solid_deck("C3D8", card))
    done = run(["--check", "job"], cwd=tmp_path)
    assert done.returncode == 3, done.stdout
    assert re.search(sentence, done.stdout), done.stdout


def test_the_example_of_the_manual(run: Run, tmp_path: Path) -> None:
    """Routine and deck of doc/manual/user_routines.md: a bar under 210 per unit area, E = 210000."""
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text()
    routine, deck = (page.split(f"```{kind}\n")[1].split("```")[0] for kind in ("fortran", "abaqus-user"))
    (tmp_path / "mine.f90").write_text(routine)
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job", "user=mine.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert file["AMONTONS/integration_points/SDV"][-8:].ravel() == pytest.approx(np.full(8, 1e-3), rel=1e-9)
    assert "1.000000E-03" in (tmp_path / "job.dat").read_text()


LOADS = ROUTINES / "loads.f90"


def loaded_deck(loads: str, *, before: str = "", nlgeom: bool = False) -> str:
    """Two by two by two cubes on the floor, with a step."""
    from verify.decks import make_decks

    ticks = np.linspace(0.0, 1.0, 3)
    mesh = make_decks.block(ticks, ticks, ticks, "BODY")
    bottom, top = np.flatnonzero(mesh.nodes[:, 2] < 1e-9), np.flatnonzero(mesh.nodes[:, 2] > 1 - 1e-9)
    nodes = [f"{i}, {x:.17g}, {y:.17g}, {z:.17g}" for i, (x, y, z) in enumerate(mesh.nodes, 1)]
    elements = [f"{i}, " + ", ".join(str(n + 1) for n in row) for i, row in enumerate(mesh.elements, 1)]
    return "\n".join(["*NODE", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=BODY", *elements,
                      "*NSET, NSET=FLOOR", *(str(n + 1) for n in bottom), "*NSET, NSET=TOP", *(str(n + 1) for n in top),
                      "*ELSET, ELSET=UPPER", "5, 6, 7, 8", "*SURFACE, NAME=LID", "UPPER, S2",
                      "*MATERIAL, NAME=STUFF", "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=BODY, MATERIAL=STUFF",
                      "*BOUNDARY", "FLOOR, 1, 3", *filter(None, [before]), "*STEP" + (", NLGEOM" if nlgeom else ""), "*STATIC",
                      "0.25, 1.", loads.strip(), "*END STEP", ""])  # fmt: skip


@pytest.mark.parametrize("card", ["*DLOAD\nUPPER, P2NU", "*DSLOAD\nLID, PNU"])
def test_dload_gives_the_forces_of_its_pressure(run: Run, tmp_path: Path, card: str) -> None:
    """A pressure linear in the place, integrated exactly by the rule of the face: force 10 + 4/2 - 2/2 = 11 per unit area,
    moments about the origin from the second moments; in equilibrium with the floor."""
    (tmp_path / "job.inp").write_text(loaded_deck(card))
    done = run(["job", f"user={LOADS}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        history = file["AMONTONS/history"]
        n = int(file["VTKHDF/NumberOfPoints"][0])
        applied, times = history["applied_force"][:, 2], history["step_time"][:].ravel()
        reaction = file["VTKHDF/PointData/RF"][-n:]
        points = file["VTKHDF/Points"][:]
    assert applied == pytest.approx(-11 * times, abs=1e-12)
    moment = np.cross(points, reaction).sum(axis=0)
    about_x = 10 / 2 + 4 / 4 - 2 / 3  # integral of y p
    about_y = 10 / 2 + 4 / 3 - 2 / 4  # integral of x p
    assert moment == pytest.approx([about_x, -about_y, 0], abs=1e-6)


def test_dload_of_one_value_is_a_pressure(run: Run, tmp_path: Path) -> None:
    """A routine that gives the same pressure everywhere, under NLGEOM: as *DLOAD with that pressure, iterations too."""
    source = tmp_path / "flat.f90"
    source.write_text("subroutine dload(f, kstep, kinc, time, noel, npt, layer, kspt, coords, jltyp, sname)\n"
                      "real(8) :: f, time(2), coords(3)\ncharacter(80) :: sname\nf = 50 * time(1)\nend subroutine dload\n")  # fmt: skip
    ours, theirs = run_two(run, tmp_path, loaded_deck("*DLOAD\nUPPER, P2, 50.", nlgeom=True),
                           loaded_deck("*DLOAD\nUPPER, P2NU", nlgeom=True), source)  # fmt: skip
    assert_equal(ours, theirs, 1e-12)


TRACTION = """subroutine utracload(alpha, t_user, kstep, kinc, time, noel, npt, coords, dircos, jltyp, sname)
  include 'aba_param.inc'
  dimension t_user(3), time(2), coords(3), dircos(3, 3)
  character(80) :: sname
  {}
end subroutine utracload
"""


@pytest.mark.parametrize(("card", "jltyp", "name", "force"), [
    ("*DSLOAD\nLID, TRVECNU", 520, "LID", (0.6, 0.0, 0.8)), ("*DLOAD\nUPPER, TRVEC2NU", 522, "", (0.6, 0.0, 0.8)),
    ("*DSLOAD\nLID, TRSHRNU", 510, "LID", (1.0, 0.0, 0.0)), ("*DLOAD\nUPPER, TRSHR2NU", 512, "", (1.0, 0.0, 0.0)),
])  # fmt: skip
def test_utracload_gives_the_forces_of_its_traction(run: Run, tmp_path: Path, card: str, jltyp: int, name: str, force: tuple[float, ...]) -> None:
    """A traction linear in the place, along (3, 0, 4) or its part in the plane z = 1: force 10 + 4/2 - 2/2 = 11 per unit area, moments about the origin
    from the second moments. JLTYP, SNAME and DIRCOS (the normal inward) are right, else the routine ends the job."""
    (tmp_path / "mine.f90").write_text(TRACTION.format(f"""if (jltyp /= {jltyp} .or. sname /= '{name}' .or. noel < 5 .or. npt > 4) call xit
  if (abs(dircos(3, 3) + 1) > 1d-12 .or. abs(dircos(1, 1) * dircos(2, 2) - dircos(1, 2) * dircos(2, 1) + 1) > 1d-12) call xit
  alpha = time(1) * (10 + 4 * coords(1) - 2 * coords(2))
  t_user = [6d0, 0d0, 8d0]"""))
    (tmp_path / "job.inp").write_text(loaded_deck(card))
    done = run(["job", "user=mine.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        history = file["AMONTONS/history"]
        n = int(file["VTKHDF/NumberOfPoints"][0])
        applied, times = history["applied_force"][:], history["step_time"][:].ravel()
        reaction = file["VTKHDF/PointData/RF"][-n:]
        points = file["VTKHDF/Points"][:]
    assert applied == pytest.approx(np.outer(times, 11 * np.array(force)), abs=1e-12)
    x, y = 10 / 2 + 4 / 3 - 2 / 4, 10 / 2 + 4 / 4 - 2 / 3  # integrals of x and y times the magnitude; z = 1
    moment = np.array([y * force[2] - 11 * force[1], 11 * force[0] - x * force[2], x * force[1] - y * force[0]])
    assert np.cross(points, reaction).sum(axis=0) == pytest.approx(-moment, abs=1e-6)


@pytest.mark.parametrize(("ours", "theirs"), [("LID, TRVECNU, 5., 1., 2., 3.", "LID, TRVEC, 5., 1., 2., 3."), ("LID, TRSHRNU, 5., 1., 2., 3.", "LID, TRSHR, 5., 1., 2., 3.")])
def test_utracload_gets_the_card(run: Run, tmp_path: Path, ours: str, theirs: str) -> None:
    """Magnitude and direction of the card enter: a routine that ramps the one and keeps the other gives the load without NU, under NLGEOM."""
    (tmp_path / "mine.f90").write_text(TRACTION.format("alpha = time(1) * alpha"))
    card = "*DSLOAD, FOLLOWER=NO, CONSTANT RESULTANT=YES\n"
    one, other = run_two(run, tmp_path, loaded_deck(card + theirs, nlgeom=True), loaded_deck(card + ours, nlgeom=True), tmp_path / "mine.f90")
    assert_equal(one, other, 1e-10)


@pytest.mark.parametrize(("card", "body", "code", "says"), [
    ("*DSLOAD\nLID, TRVECNU, 1.", "", NOT_CONVERGED, "UTRACLOAD gives a magnitude without a direction"),
    ("*DSLOAD\nLID, TRSHRNU, 1.", "t_user = [0, 0, 2]", NOT_CONVERGED, "or normal to a face under shear"),
    ("*DSLOAD\nLID, TRVECNU, 1., 1.", None, SETUP, "needs the user routine UTRACLOAD"),
    ("*DSLOAD, AMPLITUDE=A\nLID, TRVECNU, 1., 1.", "", INPUT, "The routine UTRACLOAD gives the whole load"),
    ("*DLOAD\nUPPER, TRVEC7NU, 1., 1.", "", INPUT, "takes no load TRVEC7NU"),
])  # fmt: skip
def test_utracload_is_refused(run: Run, tmp_path: Path, card: str, body: str | None, code: int, says: str) -> None:
    """No direction, no routine, an amplitude, no face."""
    other = "subroutine dload(f)\n  real(8) :: f\n  f = 0\nend subroutine dload\n"
    (tmp_path / "mine.f90").write_text(other if body is None else TRACTION.format(body))
    (tmp_path / "job.inp").write_text(loaded_deck(card, before="*AMPLITUDE, NAME=A\n0., 0., 1., 1."))
    done = run(["job", "user=mine.f90"], cwd=tmp_path)
    assert (done.returncode, says in " ".join((done.stdout + done.stderr).split())) == (code, True), done.stdout + done.stderr


def test_utracload_of_the_manual(run: Run, tmp_path: Path) -> None:
    """A shear traction of 30 x along a bar of length 2 and width 1: the held end bears 60."""
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text()
    deck = page.split("```abaqus-utracload\n")[1].split("```")[0]
    routine = page[: page.index("```abaqus-utracload")].rsplit("```fortran\n", 1)[1].split("```")[0]
    (tmp_path / "mine.f90").write_text(routine)
    (tmp_path / "job.inp").write_text(deck)
    done = run(["job", "user=mine.f90"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        assert file["VTKHDF/PointData/RF"][-n:].sum(axis=0) == pytest.approx([-60, 0, 0], abs=1e-9)


def test_disp_prescribes(run: Run, tmp_path: Path) -> None:
    """DISP moves the top as *BOUNDARY with the same values does."""
    ours, theirs = run_two(run, tmp_path, loaded_deck("*BOUNDARY\nTOP, 1, 1, 0.002\nTOP, 3, 3, -0.001"),
                           loaded_deck("*BOUNDARY, USER\nTOP, 1, 1\nTOP, 3, 3"), LOADS)  # fmt: skip
    assert_equal(ours, theirs, 1e-12)


def test_uamp_is_an_amplitude(run: Run, tmp_path: Path) -> None:
    """UAMP that adds up the increments is a ramp; its variable is kept with the increments, in a library's rollback too."""
    table = "*AMPLITUDE, NAME=RAMP, TIME=TOTAL TIME\n0., 0., 1., 3."
    user = "*AMPLITUDE, NAME=RAMP, DEFINITION=USER, PROPERTIES=1, VARIABLES=1\n3."
    load = "*CLOAD, AMPLITUDE=RAMP\nTOP, 3, -1."
    ours, theirs = run_two(run, tmp_path, loaded_deck(load, before=table), loaded_deck(load, before=user), LOADS)
    assert_equal(ours, theirs, 1e-12)
    with amontons.Job(text=loaded_deck(load, before=user), user=LOADS) as job:
        job.advance()
        for _ in range(3):
            job.try_step(0.5)
            tried = job.get("U").tobytes()
            job.rollback()
        job.try_step(0.5)
        assert job.get("U").tobytes() == tried


@pytest.mark.parametrize(("load", "before", "sentence"), [
    ("*BOUNDARY, USER\nTOP, 3, 3", "", "needs the user routine DISP"),
    ("*DLOAD\nUPPER, P2NU", "", "needs the user routine DLOAD"),
    ("*CLOAD, AMPLITUDE=A\nTOP, 3, 1.", "*AMPLITUDE, NAME=A, DEFINITION=USER", "needs the user routine UAMP"),
])  # fmt: skip
def test_load_routines_that_are_missing(run: Run, tmp_path: Path, load: str, before: str, sentence: str) -> None:
    """The library holds UMAT alone; without any library the usage is printed."""
    (tmp_path / "job.inp").write_text(loaded_deck(load, before=before))
    done = run(["job", f"user={ROUTINES / 'j2.f'}"], cwd=tmp_path)
    assert (done.returncode, sentence in done.stdout) == (SETUP, True), done.stdout
    done = run(["job"], cwd=tmp_path)
    assert (done.returncode, sentence in done.stdout) == (USAGE, True), done.stdout


def test_loads_by_routines_over_steps(run: Run, tmp_path: Path) -> None:
    """A load of DLOAD stands in the next step, too, until OP=NEW: then it is gone at once."""
    steps = ("*DLOAD\nUPPER, P2NU\n*END STEP\n*STEP\n*STATIC\n0.5, 1.\n*CLOAD\n14, 1, 0.\n*END STEP\n*STEP\n*STATIC\n0.5, 1.\n"
             "*DLOAD, OP=NEW\nUPPER, P2, 1.")
    (tmp_path / "job.inp").write_text(loaded_deck(steps))
    done = run(["job", f"user={LOADS}"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        history = file["AMONTONS/history"]
        step, time, force = (history[name][:] for name in ("step", "step_time", "applied_force"))
    last = {int(s): (float(t), float(f)) for s, t, f in zip(step.ravel(), time.ravel(), force[:, 2], strict=True)}
    assert last[1] == pytest.approx((1.0, -11.0))
    assert last[2] == pytest.approx((1.0, -11.0))
    assert last[3] == pytest.approx((1.0, -1.0))


WAITS = """
subroutine disp(u, kstep, kinc, time, node, noel, jdof, coords)
  include 'aba_param.inc'
  dimension u(3), time(3), coords(3)
  logical, save :: has_waited = .false.
  u(1) = -0.001d0 * time(1)
  if (has_waited) return
  has_waited = .true.
  call sleep(33)
end subroutine disp
"""


@pytest.mark.slow
def test_a_long_iteration_writes_a_line_in_a_pipe(run: Run, tmp_path: Path) -> None:
    """A job that says nothing for half a minute reports its progress; one that writes lines does not. A routine of the user that sleeps stands for the
    long iteration: the job waits without work for the processor."""
    deck = solid_deck("C3D8", "*ELASTIC\n70000., 0.25\n").replace("TOP, 3, 3, -0.006", "TOP, 3, 3, U", 1)
    deck = re.sub(r"\*BOUNDARY\n(TOP, 1, 1, 0.01)\nTOP, 3, 3, U\n", r"*BOUNDARY\n\1\n*BOUNDARY, USER\nTOP, 3, 3\n", deck)
    assert "USER" in deck
    (tmp_path / "job.inp").write_text(deck)
    for seconds, n_lines in ((0, 0), (33, 1)):
        (tmp_path / "waits.f90").write_text(WAITS.replace("sleep(33)", f"sleep({seconds})"))
        done = run(["job", "user=waits.f90"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
        assert done.stdout.count("At work") == n_lines, done.stdout
