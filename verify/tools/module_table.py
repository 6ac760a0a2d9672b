"""Writes the page of all rooms from src/depends.mk and the first line of each file:

    python -m verify.tools.module_table > doc/developer/rooms.md

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2] / "src"
FLOOR = re.compile(r"^# (\d) (\w+): (.*)$")
ROOM = re.compile(r"^uses_(\w+)\s*=(.*)$")


def first_sentence(room: str) -> str:
    """What the room says of itself."""
    line = (SOURCE / f"{room}.f90").read_text().splitlines()[0]
    return line.removeprefix("!> ").replace("*", "\\*").replace("|", "\\|")


def page() -> str:
    """A table for each floor, from the ground up."""
    lines = ["# All rooms", "", "Written by `make doc` from `src/depends.mk` and the first lines of the files, from the ground up."]
    for line in (SOURCE / "depends.mk").read_text().replace("\\\n", " ").splitlines():
        if floor := FLOOR.match(line):
            lines += ["", f"## {floor[1]} {floor[2]}", "", f"{floor[3][0].upper()}{floor[3][1:]}.", "", "| room | what it is | uses |", "|---|---|---|"]
        elif room := ROOM.match(line):
            lines.append(f"| `{room[1]}` | {first_sentence(room[1])} | {room[2].strip().replace(' ', ', ')} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(page())
