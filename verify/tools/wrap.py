"""Wraps the prose of the pages at 132 columns, and finds what is longer.

    python3 -m verify.tools.wrap              wraps all pages of the repository
    python3 -m verify.tools.wrap PAGE ...     wraps these

A paragraph is filled anew from its first line that is too long; words stay in their order, formulas and code are not broken. Tables,
headings, pictures, code and the pages that `make verify` writes may be longer: they cannot be broken, or are generated.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WIDTH = 132
FOLDERS = ("doc", "python", "src", "verify")
WRITTEN = re.compile(r"^(?:`make verify` writes this page|Written by `make verify`)", re.M)
WRITTEN_PAGES = {"doc/verification/index.md", "doc/verification/hard-contact.md", "doc/manual/cards.md", "doc/developer/modules.md"}
ATOM = re.compile(r"(?:[^\s`$]*(?:`[^`]+`|\$[^$]+\$))+[^\s`$]*|\S+")
ITEM = re.compile(r"\s*(?:[-*+]|\d+\.)\s+")
OPENS_A_BLOCK = re.compile(r"(?:[-*+>|#:]|\d+[.)])(?:\s|$)|[#|>:]|---")
NO_PROSE = re.compile(r"\s*(?:$|\||#|!\[|```|\$\$|<|>|---|:::|!!!|\[\^)| {4}")


def prose(lines: list[str]) -> Iterator[int]:
    """The numbers (from 0) of the lines that can be wrapped."""
    in_code = in_formula = False
    for number, line in enumerate(lines):
        text = line.lstrip()
        in_code ^= text.startswith("```")
        in_formula ^= not in_code and text.startswith("$$") and text.count("$$") == 1
        if not in_code and not in_formula and not NO_PROSE.match(line):
            yield number


def too_long(text: str) -> list[int]:
    """The numbers (from 1) of the lines of prose beyond the width; a line of one word cannot be shorter."""
    lines = text.split("\n")
    return [number + 1 for number in prose(lines) if len(lines[number]) > WIDTH and len(ATOM.findall(ITEM.sub("", lines[number], count=1))) > 1]


def filled(text: str, first: str, rest: str) -> list[str]:
    """The words of a text in lines; no line begins with a sign that opens a list, a heading or a table."""
    lines: list[str] = []
    current = first
    for word in ATOM.findall(text):
        is_begun = current not in (first, rest) or (bool(lines) and current != rest)
        if is_begun and len(current) + 1 + len(word) > WIDTH and not OPENS_A_BLOCK.match(word):
            lines.append(current)
            current = rest + word
        else:
            current += (" " if is_begun else "") + word
    return [*lines, current]


def wrapped(text: str) -> str:
    """A page with its prose within the width."""
    lines = text.split("\n")
    soft = {number for number in prose(lines) if not lines[number].endswith("  ")}
    made: list[str] = []
    number = 0
    while number < len(lines):
        line = lines[number]
        if number not in soft or len(line) <= WIDTH:
            made.append(line)
            number += 1
            continue
        item = ITEM.match(line)
        indent = re.match(r"\s*", line)
        assert indent
        first = item.group() if item else indent.group()
        rest = " " * len(first)
        part = [line[len(first) :]]
        number += 1
        while number in soft and not ITEM.match(lines[number]) and re.match(rest + r"\S", lines[number]):
            part.append(lines[number].strip())
            number += 1
        made += filled(" ".join(part), first, rest)
    return "\n".join(made)


def pages(root: Path = ROOT) -> list[Path]:
    """The pages that people edit."""
    found = [*root.glob("*.md"), *(page for folder in FOLDERS for page in (root / folder).rglob("*.md"))]
    return sorted(page for page in found if page.relative_to(root).as_posix() not in WRITTEN_PAGES and not WRITTEN.search(page.read_text()))


def check_widths(root: Path = ROOT) -> list[str]:
    """Lines of prose beyond the width."""
    return [f"{name}:{number}: longer than {WIDTH} columns; `python3 -m verify.tools.wrap {name}` wraps it"
            for page in pages(root) for name in [page.relative_to(root).as_posix()] for number in too_long(page.read_text())]  # fmt: skip


def main() -> int:
    """See the top of this file."""
    for page in [Path(name) for name in sys.argv[1:]] or pages():
        text = page.read_text()
        if (new := wrapped(text)) != text:
            page.write_text(new)
            print(page)
    return 0


if __name__ == "__main__":
    sys.exit(main())
