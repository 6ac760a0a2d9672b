"""Turns `amontons --cards` into the card reference of the manual (Markdown).

    bin/amontons --cards | python -m verify.tools.card_reference > doc/manual/cards.md

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

MANUAL = Path(__file__).resolve().parents[2] / "doc" / "manual"
MAX_LINES = 7  #: of an example

HEAD = """# Cards

Written by `make doc` from `amontons --cards`, which comes from the table by which decks are read. A parameter that is *refused*
ends the job before it starts, with the sentence shown; one *without effect* is accepted, and a note says so. The examples are cut from
decks that the tests run. Two more lists stand at the end: [cards read past with a note](#cards-read-past-with-a-note) and
[cards refused](#cards-refused).

"""

#: The headings of the last two lists, by the first words of their line in `--cards`.
PASSED_OVER = {"Cards read past with a note": "Cards read past with a note", "Cards refused": "Cards refused"}
INTRODUCTIONS = {
    "Cards read past with a note": "They cannot change the solution. The note in the output says where they stand and why they have no effect.",
    "Cards refused": "They end the job before it starts, with the sentence on the right: what to do instead.",
}


@dataclass
class Card:
    """One card as `--cards` prints it."""

    name: str
    place: str
    sentence: str = ""
    data: str = ""
    dialects: str = ""
    taken: list[tuple[str, str]] = field(default_factory=list)
    ignored: dict[str, list[str]] = field(default_factory=dict)
    refused: dict[str, list[str]] = field(default_factory=dict)


def read_cards(text: str) -> list[Card]:
    """All cards that are used, in the order of the table."""
    cards: list[Card] = []
    for line in text.splitlines():
        if line.startswith(tuple(PASSED_OVER)):
            break
        head = re.match(r"(\*[A-Z][A-Z0-9 -]*?)  \((.*)\)$", line)
        if head:
            cards.append(Card(head.group(1), head.group(2)))
        elif line.strip():
            _add_line(cards[-1], line.strip())
    return cards


def _add_line(card: Card, line: str) -> None:
    """The sentence, the data lines, or a parameter."""
    if line.startswith("data lines: "):
        card.data = line.removeprefix("data lines: ")
        return
    if line.startswith("dialects: "):
        card.dialects = line.removeprefix("dialects: ")
        return
    if not card.sentence:
        card.sentence = line
        return
    name, _, rest = line.partition(": ")
    for word, group in (("no effect.", card.ignored), ("refused.", card.refused)):
        if rest.startswith(word):
            group.setdefault(rest.removeprefix(word).strip(), []).append(name.split("=")[0])
            return
    card.taken.append((name, rest))


def read_other_cards(text: str) -> dict[str, list[tuple[str, list[str]]]]:
    """Heading of each of the last two lists to its sentences, each with the cards that it is about."""
    lists: dict[str, list[tuple[str, list[str]]]] = {}
    groups: list[tuple[str, list[str]]] | None = None
    for line in text.splitlines():
        start = next((words for words in PASSED_OVER if line.startswith(words)), None)
        if start:
            groups = lists.setdefault(PASSED_OVER[start], [])
        elif groups is not None and line.startswith("    *"):
            groups[-1][1].append(line.strip())
        elif groups is not None and line.strip():
            groups.append((line.strip(), []))
    return lists


def page_of(text: str) -> str:
    """The page, from what `amontons --cards` prints: a list of all cards, each of them, those read past, those refused."""
    cards = read_cards(text)
    links = ", ".join(f"[`{c.name}`](#{anchor(c.name)})" for c in cards)
    examples = find_examples()
    others = "\n".join(other_section(*entry) for entry in read_other_cards(text).items())
    return HEAD + links + "\n\n" + "\n".join(section(card, examples) for card in cards) + "\n" + others


def other_section(heading: str, groups: list[tuple[str, list[str]]]) -> str:
    """A list of cards that are not used, by their sentences."""
    rows = [f"| {', '.join(f'`{name}`' for name in names)} | {plain(sentence)} |" for sentence, names in groups]
    return "\n".join([f"## {heading}", "", INTRODUCTIONS[heading], "", "| cards | |", "|---|---|", *rows, ""])


def anchor(name: str) -> str:
    """The anchor that Markdown makes of a heading."""
    return name.lower().lstrip("*").replace(" ", "-")


def plain(text: str) -> str:
    """Text in which no asterisk starts an emphasis."""
    return text.replace("*", "\\*").replace("|", "/")


def example_files() -> list[Path]:
    """The decks from which examples are cut, and the pages on user routines and submodels, which have cards more."""
    return [*sorted((MANUAL / "examples").glob("*.inp")), *sorted((MANUAL / "examples").glob("*.mesh")), MANUAL / "user_routines.md", MANUAL / "submodels.md"]


def find_examples() -> dict[str, tuple[Path, list[str]]]:
    """Card to the file where it stands first, and its lines there."""
    found: dict[str, tuple[Path, list[str]]] = {}
    for path in example_files():
        name = ""
        for line in path.read_text().splitlines():
            match = re.match(r"\*([A-Z][A-Z -]*[A-Z])(?=,|$)", line)
            if match or line.startswith(("**", "```")):
                name = f"*{match.group(1)}" if match else ""
                if not match or name in found:
                    name = ""
                    continue
                found[name] = (path, [line])
            elif name:
                found[name][1].append(line)
    return found


def example_of(card: Card, examples: dict[str, tuple[Path, list[str]]]) -> list[str]:
    """The example of a card, if there is one."""
    if card.name not in examples:
        return []
    path, lines = examples[card.name]
    shown = [line for line in lines if line] if card.name != "*SPRING" else lines
    shown = shown if len(shown) <= MAX_LINES else [*shown[: MAX_LINES - 1], "..."]
    return [f"From [{path.name}]({path.relative_to(MANUAL)}):", "", "```", *shown, "```", ""]


def section(card: Card, examples: dict[str, tuple[Path, list[str]]]) -> str:
    """One card."""
    lines = [f"## {plain(card.name)}", "", f"{plain(card.sentence)} *({plain(card.place)})*", ""]
    if card.taken:
        lines += ["| parameter | |", "|---|---|"]
        lines += [f"| `{name.replace('|', '/')}` | {plain(text)} |" for name, text in card.taken] + [""]
    if card.dialects:
        lines += [f"Dialects: {plain(card.dialects)}", ""]
    if card.data:
        lines += [f"Data lines: {plain(card.data)}.", ""]
    for title, groups in (("Without effect", card.ignored), ("Refused", card.refused)):
        if groups:
            listed = [f"`{'`, `'.join(names)}`" + (f" ({plain(why.rstrip('.'))})" if why else "") for why, names in groups.items()]
            lines += [f"{title}: " + "; ".join(listed) + ".", ""]
    return "\n".join(lines + example_of(card, examples))


if __name__ == "__main__":
    sys.stdout.write(page_of(sys.stdin.read()))
