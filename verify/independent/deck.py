"""A second, small deck reader: the facts that a check needs: mesh, sets, materials, contact pairs, supports.

It knows the cards that the decks of input/ use; a card that would change the physics and that it does not know is an
error, so that a check never passes on half of a model.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Local nodes (from 0) of the faces S1 to S6 of a hexahedron, outward by the right-hand rule.
HEX_FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])

SILENT = {
    "HEADING", "END STEP", "CONTROLS", "LINE SEARCH", "NODE PRINT", "EL PRINT", "CONTACT PRINT", "NODE FILE", "EL FILE",
    "CONTACT FILE", "NODE OUTPUT", "ELEMENT OUTPUT", "CONTACT OUTPUT", "OUTPUT", "SURFACE BEHAVIOR", "DENSITY",
}  # fmt: skip
FIXED_TYPES = {"ENCASTRE": (1, 2, 3), "PINNED": (1, 2, 3), "XSYMM": (1,), "YSYMM": (2,), "ZSYMM": (3,)}


class DeckError(Exception):
    """The deck has a card that this reader does not support."""


@dataclass
class Card:
    """A keyword line with its data lines."""

    name: str
    options: dict[str, str]
    data: list[list[str]]


@dataclass
class Pair:
    """A contact pair: surface names and the coefficient of friction."""

    slave: str
    master: str
    interaction: str


@dataclass
class Step:
    """A load step: its period, whether large displacements count, and the held degrees of freedom."""

    period: float = 1.0
    is_nlgeom: bool = False
    held: dict[int, set[int]] = field(default_factory=dict)  #: node index: dofs 1 to 3
    loaded: set[int] = field(default_factory=set)  #: nodes that a CLOAD names
    is_loaded: bool = False  #: has a DLOAD


@dataclass
class Deck:
    """The model, with indices from 0 in the order of the deck."""

    labels: Ints  #: (n_nodes)
    nodes: Floats  #: (n_nodes, 3)
    element_labels: Ints  #: (n_elements)
    elements: Ints  #: (n_elements, 8)
    node_sets: dict[str, list[int]]
    element_sets: dict[str, list[int]]
    surfaces: dict[str, list[tuple[int, int]]]  #: element index, face 1 to 6; face 0: a node index
    materials: dict[str, tuple[float, float]]  #: E, nu
    sections: list[tuple[str, str]]  #: element set, material
    friction: dict[str, float]  #: by interaction
    pairs: list[Pair]
    steps: list[Step]
    dialect: str

    def elastic(self) -> Floats:
        """(n_elements, 2) E and nu of each element."""
        values = np.full((len(self.elements), 2), np.nan)
        for elset, material in self.sections:
            values[self.element_sets[elset]] = self.materials[material]
        if np.isnan(values).any():
            raise DeckError("an element has no section")
        return values

    def facets(self, surface: str) -> Ints:
        """(n_facets, 4) node indices of a surface of element faces, outward."""
        return np.array([self.elements[e][HEX_FACES[face - 1]] for e, face in self.surfaces[surface]])

    def surface_nodes(self, surface: str) -> Ints:
        """The nodes of a surface, each once, ascending."""
        entries = self.surfaces[surface]
        if entries and entries[0][1] == 0:
            return np.unique([node for node, _ in entries])
        return np.unique(self.facets(surface))

    def bodies(self) -> Ints:
        """(n_nodes) number of the connected piece that each node belongs to."""
        owner = np.arange(len(self.nodes))
        while True:
            least = owner[self.elements].min(axis=1)
            new = owner.copy()
            np.minimum.at(new, self.elements.ravel(), np.repeat(least, self.elements.shape[1]))
            new = new[new]
            if np.array_equal(new, owner):
                return np.unique(owner, return_inverse=True)[1]
            owner = new

    def step_at(self, time: float) -> int:
        """The step (from 0) in which a total time lies; its end belongs to it."""
        ends = np.cumsum([step.period for step in self.steps])
        return min(int(np.searchsorted(ends, time * (1 - 1e-9) - 1e-12)), len(self.steps) - 1)


def read_deck(text: str, folder: Path | None = None) -> Deck:
    """Read a deck; INCLUDE files are looked for in the folder."""
    cards = list(_cards(_lines(text, folder)))
    reader = _Reader()
    for card in cards:
        reader.take(card)
    first = text.split("*NODE")[0].lower().replace(" ", "")
    return reader.finish("calculix" if "**dialect:calculix" in first else "abaqus")


def _lines(text: str, folder: Path | None) -> Iterator[str]:
    """The lines of a deck, includes in place, without comments."""
    for line in text.splitlines():
        squeezed = line.strip()
        if squeezed.startswith("**") or not squeezed:
            continue
        if squeezed.upper().replace(" ", "").startswith("*INCLUDE"):
            name = squeezed.split("=", 1)[1].strip().strip('"')
            if folder is None:
                raise DeckError(f"INCLUDE of {name}: the folder is not known")
            yield from _lines((folder / name).read_text(), folder)
        else:
            yield squeezed


def _cards(lines: Iterator[str]) -> Iterator[Card]:
    """Keyword lines with their data."""
    card: Card | None = None
    for line in lines:
        if not line.startswith("*"):
            if card is not None:
                card.data.append([part.strip() for part in line.rstrip(",").split(",")])
            continue
        if card is not None:
            yield card
        name, *rest = [part.strip() for part in line[1:].split(",")]
        pairs = [part.partition("=") for part in rest]
        options = {key.strip().upper(): value.strip().upper() for key, _, value in pairs if key.strip()}
        card = Card(" ".join(name.upper().split()), options, [])
    if card is not None:
        yield card


class _Reader:
    """Takes cards one by one; sets are resolved at the end, because they may come in any order."""

    def __init__(self) -> None:
        self.nodes: dict[int, list[float]] = {}
        self.elements: dict[int, list[int]] = {}
        self.sets: dict[str, dict[str, list[int]]] = {"NSET": {}, "ELSET": {}}
        self.later: list[tuple[str, Card]] = []
        self.materials: dict[str, tuple[float, float]] = {}
        self.sections: list[tuple[str, str]] = []
        self.friction: dict[str, float] = {}
        self.pairs: list[Pair] = []
        self.steps: list[tuple[Step, list[Card]]] = []
        self.supports: list[Card] = []
        self.material = self.interaction = ""

    def take(self, card: Card) -> None:
        """One card."""
        method = getattr(self, "_" + card.name.lower().replace(" ", "_"), None)
        if method is not None:
            method(card)
        elif card.name not in SILENT:
            raise DeckError(f"the card *{card.name} is not known to the independent reader")

    def _node(self, card: Card) -> None:
        for row in card.data:
            values = [float(v or 0) for v in row[1:4]]
            self.nodes[int(row[0])] = values + [0.0] * (3 - len(values))
        self._add("NSET", card, [int(row[0]) for row in card.data])

    def _element(self, card: Card) -> None:
        if card.options["TYPE"] != "C3D8":
            raise DeckError(f"element type {card.options['TYPE']}: the independent element is C3D8")
        flat = [int(v) for row in card.data for v in row if v]
        rows = [flat[i : i + 9] for i in range(0, len(flat), 9)]
        self.elements |= {row[0]: row[1:] for row in rows}
        self._add("ELSET", card, [row[0] for row in rows])

    def _add(self, kind: str, card: Card, members: list[int]) -> None:
        if kind in card.options:
            self.sets[kind].setdefault(card.options[kind], []).extend(members)

    def _nset(self, card: Card) -> None:
        self._set("NSET", card)

    def _elset(self, card: Card) -> None:
        self._set("ELSET", card)

    def _set(self, kind: str, card: Card) -> None:
        members: list[int] = []
        for row in card.data:
            if "GENERATE" in card.options:
                first, last, *by = (int(v) for v in row if v)
                members += range(first, last + 1, by[0] if by else 1)
            else:
                for value in filter(None, row):
                    members += [int(value)] if value.isdigit() else self.sets[kind][value.upper()]
        self._add(kind, card, members)

    def _surface(self, card: Card) -> None:
        self.later.append(("SURFACE", card))

    def _material(self, card: Card) -> None:
        self.material = card.options["NAME"]

    def _elastic(self, card: Card) -> None:
        self.materials[self.material] = (float(card.data[0][0]), float(card.data[0][1]))

    def _solid_section(self, card: Card) -> None:
        self.sections.append((card.options["ELSET"], card.options["MATERIAL"]))

    def _surface_interaction(self, card: Card) -> None:
        self.interaction = card.options["NAME"]
        self.friction.setdefault(self.interaction, 0.0)

    def _friction(self, card: Card) -> None:
        self.friction[self.interaction] = float(card.data[0][0])

    def _contact_pair(self, card: Card) -> None:
        for slave, master, *_ in card.data:
            self.pairs.append(Pair(slave.upper(), master.upper(), card.options["INTERACTION"]))

    def _step(self, card: Card) -> None:
        before = self.steps[-1][0].is_nlgeom if self.steps else False
        is_nlgeom = card.options.get("NLGEOM", "") != "NO" if "NLGEOM" in card.options else before
        self.steps.append((Step(is_nlgeom=is_nlgeom), []))

    def _static(self, card: Card) -> None:
        if card.data and len(card.data[0]) > 1 and card.data[0][1]:
            self.steps[-1][0].period = float(card.data[0][1])

    def _boundary(self, card: Card) -> None:
        (self.steps[-1][1] if self.steps else self.supports).append(card)

    def _cload(self, card: Card) -> None:
        self.steps[-1][1].append(card)

    def _dload(self, card: Card) -> None:
        self.steps[-1][0].is_loaded = True

    def _amplitude(self, card: Card) -> None:
        """Magnitudes over time do not matter to a check of equilibrium."""

    # ------------------------------------------------------------------------------------------- the end

    def finish(self, dialect: str) -> Deck:
        """Labels become indices, sets become lists, steps inherit their supports."""
        labels, element_labels = list(self.nodes), list(self.elements)
        node_at = {label: i for i, label in enumerate(labels)}
        element_at = {label: i for i, label in enumerate(element_labels)}
        deck = Deck(
            labels=np.array(labels),
            nodes=np.array([self.nodes[v] for v in labels], dtype=float),
            element_labels=np.array(element_labels),
            elements=np.array([[node_at[n] for n in self.elements[v]] for v in element_labels]),
            node_sets={k: [node_at[n] for n in v] for k, v in self.sets["NSET"].items()},
            element_sets={k: [element_at[n] for n in v] for k, v in self.sets["ELSET"].items()},
            surfaces={},
            materials=self.materials,
            sections=self.sections,
            friction=self.friction,
            pairs=self.pairs,
            steps=[],
            dialect=dialect,
        )
        for _, card in self.later:
            deck.surfaces[card.options["NAME"]] = _surface_entries(card, deck, node_at, element_at)
        held: dict[int, set[int]] = {}
        for card in self.supports:
            held = _hold(held, card, deck, node_at)
        for step, cards in self.steps:
            for card in cards:
                if card.name == "BOUNDARY":
                    held = _hold(held, card, deck, node_at)
                else:
                    step.loaded |= {n for row in card.data for n in _members(row[0], deck.node_sets, node_at)}
            step.held = {node: set(dofs) for node, dofs in held.items()}
            deck.steps.append(step)
        return deck


def _members(name: str, sets: dict[str, list[int]], index: dict[int, int]) -> list[int]:
    """Indices of a set or of one label."""
    return [index[int(name)]] if name.isdigit() else sets[name.upper()]


def _surface_entries(
    card: Card, deck: Deck, node_at: dict[int, int], element_at: dict[int, int]
) -> list[tuple[int, int]]:
    """Element faces, or nodes with face 0."""
    if card.options.get("TYPE", "ELEMENT") == "NODE":
        return [(n, 0) for row in card.data for n in _members(row[0], deck.node_sets, node_at)]
    entries = []
    for row in card.data:
        entries += [(e, int(row[1].upper().lstrip("S"))) for e in _members(row[0], deck.element_sets, element_at)]
    return entries


def _hold(held: dict[int, set[int]], card: Card, deck: Deck, node_at: dict[int, int]) -> dict[int, set[int]]:
    """The held degrees of freedom after one more *BOUNDARY card."""
    held = {} if card.options.get("OP") == "NEW" else {node: set(dofs) for node, dofs in held.items()}
    for row in card.data:
        kind = row[1].upper()
        last = row[2] if len(row) > 2 and row[2] else row[1]
        dofs = FIXED_TYPES[kind] if kind in FIXED_TYPES else range(int(row[1]), min(int(last), 3) + 1)
        for node in _members(row[0], deck.node_sets, node_at):
            held.setdefault(node, set()).update(dofs)
    return held
