"""Decks of one feature each against CalculiX itself (ccx), where it is installed: the tables of .dat and the fields of .frd.

The decks are those of feature_decks, joint_decks and behaviour_decks. A block agrees if its largest difference is within 1 % of its largest value, that of a linear job
within 0.2 %; CalculiX ends its iterations at 0.5 % of a mean force. A sample runs always, the rest is marked slow.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from verify.decks import behaviour_decks, feature_decks, joint_decks
from verify.decks.parts import Part
from verify.decks.solids import unit_cube
from verify.peers.test_mixed_decks import leave_out_residue, run_peer
from verify.readers.dat_frd_files import Block, compare, compare_block, read_dat, read_frd

CASES = feature_decks.cases() | joint_decks.cases() | behaviour_decks.cases()
LINEAR, NONLINEAR = 2e-3, 1e-2
RESIDUE = 1e-6
SAMPLE = re.compile(r"output-(C3D8-|C3D10-global-no|sets|all)|amplitude-|tie-(C3D8-|gap$|transform)|pretension-(C3D8|C3D15|kept)$|ring-C3D20R|truss|spring|mass|reference-rigid-(loaded|nl-moved)|"
                    r"flow-C3D8I|one-point-|creep$|creep-orthotropic|relieved|node-pressure|contact-(C3D4-s|C3D15-n|C3D8-m|hard|friction|change|small-n|clearance)|"
                    r"stack-n|lap-(drawn|flush)-n|bore-CAX4|punch-tilted-n|dome-C3D(4|6)-n|out-and-in-s|slope-n")

# Where the two differ, and why. A reason that begins with "CalculiX:" is an error of CalculiX (2.20); others are open here.
DIFFERENT: dict[str, str] = {
    r"lap-new-load": "CalculiX: a *DLOAD that is new in a later step goes into a sorted list whose old values stay where they are, so that its "
                     "neighbours begin the step at one another's values; equal if the load is stated as zero before (lap-drawn)",
    r"lap-flush-n": "CalculiX: drops slave nodes on the very end of their master, other ones on the two sides of a plane of symmetry; equal "
                    "where the master reaches further (lap-moved)",
    r"lap-moved-n": "CalculiX: a node that its linear law still pulls at, just outside the gap, rubs with the coefficient times the size of that "
                    "tension: 1.2 % of the largest pressure; here friction needs pressure",
    r"axis-CAX": "CalculiX: faces that touch the axis transmit no force, because there its sector has no width; equal with a bore",
    r"some-increments-m": "CalculiX: mortar pairs transmit too little force in the middle of a step and the right force at its end: a motion that grows evenly gives forces "
                          "that do not",
    r"put-down-s": "CalculiX: a face that comes down and along in one increment has slipped since the start of the increment, here since it touched; "
                   "with finer increments CalculiX comes to our result",
    r"elsewhere-s": "CalculiX: a pair that comes in again has slipped by what its surfaces moved while it was out",
    r"flow-C3D8R$": "CalculiX: prints forces with the hourglass stiffness of another element: 0.13 at nodes that are free; displacements and stresses "
                    "agree to 1e-5",
    r"one-point-CPS4R-plastic$": "the thickness of plane stress is coupled at the nodes in CalculiX: 6e-3 of the largest strain",
    r"contact-there-and-back-s": "slip over a long path differs at points where a face meets a new master face; forces agree",
}

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")


def parameters() -> list[object]:
    """One test for each deck."""
    result = []
    for name in CASES:
        reason = next((text for pattern, text in DIFFERENT.items() if re.search(pattern, name)), "")
        marks = [pytest.mark.xfail(reason=reason, strict=True)] if reason else []
        if not SAMPLE.match(name):
            marks.append(pytest.mark.slow)
        result.append(pytest.param(name, id=name, marks=marks))
    return result


def fields_apart(ours: Path, theirs: Path, is_noise: bool = False) -> list[tuple[str, float]]:
    """How far the fields of two .frd files are apart, name by name in their order; those of nothing but rounding are left out. With
    noise the error of the stress is, too: of trusses some have none, and of a disc it is a small difference of large stresses."""
    passed = {"CONTACT"} | ({"ERROR"} if is_noise else set())
    reference = [block for block in read_frd(theirs) if block.title not in passed]
    if not reference:
        return []
    found: dict[tuple[str, float], list[Block]] = {}
    for block in read_frd(ours):
        found.setdefault((block.title, round(block.time, 6)), []).append(block)
    top: dict[str, float] = {}
    for block in reference:
        top[block.title] = max(top.get(block.title, 0.0), block.largest)
    result = []
    for block in reference:
        mine = found.get((block.title, round(block.time, 6)), [])
        if block.largest > RESIDUE * top[block.title]:
            result.append((block.title, compare_block(mine.pop(0) if mine else None, block).deviation))
    return result


def run_both(run: Callable[..., object], folder: Path, text: str) -> object:
    """Runs a deck in CalculiX in a folder and here in its folder `ours`; our process."""
    ours = folder / "ours"
    ours.mkdir()
    for place in (folder, ours):
        (place / "job.inp").write_text(text)
    run_peer(folder)
    return run(["--dialect=calculix", "job"], cwd=ours)


@pytest.mark.parametrize("name", parameters())
def test_deck(name: str, run: Callable[..., object], tmp_path: Path) -> None:
    """All tables and fields within the tolerance of their largest value."""
    text = CASES[name]
    ours = tmp_path / "ours"
    result = run_both(run, tmp_path, text)
    assert result.returncode == 0, result.stdout + result.stderr  # type: ignore[attr-defined]
    # CalculiX 2.20 writes "print" where its later releases write "spring".
    for path in (tmp_path / "job.dat",):
        path.write_text(path.read_text().replace("contact print energy", "contact spring energy"))
    reference = read_dat(tmp_path / "job.dat")
    assert reference
    is_linear = "NLGEOM" not in text and "*CONTACT" not in text
    limit = LINEAR if is_linear else NONLINEAR
    tables = leave_out_residue(compare(read_dat(ours / "job.dat"), reference, "TYPE=CAX" in text), RESIDUE)
    bad = [f"{d.title} {d.set_name} t={d.time:g}: {d.deviation:.2e} of {d.largest:.3e} at {d.where}" for d in tables if not d.deviation <= limit]
    bad += [f"field {title}: {far:.2e}" for title, far in fields_apart(ours / "job.frd", tmp_path / "job.frd", "T3D" in text or "TYPE=CAX" in text) if not far <= limit]
    assert not bad, "\n".join(bad)


@pytest.mark.parametrize("kind, is_table", [("SPRINGA", False), ("SPRING1", False), ("SPRING2", False), ("SPRINGA", True), ("SPRING2", True)])
def test_spring_on_a_ring(run: Callable[..., object], tmp_path: Path, kind: str, is_table: bool) -> None:
    """A spring at a node of an axisymmetric element acts on two degrees of the circle: displacements and reactions are CalculiX's."""
    ring = Part("A", "CAX8R", (1, 0), (2, 1), (2, 2))
    node = ring.nodes_on("Y1")[0]
    text = feature_decks.bodies(ring) + feature_decks.STEEL + feature_decks.sections("A") + "*NODE, NSET=G\n900, 1., 1.5, 0.\n"
    nodes, directions = {"SPRINGA": (f"{node}, 900", ""), "SPRING1": (f"{node}", "2"), "SPRING2": (f"{node}, 900", "2, 2")}[kind]
    card, law = (", NONLINEAR", "-40., -0.01\n0., 0.\n40., 0.01\n60., 0.1\n") if is_table else ("", "5000.\n")
    text += f"*ELEMENT, TYPE={kind}, ELSET=SP\n800, {nodes}\n*SPRING, ELSET=SP{card}\n{directions}\n{law}"
    text += "*BOUNDARY\nG, 1, 3\nA_Y0N, 2\nA_X0N, 1\n"
    text += feature_decks.step("*DLOAD\n" + ring.dload("X1", 100.0) + "*NODE PRINT, NSET=AN\nU\n*NODE PRINT, NSET=A_Y0N\nRF\n*NODE PRINT, NSET=G\nRF\n")
    (tmp_path / "job.inp").write_text(text)
    run_peer(tmp_path)
    (tmp_path / "ours").mkdir()
    (tmp_path / "ours" / "job.inp").write_text(text)
    assert run(["--dialect=calculix", "job"], cwd=tmp_path / "ours").returncode == 0  # type: ignore[attr-defined]
    reference = read_dat(tmp_path / "job.dat")
    assert reference
    for table in compare(read_dat(tmp_path / "ours" / "job.dat"), reference, True):
        assert table.deviation < LINEAR, f"{table.title} {table.set_name}: {table.deviation:.2e} of {table.largest:.3e} at {table.where}"


