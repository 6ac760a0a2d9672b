"""Reads the printed results of CalculiX (.dat) and its fields (.frd), and compares block by block.

A block is one table: a title, a set, a time, and rows of numbers by their labels (node; element and point). The
deviation of a block is the largest difference over the largest absolute value of the reference's block. The statistics of a surface are
one block with several heads: their forces and moments are measured by the largest of its force and moment.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

Key = tuple[int, ...]

NUMBER = re.compile(r"[+-]?(?:\d+\.\d*|\.\d+)(?:[EeDd]?[+-]\d+)?|[+-]?(?:NaN|Inf\w*)|[+-]?\d+")
TIME = re.compile(r"time\s+(\S+)")
PARTS = ("total surface force", "total normal surface force", "total shear surface force", "center of gravity",
         "moment about the center", "area")  # of the statistics of a surface
SET = re.compile(r"for (?:set|surface set|slave set) (\S+)")


@dataclass
class Block:
    """One table."""

    title: str
    set_name: str
    time: float
    rows: dict[Key, list[float]] = field(default_factory=dict)
    scale: float = 0.0  # that the values are measured by, if it is larger than their largest
    head: str = ""  # its line
    repeats: dict[Key, int] = field(default_factory=dict)
    is_repeated: bool = False  # several rows have one label: points of a face; the later ones have their number behind it

    @property
    def largest(self) -> float:
        """The largest absolute value."""
        return max((abs(v) for row in self.rows.values() for v in row), default=0.0)

    @property
    def name(self) -> tuple[str, str, float]:
        """The key of the block among others."""
        return self.title, self.set_name, round(self.time, 6)


def read_dat(path: Path) -> list[Block]:
    """All blocks of a .dat file, in their order."""
    blocks: list[Block] = []
    for line in path.read_text().splitlines():
        words = line.split()
        if not words or line.replace(" ", "").startswith(("STEP", "INCREMENT")):
            continue
        if re.match(r"\s*[a-z]", line):
            blocks.append(make_block(line))
        elif blocks:
            add_row(blocks[-1], line)
    return share_statistics(blocks)


def share_statistics(blocks: list[Block]) -> list[Block]:
    """Gives the parts of a surface's statistics its name, time and scale; parts the area from the forces beside it."""
    result: list[Block] = []
    head = Block("", "", 0.0)
    scale = 0.0
    for block in blocks:
        if block.title == "statistics":
            head, scale = block, 0.0
        elif block.set_name or not (head.title and block.title.startswith(PARTS)):
            result.append(block)
        else:
            block.set_name, block.time = head.set_name, head.time
            if block.title.startswith("total"):
                scale = block.largest
            if block.title.startswith("area"):
                areas = {key: row[:1] for key, row in block.rows.items()}
                result.append(Block("area", block.set_name, block.time, areas))
                block.title, block.rows = "normal force", {key: row[1:] for key, row in block.rows.items()}
            if not block.title.startswith("center"):
                block.scale = scale
            result.append(block)
    return result


def make_block(line: str) -> Block:
    """The head of a block."""
    time = TIME.search(line)
    name = SET.search(line)
    title = re.split(r"\(| for ", line.strip())[0].strip()
    return Block(title, name.group(1).rstrip(",").upper() if name else "", float(time.group(1)) if time else 0.0, head=line)


def add_row(block: Block, line: str) -> None:
    """One row: whole numbers in front are its label."""
    key: list[int] = []
    values: list[float] = []
    for word in NUMBER.findall(line):
        if not values and re.fullmatch(r"\d+", word):
            key.append(int(word))
        else:
            values.append(float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", word.replace("D", "E")) if "E" not in word.upper()
                                else word.replace("D", "E")))
    if not values:
        return
    label = tuple(key) or (len(block.rows) + 1,)
    if label in block.rows and "element+face" in block.head:
        block.is_repeated = True
        block.repeats[label] = block.repeats.get(label, 1) + 1
        label = (*label, block.repeats[label])
    block.rows[label] = values


@dataclass
class Deviation:
    """How far a block is from its reference."""

    title: str
    set_name: str
    time: float
    largest: float  # of the reference
    deviation: float  # over the largest; infinite if it is not there
    where: Key = ()
    missing: int = 0  # rows of the reference that are not there
    ours: float = 0.0  # our largest absolute value


def compare(ours: list[Block], reference: list[Block], is_expanded: bool = False,
            nodes: set[int] | None = None) -> list[Deviation]:
    """The deviation of every block of the reference, which is looked up by title, set and time.

    CalculiX prints zeros for numbers of a set that no node has; with `nodes`, the labels that there are, these are left out.

    CalculiX expands plane and axisymmetric elements into solids and prints the points of these. With `is_expanded`
    tables of points that have more rows there than here are compared by the extremes of each column.
    """
    found: dict[tuple[str, str, float], list[Block]] = {}
    for block in ours:
        found.setdefault(block.name, []).append(block)
    result = []
    for block in reference:
        candidates = found.get(block.name, [])
        mine = candidates.pop(0) if candidates else None
        if nodes is not None and all(len(key) == 1 for key in block.rows):
            block.rows = {key: row for key, row in block.rows.items() if key[0] in nodes or any(row)}
        is_by_point = is_expanded and mine is not None and len(block.rows) > len(mine.rows) and len(next(iter(block.rows))) == 2
        result.append(compare_extremes(mine, block) if is_by_point and mine else compare_block(mine, block))
    return result


