"""Proves the floors of src/depends.mk against the use lines, and the limits of the house against the source.

    lint.py          prints what is wrong, one line each, and exits 1 if there is something
    lint.py --write  first rewrites the lines of depends.mk from the use lines of the files; their order stays yours
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"

MAX_PROCEDURE_LINES = 120
MAX_ARGUMENTS = 9
MAX_NESTING = 4
MAX_FILE_LINES = 900
ROOMS_THAT_STOP = {"main"}
ROOMS_THAT_PRINT = {"main", "journal"}

PREFIX = r"(?:(?:pure|impure|elemental|recursive|non_recursive|module|(?:integer|real|logical|character|type|class)\s*\([^)]*\)|integer|real|logical)\s+)*"
PROCEDURE = re.compile(rf"^{PREFIX}(?P<kind>subroutine|function)\s+(?P<name>\w+)\s*(?:\((?P<arguments>[^)]*)\))?", re.I)
END_PROCEDURE = re.compile(r"^end\s+(?:subroutine|function)\b", re.I)
OPENS = re.compile(
    r"^(?:\w+\s*:\s*)?(?:if\s*\(.*\)\s*then|do\b|select\s+(?:case|type|rank)|associate\b|block\s*$|critical\b"
    r"|(?:where|forall)\s*\(.*\)\s*$)", re.I)
CLOSES = re.compile(r"^end\s+(?:if|do|select|associate|block|critical|where|forall)\b", re.I)
TYPE = re.compile(r"^type\s*(?:,|::|\s\w)", re.I)
STOP = re.compile(r"(?:^|\)\s*)(?:error\s+)?stop(?:\s|$|\()", re.I)
PRINT = re.compile(r"^print\b|\bwrite\s*\(\s*(?:\*|6|output_unit|error_unit)\s*,", re.I)
USE = re.compile(r"^use\s+amontons_(\w+)", re.I)
THEORY_HEADING = re.compile(r"^#+ .*\[([^\]]+)\]$")
FLOOR_ROW = re.compile(r"^\| \d \w+ \|([^|]*)\|")
SEARCH_PATH = re.compile(r"\bsys\.path\b")
NOT_A_VARIABLE = re.compile(r"^(?:use|public|private|procedure|generic|import|type|interface|end)\b", re.I)


@dataclass
class Statement:
    """One statement, continuation lines joined, comments and the text of strings taken out."""

    line: int
    text: str


@dataclass
class Procedure:
    """A procedure that the reader of the file is inside of."""

    name: str
    line: int
    nesting: int = 0
    deepest: int = 0


@dataclass
class Room:
    """What one file of src says about itself."""

    name: str
    lines: list[str]
    uses: list[str] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)

    def complain(self, line: int, text: str) -> None:
        """Adds one trouble at a line (counted from 1)."""
        self.troubles.append(f"src/{self.name}.f90:{line}: {text}")


def strip_text(line: str) -> str:
    """The line without its comment and without what stands in its strings."""
    line = re.sub(r"'[^']*'|\"[^\"]*\"|!.*", lambda match: "" if match.group()[0] == "!" else "''", line)
    return line.strip()


def statements(lines: list[str]) -> Iterator[Statement]:
    """The statements of a file in order."""
    start, text = 0, ""
    for number, line in enumerate(lines, 1):
        part = strip_text(line)
        if not part:
            continue
        start = start or number
        text += part.lstrip("&").removesuffix("&")
        if not part.endswith("&"):
            yield Statement(start, text.strip())
            start, text = 0, ""


def check_lines(room: Room) -> None:
    """Length of the file, its first two lines. (The length of the lines is fortitude's.)"""
    if len(room.lines) > MAX_FILE_LINES:
        room.complain(len(room.lines), f"the file has {len(room.lines)} lines, allowed are {MAX_FILE_LINES}")
    if not room.lines or not room.lines[0].startswith("!> "):
        room.complain(1, "the first line is not `!> One sentence what this room is.`")
    if "SPDX-License-Identifier: GPL-3.0-or-later" not in "".join(room.lines[:3]):
        room.complain(2, "the licence line is missing")


def check_procedure_head(room: Room, statement: Statement, match: re.Match[str]) -> None:
    """Docstring and number of arguments."""
    above = room.lines[statement.line - 2].strip() if statement.line > 1 else ""
    if not above.startswith("!"):
        room.complain(statement.line, f"{match['name']} has no docstring")
    arguments = [name for name in (match["arguments"] or "").split(",") if name.strip()]
    if len(arguments) > MAX_ARGUMENTS:
        room.complain(statement.line, f"{match['name']} has {len(arguments)} arguments, allowed are {MAX_ARGUMENTS}")


def check_procedure_end(room: Room, procedure: Procedure, last_line: int) -> None:
    """Length and nesting."""
    n_lines = last_line - procedure.line + 1
    if n_lines > MAX_PROCEDURE_LINES:
        room.complain(procedure.line, f"{procedure.name} has {n_lines} lines, allowed are {MAX_PROCEDURE_LINES}")
    if procedure.deepest > MAX_NESTING:
        room.complain(procedure.line, f"{procedure.name} nests {procedure.deepest} deep, allowed are {MAX_NESTING}")


def check_statement(room: Room, statement: Statement) -> None:
    """What no room may say, whatever surrounds it."""
    if STOP.search(statement.text) and room.name not in ROOMS_THAT_STOP:
        room.complain(statement.line, "stop: only main.f90 stops")
    if PRINT.search(statement.text) and room.name not in ROOMS_THAT_PRINT:
        room.complain(statement.line, "this writes to the screen: only the journal does")
    if re.match(r"use\b", statement.text, re.I) and not re.search(r",\s*only\s*:", statement.text, re.I):
        room.complain(statement.line, "use without only")
    if re.search(r"(?:^|,\s*)save\b", statement.text, re.I):
        room.complain(statement.line, "save: nothing is hidden in this house")


def check_declaration(room: Room, statement: Statement) -> None:
    """No variables in the head of a module."""
    attributes, separator, names = statement.text.partition("::")
    if separator and not NOT_A_VARIABLE.match(statement.text) and "parameter" not in attributes.lower():
        room.complain(statement.line, f"module variable: {names.strip()}")


def read_statements(room: Room) -> None:
    """Walks through the file once: heads, bodies and ends of modules, types, interfaces and procedures."""
    stack: list[Procedure] = []
    outside = {"type": 0, "interface": 0}
    is_head = False
    for statement in statements(room.lines):
        text = statement.text
        lower = text.lower()
        check_statement(room, statement)
        if use := USE.match(text):
            room.uses.append(use[1].lower())
        if re.match(r"(?:abstract\s+)?interface\b", lower):
            outside["interface"] += 1
        elif re.match(r"end\s+interface\b", lower):
            outside["interface"] -= 1
        if outside["interface"]:
            continue
        if match := re.match(r"(?:module|program)\s+(\w+)$", lower):
            is_head = match[0].startswith("module")
            if is_head and match[1] != f"amontons_{room.name}":
                room.complain(statement.line, f"the module is {match[1]}, the file wants amontons_{room.name}")
        elif TYPE.match(text) and not re.match(r"type\s*\(", lower):
            outside["type"] += 1
        elif re.match(r"end\s+type\b", lower):
            outside["type"] -= 1
        elif lower == "contains" and not outside["type"]:
            is_head = False
        elif is_head and not outside["type"]:
            check_declaration(room, statement)
        walk_procedures(room, statement, stack)


def walk_procedures(room: Room, statement: Statement, stack: list[Procedure]) -> None:
    """Keeps the stack of open procedures and the depth of the blocks in the innermost one."""
    if END_PROCEDURE.match(statement.text):
        if stack:
            check_procedure_end(room, stack.pop(), statement.line)
    elif match := PROCEDURE.match(statement.text):
        check_procedure_head(room, statement, match)
        stack.append(Procedure(match["name"], statement.line))
    elif stack and CLOSES.match(statement.text):
        stack[-1].nesting -= 1
    elif stack and OPENS.match(statement.text):
        stack[-1].nesting += 1
        stack[-1].deepest = max(stack[-1].deepest, stack[-1].nesting)


def read_room(path: Path) -> Room:
    """One file of src with all that is wrong in it."""
    room = Room(path.stem, path.read_text().splitlines())
    check_lines(room)
    read_statements(room)
    room.uses = list(dict.fromkeys(name for name in room.uses if name != room.name))
    return room


def read_floors() -> dict[str, list[str]]:
    """depends.mk: each room and the rooms it says that it uses, in the order of the file."""
    text = (SOURCE / "depends.mk").read_text().replace("\\\n", " ")
    return {match[1]: match[2].split() for match in re.finditer(r"^uses_(\w+)\s*=(.*)$", text, re.M)}


def repeated_rooms() -> list[str]:
    """Rooms that stand twice in depends.mk, where only the last line of a name counts."""
    names = re.findall(r"^uses_(\w+)", (SOURCE / "depends.mk").read_text(), re.M)
    return [f"src/depends.mk: {name} stands twice" for name in sorted(set(names)) if names.count(name) > 1]


def check_floors(rooms: dict[str, Room], floors: dict[str, list[str]]) -> list[str]:
    """Upward, stale and missing uses; rooms that are there no more."""
    order = {name: place for place, name in enumerate(floors)}
    troubles = [f"src/depends.mk: {name} is not in src" for name in floors if name not in rooms]
    for name, room in rooms.items():
        if name not in floors:
            troubles.append(f"src/depends.mk: {name} is missing")
            continue
        said = floors[name]
        for used in room.uses:
            if used not in order or order[used] >= order[name]:
                troubles.append(f"src/depends.mk: {name} uses {used}, which does not stand below it")
            if used not in said:
                troubles.append(f"src/depends.mk: {name} uses {used}, and that is missing")
        troubles += [f"src/depends.mk: {name} does not use {used}: stale" for used in said if used not in room.uses]
    return troubles


def write_uses(rooms: dict[str, Room], floors: dict[str, list[str]]) -> None:
    """Rewrites the uses of depends.mk for the rooms that exist, each in the order of the floors."""
    order = {name: place for place, name in enumerate(floors)}

    def line_of(match: re.Match[str]) -> str:
        if match[1] not in rooms:
            return match[0]
        uses = sorted(rooms[match[1]].uses, key=lambda used: order.get(used, len(order)))
        return f"uses_{match[1]} = {' '.join(uses)}".rstrip()

    path = SOURCE / "depends.mk"
    path.write_text(re.sub(r"^uses_(\w+)\s*=.*$", line_of, path.read_text().replace("\\\n", " "), flags=re.M))


def check_documents(names: set[str], root: Path) -> list[str]:
    """Rooms that the documentation sends a reader to are there: in brackets in headings of the theory, and in the table of floors."""
    troubles = []
    for page in [*sorted((root / "doc" / "theory").glob("*.md")), root / "doc" / "developer" / "architecture.md"]:
        for number, line in enumerate(page.read_text().splitlines(), 1):
            if heading := THEORY_HEADING.match(line):
                told = [word.partition(":")[0].strip() for word in heading[1].split(",")]
            elif floor := FLOOR_ROW.match(line):
                told = re.findall(r"`(\w+)`", floor[1])
            else:
                continue
            troubles += [f"{page.relative_to(root)}:{number}: there is no room {name}" for name in told if name not in names]
    return troubles


def check_search_paths(root: Path) -> list[str]:
    """No Python file or page changes where Python searches: all imports start at `verify` or `amontons`."""
    files = sorted(path for folder in ("verify", "python", "doc") for ending in ("*.py", "*.md") for path in (root / folder).rglob(ending))
    return [f"{path.relative_to(root)}:{number}: the search path of Python is changed; import from the package verify"
            for path in files for number, line in enumerate(path.read_text().splitlines(), 1) if SEARCH_PATH.search(line)]  # fmt: skip


def main() -> int:
    """See the top of this file."""
    rooms = {path.stem: read_room(path) for path in sorted(SOURCE.glob("*.f90"))}
    floors = read_floors()
    if "--write" in sys.argv:
        write_uses(rooms, floors)
        floors = read_floors()
    troubles = check_floors(rooms, floors) + repeated_rooms() + check_documents(set(rooms), ROOT) + check_search_paths(ROOT)
    troubles += [trouble for room in rooms.values() for trouble in room.troubles]
    print("\n".join(troubles or [f"lint: {len(rooms)} rooms, nothing wrong."]))
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