@pytest.mark.parametrize("kind", ["SPRINGA", "GAPUNI"])
def test_spring_in_a_linear_step(run: Callable[..., object], tmp_path: Path, kind: str) -> None:
    """A pulled cube on a spring of a table, or with a gap: without NLGEOM CalculiX is linear, with it both follow the law."""
    cards = {"SPRINGA": "*SPRING, ELSET=SP, NONLINEAR\n\n-40., -0.01\n0., 0.\n40., 0.01\n60., 0.1\n", "GAPUNI": "*GAP, ELSET=SP\n0.01, 0., 0., 1.\n"}[kind]
    text = f"{unit_cube()}*NODE, NSET=G\n900, 0., 0., 2.\n*ELEMENT, TYPE={kind}, ELSET=SP\n800, 5, 900\n{cards}*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
    text += "*SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\nLOW, 1, 3\nG, 1, 3\n*STEP\n*STATIC\n1., 1.\n*CLOAD\n5, 3, 80.\n"
    text += "*NODE PRINT, NSET=HIGH\nU\n*END STEP\n"
    far = []
    for step in ("*STEP", "*STEP, NLGEOM"):
        folder = tmp_path / step.rpartition(" ")[2].strip("*")
        (folder / "ours").mkdir(parents=True)
        for place in (folder, folder / "ours"):
            (place / "job.inp").write_text(text.replace("*STEP\n", f"{step}\n", 1))
        run_peer(folder)
        done = run(["--dialect=calculix", "job"], cwd=folder / "ours")
        assert done.returncode == 0  # type: ignore[attr-defined]
        assert ("follow their laws" in " ".join(done.stdout.split())) == (step == "*STEP")  # type: ignore[attr-defined]
        far.append(max(table.deviation for table in compare(read_dat(folder / "ours" / "job.dat"), read_dat(folder / "job.dat"))))
    assert far[0] > 0.05
    assert far[1] < NONLINEAR