def compare_extremes(ours: Block, reference: Block) -> Deviation:
    """Largest and least value of each column against those of the reference."""
    theirs, mine = (np.array(list(block.rows.values())) for block in (reference, ours))
    largest = float(np.abs(theirs).max())
    if theirs.shape[1] == 6:  # the shears out of the plane are those of points beside it, whose radial direction is turned
        theirs, mine = theirs[:, :4], mine[:, :4]
    ends = [np.abs(side(theirs, axis=0) - side(mine, axis=0)).max() for side in (np.max, np.min)]
    return Deviation(reference.title, reference.set_name, reference.time, largest, float(max(ends)) / largest, ours=ours.largest)


def compare_block(ours: Block | None, reference: Block) -> Deviation:
    """One block against its reference."""
    largest = max(reference.largest, reference.scale)
    result = Deviation(reference.title, reference.set_name, reference.time, largest, 0.0)
    if ours is None:
        result.deviation = np.inf
        return result
    result.ours = ours.largest
    if reference.is_repeated:
        return compare_faces(ours, reference, result)
    for key, row in reference.rows.items():
        if key not in ours.rows:
            result.missing += 1
            continue
        n = min(len(row), len(ours.rows[key]))
        difference = float(np.max(np.abs(np.array(row[:n]) - ours.rows[key][:n])))
        if largest > 0:
            difference /= largest
        if not difference <= result.deviation:
            result.deviation, result.where = difference, key
    if result.missing:
        result.deviation = np.inf
    return result


def compare_faces(ours: Block, reference: Block, result: Deviation) -> Deviation:
    """The points of each face, each column by size: which of a face's points comes first is no matter. Where a face has not the same number
    of closed points, the extremes are compared; a face that is not there is missing.
    """
    for face in {key[:2] for key in reference.rows}:
        theirs, mine = (np.array([row for key, row in block.rows.items() if key[:2] == face]) for block in (reference, ours))
        if not len(mine):
            result.missing += 1
            result.deviation = np.inf
            continue
        ends = [np.abs(side(theirs, axis=0) - side(mine, axis=0)).max() for side in (np.max, np.min)]
        if len(theirs) == len(mine):
            ends = [np.abs(np.sort(theirs, axis=0) - np.sort(mine, axis=0)).max()]
        if max(ends) / max(result.largest, 1e-300) > result.deviation:
            result.deviation, result.where = float(max(ends) / result.largest), face
    return result


def read_frd(path: Path) -> list[Block]:
    """The nodal fields of a .frd file in text form, in their order; the title is the field's name."""
    blocks: list[Block] = []
    time, is_open = 0.0, False
    for line in path.read_text(errors="replace").splitlines():
        if line.startswith("  100C"):
            time = float(line[12:24])
        elif line.startswith(" -4"):
            blocks.append(Block(line[5:13].strip(), "", time))
            is_open = True
        elif line.startswith(" -3"):
            is_open = False
        elif is_open and line.startswith(" -1"):
            values = [float(line[i : i + 12]) for i in range(13, len(line.rstrip()) - 11, 12)]
            blocks[-1].rows[(int(line[3:13]),)] = values
    return [block for block in blocks if block.rows]


def read_frd_places(path: Path) -> dict[int, list[float]]:
    """The coordinates of the nodes of a .frd file in text form."""
    places: dict[int, list[float]] = {}
    is_open = False
    for line in path.read_text(errors="replace").splitlines():
        if line.startswith("    2C"):
            is_open = True
        elif line.startswith(" -3"):
            is_open = False
        elif is_open and line.startswith(" -1"):
            places[int(line[3:13])] = [float(line[i : i + 12]) for i in (13, 25, 37)]
    return places


def expand(ours: Block, reference: Block, places: dict[int, list[float]], points: dict[int, list[float]], n_axes: int) -> Block:
    """Our block with the numbers of the nodes into which CalculiX expanded a plane mesh (2 axes), or shells and beams (3).

    An expanded node of a plane mesh has the place of its node in the plane. Where several of our nodes are in one place (on both sides
    of a section, in a knot) the one whose row is nearest is taken.
    """
    rows: dict[Key, list[float]] = {}
    for key, row in reference.rows.items():
        near = [label for label, x in points.items() if np.allclose(x[:n_axes], places[key[0]][:n_axes], atol=1e-5) and (label,) in ours.rows]
        if near:
            best = min(near, key=lambda label: float(np.abs(np.array(row) - ours.rows[(label,)][: len(row)]).max()))
            rows[key] = ours.rows[(best,)]
    return Block(ours.title, ours.set_name, ours.time, rows)
