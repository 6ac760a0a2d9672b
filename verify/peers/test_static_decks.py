"""CalculiX's own decks under --dialect=calculix against its printed references, block by block.

The decks are read in place: beside the repository in ../shared/decks, or where AMONTONS_DECKS says. A deck with a card
that we refuse is skipped with our message. A reference in a .dat file is compared table by table, the displacements and nodal
stresses of a .frd file node by node; those of expanded elements by the places of the nodes. A block agrees if the largest difference is within 1 % of its
largest value; blocks of nothing but rounding (below 1e-7 of the largest value of their kind) are left out.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from verify.peers.conftest import AGREES, Entry, Row
from verify.peers.test_mixed_decks import CCX, run_peer
from verify.readers.dat_frd_files import Block, Deviation, compare, expand, read_dat, read_frd, read_frd_places

DECKS = Path(os.environ.get("AMONTONS_DECKS", Path(__file__).resolve().parents[3] / "shared" / "decks"))

# References that CalculiX's own release does not reproduce, or that need code compiled into it: listed, not judged.
NOT_JUDGED = {
    "beampl": "the release itself deviates by 1.1 %",
    "patch_c3d8i": "not reproduced by the release",
    "pret4": "not reproduced by the release",
    "segment1": "not reproduced by the release",
    "cubesmortar2": "not reproduced by the release",
    "beamcontact": "the CONTACT blocks are not reproduced by the release",
    "cubef2f1": "the CONTACT blocks are not reproduced by the release",
    "cubef2f2": "the CONTACT blocks are not reproduced by the release",
    "cubef2f3": "the CONTACT blocks are not reproduced by the release",
    "contactdeleteelement": "crashes the release",
    "resstress2": "needs a subroutine compiled into CalculiX",
    "resstress3": "needs a subroutine compiled into CalculiX",
}

# What is not there yet, so that these decks run but do not agree (or do not run): listed in the table, expected to fail. A deck that
# begins to agree shows as XPASS and leaves this list.
UNFINISHED: dict[str, str] = {}

# Decks whose reference is where CalculiX's iteration stopped by its default tolerance: it is compared with what CalculiX itself gives
# at a tolerance of 1e-9, where it is installed.
LOOSE = {"beamtor": "0 by symmetry is 5 % of the largest displacement in the reference, 4e-6 where CalculiX iterates to 1e-9, with which "
                    "this compares"}
TIGHT = ("*STATIC", "*CONTROLS, PARAMETERS=FIELD\n1.e-9, 1.e-9\n*STATIC")

# Decks in which CalculiX cut its first increment back by itself and printed where it then came by. Amontons needs no cut-back
# and would print the end of the step alone: these decks are given CalculiX's increments, and nothing else is changed.
INCREMENTS = {"beamplane": ("*STATIC\n", "*STATIC\n.25, 1., , .25\n")}

# Why decks that agree are not nearer: listed in the table.
NOTES = {
    "beampic": "CalculiX's iterative solver stopped at its tolerance; beamidset is the same model by its direct one",
    "beammrco": "the deck requests a tolerance of 0.25, at which CalculiX stopped earlier",
    "beamnh": "CalculiX's last load is that of the iterate before: its stress is 2.004 under a pull of 2",
    "pret2": "the points of CalculiX's wedge stand in turned directions, which gives them the shears xz and yz",
}

# Fields of .frd, and what they are called in the result file.
FIELDS = {"DISP": ["U"], "STRESS": ["S"], "TOSTRAIN": ["E", "LE"]}

FOLDERS = [folder for folder in ("static", "contact", "shells") if (DECKS / folder).is_dir()]
FILES = [deck for folder in FOLDERS for deck in sorted((DECKS / folder).glob("*.inp"))]
SLOW = {"hueeber1", "hueeber3_mortar", "hueeber4", "hueeber4_mortar", "cubef2f1", "cubef2f2", "cubef2f3", "metalforming"}

pytestmark = pytest.mark.skipif(not FILES, reason=f"no decks in {DECKS}; AMONTONS_DECKS says where they are")


def parameters() -> list[object]:
    """One test for each deck."""
    return [pytest.param(deck, id=f"{deck.parent.name}-{deck.stem}", marks=marks_of(deck))
            for deck in FILES]


def marks_of(deck: Path) -> list[pytest.MarkDecorator]:
    """Slow decks, and those that are known not to agree yet."""
    marks = [pytest.mark.slow] if deck.stem in SLOW else []
    if deck.stem in LOOSE:
        marks.append(pytest.mark.skipif(CCX is None, reason="CalculiX (ccx) is not installed"))
    if deck.stem in UNFINISHED:
        marks.append(pytest.mark.xfail(reason=UNFINISHED[deck.stem], strict=False))
    return marks


def refusal(text: str) -> str:
    """The first error that the program prints."""
    errors = [line.strip() for line in text.splitlines() if re.search(r"error|not supported|no section", line, re.I)]
    return (errors or ["no message"])[0][:200]


def references(deck: Path) -> tuple[list[Block], list[Block]]:
    """Tables and fields that the deck has references of."""
    dat, frd = deck.with_suffix(".dat.ref"), deck.with_suffix(".frd.ref")
    tables = read_dat(dat) if dat.exists() else []
    fields = read_frd(frd) if frd.exists() else []
    has_section_forces = re.search(r"^\*EL FILE.*SECTION FORCES", deck.read_text(errors="replace"), re.I | re.M) is not None
    return tables, [block for block in fields if block.title in FIELDS and not (has_section_forces and block.title == "STRESS")]


def tight_tables(deck: Path, folder: Path) -> list[Block]:
    """The tables of CalculiX itself at a tolerance of 1e-9."""
    folder.mkdir()
    text = deck.read_text()
    assert TIGHT[0] in text
    (folder / "job.inp").write_text(text.replace(*TIGHT))
    run_peer(folder)
    return read_dat(folder / "job.dat")


def read_our_fields(path: Path, wanted: list[Block]) -> list[Block]:
    """Displacements, nodal stresses and strains of the result file at the times wanted, in the order of .frd."""
    result = []
    with h5py.File(path) as file:
        times = file["VTKHDF/Steps/Values"][:]
        points = file["VTKHDF/PointData"]
        labels = file["AMONTONS/mesh/node_label"][:]
        n = int(file["VTKHDF/NumberOfPoints"][0])
        for block in wanted:
            k = int(np.argmin(np.abs(times - block.time)))
            name = next((name for name in FIELDS[block.title] if name in points), "")
            if not name:
                continue
            values = points[name][k * n : (k + 1) * n]
            result.append(Block(block.title, "", block.time,
                                {(int(label),): list(map(float, row)) for label, row in zip(labels, values)}))
    return result


def leave_out_noise(deviations: list[Deviation], stiffness: float = 0.0) -> list[Deviation]:
    """Without blocks that are rounding only, in the reference and here: 1e-7 of the largest of their kind in the deck, and for
    stresses what a strain of 1e-12 makes with the stiffness. One that is rounding in the reference alone is judged by the largest
    of its kind.
    """
    top: dict[str, float] = {}
    for d in deviations:
        top[d.title] = max(top.get(d.title, 0.0), d.largest)
    level = {title: 1e-7 * largest for title, largest in top.items()}
    if "stresses" in level:
        level["stresses"] = max(level["stresses"], 1e-12 * stiffness)
    for d in deviations:
        if d.largest <= level[d.title] < d.ours and not d.missing:
            d.deviation = d.ours / top[d.title] if top[d.title] > 0 else float("inf")
    return [d for d in deviations if not max(d.largest, d.ours) <= level[d.title]]


def youngs_modulus(deck: Path) -> float:
    """The first number of *ELASTIC, TYPE=ISO; 0 without such a card."""
    found = re.search(r"^\*elastic[^\n]*\n\s*([0-9.eEdD+-]+)", deck.read_text(errors="replace"), re.I | re.M)
    return float(found.group(1).upper().replace("D", "E")) if found else 0.0


def node_labels(path: Path) -> set[int] | None:
    """The numbers of the nodes in a result file."""
    if not path.exists():
        return None
    with h5py.File(path) as file:
        return set(map(int, file["AMONTONS/mesh/node_label"][:]))


def with_increments(deck: Path, folder: Path) -> Path:
    """The deck in its place, or a copy with the increments of the reference."""
    if deck.stem not in INCREMENTS:
        return deck
    text = deck.read_text()
    assert INCREMENTS[deck.stem][0] in text
    copy = folder / deck.name
    copy.write_text(text.replace(*INCREMENTS[deck.stem]))
    return copy


def read_ours(deck: Path, folder: Path) -> list[Deviation]:
    """The deviations of all blocks of the references of a deck that has run."""
    tables, fields = references(deck)
    if deck.stem in LOOSE:
        tables = tight_tables(deck, folder / "ccx")
    deviations: list[Deviation] = []
    if tables:
        dat = folder / (deck.stem + ".dat")
        ours = read_dat(dat) if dat.exists() else []
        deviations = compare(ours, tables, is_plane(deck),
                             node_labels(folder / (deck.stem + ".vtkhdf")))
    if fields:
        found = read_our_fields(folder / (deck.stem + ".vtkhdf"), fields)
        n_axes = 2 if is_plane(deck) else 3 if has_sections(deck) else 0
        if n_axes > 0:
            places, points = read_frd_places(deck.with_suffix(".frd.ref")), our_places(folder / (deck.stem + ".vtkhdf"))
            found = [expand(block, theirs, places, points, n_axes) for block, theirs in zip(found, fields, strict=True)]
        deviations += compare(found, fields)
    return deviations


def is_plane(deck: Path) -> bool:
    """Whether CalculiX expands its elements into solids."""
    return re.search(r"type\s*=\s*C(PS|PE|AX)", deck.read_text(errors="replace"), re.I) is not None


def has_sections(deck: Path) -> bool:
    """Whether shells or beams are expanded into solids."""
    return re.search(r"^\*(SHELL|BEAM) SECTION", deck.read_text(errors="replace"), re.I | re.M) is not None


def our_places(path: Path) -> dict[int, list[float]]:
    """The coordinates of the nodes of a result file."""
    with h5py.File(path) as file:
        n = int(file["VTKHDF/NumberOfPoints"][0])
        labels = file["AMONTONS/mesh/node_label"][:]
        return {int(label): list(map(float, x)) for label, x in zip(labels, file["VTKHDF/Points"][:n], strict=True)}


def row_of(d: Deviation) -> Row:
    """A line of the table."""
    where = " ".join(map(str, d.where)) + (f"{d.missing} rows missing" if d.missing else "")
    return Row(f"{d.title} {d.set_name}".strip(), d.time, d.largest, d.deviation if d.deviation < np.inf else 1e30, where)


@pytest.mark.parametrize("deck", parameters())
def test_deck(deck: Path, run: Callable[..., object], tmp_path: Path, record: Callable[[Entry], None]) -> None:
    """Every block of a deck that runs is within 1 % of its largest value."""
    entry = Entry(f"{deck.parent.name}/{deck.stem}", is_excluded=deck.stem in NOT_JUDGED, reason=NOT_JUDGED.get(deck.stem, ""))
    result = run(["--dialect=calculix", "--outdir", tmp_path, with_increments(deck, tmp_path)])
    output = result.stdout + result.stderr
    if result.returncode != 0:
        entry.has_run = False
        trouble = refusal(output) if result.returncode == 3 else f"exit {result.returncode}: {(output.strip().splitlines() or [''])[-1][:150]}"
        trouble = trouble.replace(str(deck), deck.name).replace("*ERROR: ", "")
        trouble = trouble.replace("*", "\\*").replace("|", "\\|")
        entry.reason = entry.reason or trouble
        record(entry)
        assert result.returncode == 3 or entry.is_excluded, output[-2000:]
        pytest.skip(entry.reason)
    deviations = read_ours(deck, tmp_path)
    left = leave_out_noise(deviations, youngs_modulus(deck))
    entry.rows = [row_of(d) for d in left]
    if not deviations:
        entry.is_excluded, entry.reason = True, entry.reason or "its reference has nothing that we write"
    elif not left:
        entry.note = f"its {len(deviations)} blocks are nothing but rounding, in the reference and here"
    else:
        entry.note = (UNFINISHED | LOOSE | NOTES).get(deck.stem, "")
    record(entry)
    if entry.reason:
        pytest.skip(entry.reason)
    bad = [d for d in left if not d.deviation <= AGREES]
    assert not bad, "\n".join(f"{d.title} {d.set_name} t={d.time:g}: {100 * d.deviation:.3g} % of {d.largest:.3e}" for d in bad)