def totals(folder: Path) -> list[list[float]]:
    """The total forces of .dat."""
    return [list(block.rows.values())[0] for block in read_dat(folder / "job.dat") if block.title == "total force"]


def test_rotation_about_several_axes(run: Callable[..., object], tmp_path: Path) -> None:
    """Two squares of the angular velocity add up; CalculiX keeps one axis of an element, and none where OP=NEW removes that one."""
    body = Part("A", "C3D8", (1, 1, 1), (2, 2, 2), (2, 1, 1))
    text = feature_decks.bodies(body) + "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n*DENSITY\n1.\n" + feature_decks.sections("A") + "*BOUNDARY\nA_X0N, 1, 3\n"
    about_x, about_y = ("EALL, CENTRIF, 1., 0., 0., 0., " + axis for axis in ("1., 0., 0.\n", "0., 1., 0.\n"))
    print_out = "*NODE PRINT, NSET=A_X0N, TOTALS=ONLY\nRF\n"
    for option, load in (("", about_x), ("", about_x + about_y), (", OP=NEW", about_y)):
        text += feature_decks.step(f"*DLOAD{option}\n" + load + print_out)
    ours = tmp_path / "ours"
    result = run_both(run, tmp_path, text)
    assert result.returncode == 0  # type: ignore[attr-defined]
    output = result.stdout + result.stderr  # type: ignore[attr-defined]
    assert " ".join(output.split()).count("CalculiX applies one of them alone") == 2
    one, two, three = totals(ours)
    x, y, z = -three[0], -one[1], -one[2]
    assert min(x, y, z) > 1
    assert two == pytest.approx([-x, -y, -2 * z], rel=1e-6, abs=1e-9)
    assert three == pytest.approx([-x, 0.0, -z], rel=1e-6, abs=1e-9)
    for found, expected in zip(totals(tmp_path), ([0.0, -y, -z], [0.0, -y, -z], [0.0, 0.0, 0.0]), strict=True):
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_gaps_of_mortar(run: Callable[..., object], tmp_path: Path) -> None:
    """CalculiX writes the gap of a mortar pair times the area of the node: 1/24, 1/12 and 1/6 of a face of 2 by 3 squares. Pressures are the same."""
    run_both(run, tmp_path, CASES["gaps-m"])
    theirs, ours = (next(block for block in read_frd(folder / "job.frd") if block.title == "CONTACT") for folder in (tmp_path, tmp_path / "ours"))
    assert len(theirs.rows) == 12
    for node, row in theirs.rows.items():
        assert row[3] == pytest.approx(ours.rows[node][3], rel=2e-3)
        area = row[0] / ours.rows[node][0]
        assert min(abs(area * 24 - share) for share in (1, 2, 4)) <= 0.01
