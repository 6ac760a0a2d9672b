"""The same deck in other units, turned in space, with other labels, or with the cards of the model in another order.

Every card that a deck may hold is known here with the units of its numbers; one that is not known is an error, so that nothing
is scaled in silence by one.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import itertools
import random
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Cards without numbers that have a unit.
PLAIN = {"HEADING", "ELEMENT", "NSET", "ELSET", "SURFACE", "MATERIAL", "SURFACE INTERACTION", "CONTACT PAIR", "STEP", "STATIC", "VISCO", "END STEP", "CONTROLS",
         "NODE PRINT", "EL PRINT", "CONTACT PRINT", "NODE FILE", "EL FILE", "CONTACT FILE", "NODE OUTPUT", "ELEMENT OUTPUT", "CONTACT OUTPUT", "OUTPUT",
         "LINE SEARCH", "CHANGE FRICTION", "CHANGE SURFACE BEHAVIOR", "MODEL CHANGE", "EQUATION", "INCLUDE", "RIGID BODY", "EXPANSION", "TEMPERATURE",
         "PLASTIC DATA", "RESTART", "TIE", "COUPLING", "KINEMATIC", "DISTRIBUTING", "PRE-TENSION SECTION", "SECTION PRINT", "TIME POINTS", "MPC",
         "DISTRIBUTING COUPLING", "KINEMATIC COUPLING", "CHANGE SOLID SECTION", "CHANGE MATERIAL", "PREPRINT", "PART", "END PART", "ASSEMBLY", "END ASSEMBLY",
         "END INSTANCE", "NO ANALYSIS", "CLEARANCE", "NFILL", "ELGEN", "ELCOPY", "DISTRIBUTION", "MONITOR", "PRINT", "ENERGY PRINT", "SOLVER CONTROLS",
         "SYSTEM", "CONTACT CONTROLS", "SECTION CONTROLS", "EL OUTPUT", "ENERGY FILE", "ENERGY OUTPUT", "SHELL TO SOLID COUPLING"}  # fmt: skip
#: Kinds of rubber to their constants; N their order.
RUBBER = {"NEOHOOKE": "SZ1", "MOONEY": "SSZ1", "YEOH": "SSSZZZ1", "ARRUDA": "S1Z1",
          **{f"OGDEN.*,N={n}": n * "S1" + n * "Z" + "1" for n in range(1, 7)}, "OGDEN": "S1Z1",
          **{f"REDUCEDPOLYNOMIAL.*,N={n}": n * "S" + n * "Z" + "1" for n in range(1, 7)}, "REDUCEDPOLYNOMIAL": "SZ1",
          **{f",N={n}": n * (n + 3) // 2 * "S" + n * "Z" + "1" for n in range(1, 4)}, "": "SSZ1"}  # fmt: skip
#: Card to the units of the numbers of its data lines; the last one repeats, and more than eight continue in further lines. Where lines differ, the first
#: pattern counts that is in "HEAD|LINE" (without blanks, with @ behind it for what `special` names). L length, F force, S stress, K stress per length,
#: M moment, A area, Q force per length, R density, D damping of a volume, Z one over stress, C a creep rate over stress to the power that follows,
#: X unit of an absolute amplitude, 1 none.
UNITS = {
    "NODE": {"SYSTEM=C": "1L1L", "SYSTEM=S": "1L1", "": "1L"},
    "IMPERFECTION": {"SYSTEM=C": "1L1L", "SYSTEM=S": "1L1", "": "1L"},
    "NGEN": "1111LLL1", "NCOPY": "LLLLLL1", "INSTANCE": "LLLLLL1",
    "TRANSFORM": {"TYPE=C": "L", "": "1"}, "ORIENTATION": {"SYSTEM=C": "L", "": "1"}, "CYCLIC SYMMETRY MODEL": "L",
    "ELASTIC": {"TRACTION": "SSS1", "ORTHO": "SSSSSSSSS1", "ANISO": 21 * "S" + "1", "ENGINEERING": "SSS111SSS1", "LAMINA": "SS1SSS1", "": "S1"},
    "HYPERELASTIC": RUBBER, "HYPERFOAM": {**{f",N={n}": n * "S1" + n * "1" + "1" for n in range(1, 7)}, "": "S111"},
    "UNIAXIAL TEST DATA": "S1", "BIAXIAL TEST DATA": "S1", "PLANAR TEST DATA": "S1",
    "DENSITY": "R1", "PLASTIC": "S1", "CHANGE PLASTIC": "S1", "DRUCKER PRAGER": "1", "DRUCKER PRAGER HARDENING": "S1",
    "MOHR COULOMB": "1", "MOHR COULOMB HARDENING": "S1", "CAP PLASTICITY": "S1", "CAP HARDENING": "S1", "VISCOELASTIC": "1",
    "CYCLIC HARDENING": "S1", "DAMAGE INITIATION": "SSS1", "DAMAGE EVOLUTION": {"MIXED": "QQQ1", "ENERGY": "Q1", "": "L1"}, "DAMAGE STABILIZATION": "1",
    "COHESIVE SECTION": "L", "RATE DEPENDENT": "1", "DEFORMATION PLASTICITY": "S1S1", "CREEP": "C1",
    "SHELL SECTION": "L1", "MEMBRANE SECTION": "L", "BEAM SECTION": {r"\|-?[0-9.]+,-?[0-9.]+,": "1", "": "L"}, "NODAL THICKNESS": "1L", "NORMAL": "1",
    "SOLID SECTION": {"@": "A", "": "L"}, "MASS": "Q", "GAP": "L1111QF", "SPRING": {"NONLINEAR": "FL1Q", "": "Q1"},
    "INITIAL CONDITIONS": {r"STRESS.*\|([^,]*,){7}[^,]": "11S", "STRESS": "1S", r"HARDENING.*\|([^,]*,){8}[^,]": "111S", "HARDENING": "11S",
                           "TEMPERATURE|PLASTICSTRAIN|DISPLACEMENT": "1"},
    "FRICTION": "1K", "CONTACT INTERFERENCE": "11L",
    "SURFACE BEHAVIOR": {"EXPONENTIAL": "LS", "TABULAR": "SL", "LINEAR": "KSL", "": "K"},
    "BOUNDARY": {r"\|[^,]*,[456]\b|@": "1", "": "111L"}, "CLOAD": {r"\|[^,]*,[456],|@": "11M", "": "11F"},
    "DLOAD": {",GRAV,": "11L1", ",CENTRIF,": "111LLL1", ",B[XYZ],": "11K", ",P[XYZ],": "11Q1", ",EDNOR": "11Q1", "": "11S1"}, "DSLOAD": "11S1",
    "AMPLITUDE": {"PERIODIC": "111X1111X", "MODULATED": "XX1", "DECAY": "XX1", "EQUALLYSPACED": "X", "": "1X1X1X1X"},
}  # fmt: skip
#: Defaults that are numbers without a unit: thickness and area, stiffness and force of a gap.
DEFAULTS = {"SOLID SECTION": "1.", "COHESIVE SECTION": "1., 1.", "GAP": "0., , , , , 1e12, 1e-3"}
#: Parameters that have a unit.
PARAMETERS = {"CLEARANCE": {"VALUE": "L"}, "CONTACT PAIR": {"ADJUST": "L", "CLEARANCE": "L"}, "TIE": {"POSITION TOLERANCE": "L"},
              "SHELL TO SOLID COUPLING": {"POSITION TOLERANCE": "L"}, "FRICTION": {"TAUMAX": "S"},
              "STATIC": {"FACTOR": "D"}, "VISCO": {"FACTOR": "D"}, "SURFACE": {"FILLET RADIUS": "L"}, "AMPLITUDE": {"SHIFTY": "X"}}  # fmt: skip
#: What a routine of the user or another job says has unknown units.
REFUSED = {"SURFACE INTERACTION": ",USER", "FRICTION": ",USER", "AMPLITUDE": "DEFINITION=USER", "BOUNDARY": ",USER", "RESTART": ",READ", "NODE": ",INPUT=",
           "IMPERFECTION": ",INPUT="}
#: Cards that belong to the card before them.
DATA_CARDS = {"ELASTIC", "HYPERELASTIC", "DENSITY", "FRICTION", "SURFACE BEHAVIOR", "EXPANSION", "PLASTIC", "KINEMATIC", "DISTRIBUTING",
              "UNIAXIAL TEST DATA", "BIAXIAL TEST DATA", "PLANAR TEST DATA"}
#: Cards whose data lines begin with a node, all of whose numbers are nodes, or which hold them behind a label.
NODE_FIRST, NODES_ONLY = {"NODE", "IMPERFECTION", "BOUNDARY", "CLOAD", "TEMPERATURE", "INITIAL CONDITIONS"}, {"NSET"}
MODEL_END = "*STEP"


@dataclass
class Units:
    """One unit of length and of force of the model in the deck's."""

    length: float = 1.0
    force: float = 1.0

    def of(self, letter: str) -> float:
        """The factor of a unit."""
        stress = self.force / self.length**2
        rest = {"K": stress / self.length, "Z": 1 / stress, "A": self.length**2, "Q": self.force / self.length, "M": self.force * self.length, "D": self.force / self.length**4, "R": stress / self.length**2}  # one unit of time: density times length^2 is a stress
        return {"1": 1.0, "L": self.length, "F": self.force, "S": stress, **rest}[letter]


def cards(deck: str) -> list[list[str]]:
    """Keyword line and data lines of each card; comments are dropped."""
    result: list[list[str]] = []
    for line in deck.splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            result.append([line])
        elif result:
            result[-1].append(line)
    return result


def keyword(card: list[str]) -> str:
    """In upper case."""
    return re.sub(r"\s+", " ", card[0][1:].split(",")[0].strip().upper())


def scaled(deck: str, units: Units, tight: float = 1e-10) -> str:
    """The deck in other units, with controls so tight that what is left is below what is compared; with 0 its own controls."""
    special = angles(deck) | sets_of("T3D|SPRINGA", deck)
    absolute = amplitudes(deck)
    dialect = [line for line in deck.splitlines() if re.match(r"\*\*\s*dialect", line, flags=re.I)]
    return "\n".join([*dialect, *(line for card in cards(deck) for line in scaled_card(card, units, tight, special, absolute))]) + "\n"


def angles(deck: str) -> set[str]:
    """The labels of nodes whose displacement is an angle, of ROT NODE and of *MPC, MEANROT, and the sets of nothing else."""
    found = set(re.findall(r"ROT NODE\s*=\s*(\d+)", deck, flags=re.I))
    for card in cards(deck):
        words = [word.strip() for line in card[1:] for word in line.split(",") if word.strip()]
        if keyword(card) == "MPC" and words[0].upper() == "MEANROT":
            found.add(words[-1])
    for card in cards(deck):
        members = [line.split(",")[0].strip() for line in card[1:]] if keyword(card) == "NODE" else [v.strip() for v in ",".join(card[1:]).split(",")]
        if keyword(card) in {"NODE", "NSET"} and value_of("NSET", card[0]) and {v for v in members if v} <= found:
            found.add(value_of("NSET", card[0]))
    return found


def sets_of(kinds: str, deck: str) -> set[str]:
    """The element sets of trusses, whose section is an area, or of springs along a line, whose data have no directions."""
    heads = [card[0].upper() for card in cards(deck) if keyword(card) == "ELEMENT"]
    return {"ELSET " + value_of("ELSET", head) for head in heads if re.search(kinds, value_of("TYPE", head))}


def amplitudes(deck: str) -> dict[str, str]:
    """The unit of each absolute amplitude: that of the loads that name it. CalculiX passes ABSOLUTE over."""
    loads = {value_of("AMPLITUDE", card[0]): card for card in cards(deck) if keyword(card) in {"BOUNDARY", "CLOAD", "DLOAD", "DSLOAD"}}
    is_known = not re.search(r"^\*\*\s*dialect\s*[:=]\s*calculix", deck, flags=re.I | re.M)
    names = [value_of("NAME", card[0]) for card in cards(deck) if keyword(card) == "AMPLITUDE" and "ABSOLUTE" in card[0].upper() and is_known]
    return {name: letters_of(loads[name], loads[name][1], set())[3 if keyword(loads[name]) == "BOUNDARY" else 2] for name in names if name in loads}


def value_of(word: str, head: str) -> str:
    """Of a parameter, in upper case."""
    found = re.search(rf",\s*{word}\s*=\s*([^,]+)", head, flags=re.I)
    return found[1].strip().upper() if found else ""


def scaled_card(card: list[str], units: Units, tight: float, special: set[str], absolute: dict[str, str]) -> list[str]:
    """One card. tight: what Newton's method may leave of forces and of corrections. special: nodes that bear angles, sets of trusses and of springs along a
    line. absolute: units of amplitudes."""
    name = keyword(card)
    head = card[0]
    if re.search(REFUSED.get(name, "^$"), bare(head)):
        refuse(name)
    unit = absolute.get(value_of("NAME", head), "1")
    for word, letter in PARAMETERS.get(name, {}).items():
        factor = units.of(letter.replace("X", unit))
        head = re.sub(rf"({word}\s*=\s*)([^,]+)", lambda m, factor=factor: m.group(1) + times(m.group(2).strip(), factor), head, flags=re.I)
    if name in {"STATIC", "VISCO"} and tight > 0:
        return [head, *card[1:], "*CONTROLS, PARAMETERS=FIELD", f"{tight:g}, {tight:g}, , , {tight:g}"]
    if name == "CONTROLS" and "FIELD" in head.upper() and tight > 0:
        return []
    if name == "SURFACE" and is_analytic(card):
        return [head, *(row(line, "L", units) for line in card[1:])]
    if name in PLAIN:
        return [head, *card[1:]]
    if name not in UNITS:
        refuse(name)
    if name in DEFAULTS:
        card = [head, *(filled(line, DEFAULTS[name]) for line in card[1:] or [""])]
    n_kept = 2 if name == "SPRING" and "ELSET " + value_of("ELSET", head) not in special else 1   # directions are numbers too
    lines = [row(line, letters_of(card, line, special, i).replace("X", unit), units) for i, line in enumerate(card[n_kept:])]
    return [head, *card[1:n_kept], *lines]


def filled(line: str, default: str) -> str:
    """A data line whose blank fields are what they stand for."""
    pairs = itertools.zip_longest(line.split(","), default.split(","), fillvalue="")
    return ", ".join(given.strip() or standard.strip() for given, standard in pairs)


def letters_of(card: list[str], line: str, special: set[str], i: int = 0) -> str:
    """The units of data line i of a card."""
    rules = UNITS[keyword(card)]
    is_special = line.split(",")[0].strip().upper() in special or "ELSET " + value_of("ELSET", card[0]) in special
    text = bare(f"{card[0]}|{line}") + ("@" if is_special else "")
    letters = rules if isinstance(rules, str) else next((rules[word] for word in rules if re.search(word, text)), "")
    if not letters:
        refuse(keyword(card))
    n = -(-len(letters) // 8)
    return letters[8 * (i % n) :]


def bare(text: str) -> str:
    """In upper case, without blanks."""
    return re.sub(r"\s+", "", text.upper())


def is_analytic(card: list[str]) -> bool:
    """Whether a *SURFACE is a profile of lines and arcs."""
    return bool(re.search(r"TYPE\s*=\s*(SEGMENTS|CYLINDER|REVOLUTION)", card[0].upper()))


def refuse(name: str) -> None:
    """What cannot be scaled."""
    raise ValueError(f"the units of *{name} are not known to scaling.py")


def times(text: str, factor: float) -> str:
    """A number times a factor; a word as it is."""
    if factor == 1.0 or not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([ED][+-]?\d+)?", text, flags=re.I):
        return text
    return f"{float(text.upper().replace('D', 'E')) * factor:.17g}"


def row(line: str, letters: str, units: Units) -> str:
    """One data line."""
    fields = [text.strip() for text in line.split(",")]
    if letters[0] == "C":
        return ", ".join([times(fields[0], units.of("S") ** -float(fields[1])), *fields[1:]])
    return ", ".join(times(text, units.of(letters[min(i, len(letters) - 1)])) for i, text in enumerate(fields))


def shuffled(deck: str, seed: int) -> str:
    """The cards of the model in another order; those that belong to the card before them stay behind it, and contact pairs keep their
    order among themselves: of pairs that share nodes the first has rights."""
    model, steps = deck[: deck.index(MODEL_END)], deck[deck.index(MODEL_END) :]
    groups: list[list[str]] = []
    for card in cards(model):
        if keyword(card) in DATA_CARDS and groups:
            groups[-1] += card
        else:
            groups.append(list(card))
    pairs = [group for group in groups if keyword(group) == "CONTACT PAIR"]
    random.Random(seed).shuffle(groups)
    first_of = iter(pairs)
    groups = [next(first_of) if keyword(group) == "CONTACT PAIR" else group for group in groups]
    return "\n".join(line for group in groups for line in group) + "\n" + steps


def is_flat(deck: str) -> bool:
    """Whether its elements are of two dimensions."""
    return bool(re.search(r"TYPE\s*=\s*C(?:PE|PS|AX)", deck.upper()))


def rotation(deck: str) -> Floats:
    """By 35 degrees: about a skew axis, or about z for a deck in the plane."""
    axis = np.array([0.0, 0.0, 1.0]) if is_flat(deck) else np.array([2.0, -1.0, 2.0]) / 3
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle = np.radians(35)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def turned(deck: str) -> str:
    """All coordinates and directions turned; supports and forces are along the turned axes by *TRANSFORM of all nodes."""
    turn = rotation(deck)
    lines: list[str] = []
    places: list[str] = []
    for card in cards(deck):
        name = keyword(card)
        if name == "IMPERFECTION":
            card = [card[0], *(turned_node(line, turn) for line in card[1:])]
        elif name == "NODE":
            card = [card[0], *(turned_node(line, turn) for line in card[1:])]
            places += [line.split(",")[0] for line in card[1:]]
        elif name == "SURFACE" and is_analytic(card):
            card = turned_profile(card, turn)
        elif name == "DLOAD":
            card = [card[0], *(turned_gravity(line, turn) if "GRAV" in line.upper() else line for line in card[1:])]
        if card[0].upper().startswith(MODEL_END) and places:
            axes = ", ".join(f"{v:.17g}" for v in [*turn[:, 0], *turn[:, 1]])
            lines += ["*NSET, NSET=ALL_TURNED", *places, "*TRANSFORM, NSET=ALL_TURNED, TYPE=R", axes]
            places = []
        lines += card
    return "\n".join(lines) + "\n"


def turned_node(line: str, turn: Floats) -> str:
    """A line of *NODE."""
    label, *numbers = line.split(",")
    place = np.zeros(3)
    place[: len(numbers)] = [float(v) for v in numbers]
    return f"{label}, " + ", ".join(f"{v:.17g}" for v in (turn @ place)[: len(numbers)])


def turned_profile(card: list[str], turn: Floats) -> list[str]:
    """A *SURFACE of lines and arcs: its points if it is plane, else its axes, which are written out if they were not."""
    head, *lines = card
    start = next(i for i, line in enumerate(lines) if line.upper().startswith("START"))
    if "SEGMENTS" in head.upper():
        return [head, *(turned_points(line, turn, 2) for line in lines)]
    is_drawn = "CYLINDER" in head.upper()
    axes = [line for line in lines[:start] if line.strip()]
    if not axes:
        axes = ["0., 0., 0., 1., 0., 0.", "0., 0., -1."] if is_drawn else ["0., 0., 0., 0., 1., 0."]
    return [head, *(turned_points("," + line, turn, 3)[2:] for line in axes), *lines[start:]]


def turned_points(line: str, turn: Floats, n: int) -> str:
    """A word, then points of n coordinates."""
    word, *numbers = line.rstrip().rstrip(",").split(",")
    places = np.array([float(v) for v in numbers]).reshape(-1, n) @ turn[:n, :n].T
    return ", ".join([word.strip(), *(f"{v:.17g}" for v in places.ravel())])


def turned_gravity(line: str, turn: Floats) -> str:
    """A line of *DLOAD with GRAV: set, GRAV, size, and the direction by its two or three components."""
    *head, x, y, z = [*line.split(","), "0."][:6]
    return ",".join(head) + ", " + ", ".join(f"{v:.17g}" for v in turn @ [float(x), float(y), float(z)])


def renumbered(deck: str, seed: int) -> tuple[str, dict[int, int]]:
    """Nodes with other labels and in another order; and the new label of each old one."""
    parts = cards(deck)
    old = [int(line.split(",")[0]) for card in parts if keyword(card) == "NODE" for line in card[1:]]
    label = dict(zip(old, random.Random(seed).sample(range(1, 3 * len(old)), len(old)), strict=True))
    return "\n".join(line for card in parts for line in renumbered_card(card, label, seed)) + "\n", label


def renumbered_card(card: list[str], label: dict[int, int], seed: int) -> list[str]:
    """One card."""
    name = keyword(card)
    if name == "NSET":
        return renumbered_set(card, label)
    if name in NODE_FIRST:
        rows = [",".join([new_label(first, label), *rest]) for first, *rest in (line.split(",") for line in card[1:])]
        if name == "NODE":
            random.Random(seed).shuffle(rows)
        return [card[0], *rows]
    if name == "ELEMENT":
        fields = [line.rstrip().rstrip(",").split(",") for line in card[1:]]
        is_start = [True, *(not line.rstrip().endswith(",") for line in card[1:-1])]
        return [card[0], *(", ".join([*row[:start], *(new_label(v, label) for v in row[start:])]) + ("," if more else "")
                           for row, start, more in zip(fields, is_start, [line.rstrip().endswith(",") for line in card[1:]], strict=True))]  # fmt: skip
    if name == "EQUATION":
        return [card[0], *(renumbered_terms(line, label) for line in card[1:])]
    if name == "RIGID BODY":
        return [re.sub(r"(REF NODE\s*=\s*)(\d+)", lambda m: m[1] + new_label(m[2], label), card[0], flags=re.I), *card[1:]]
    return card


def renumbered_set(card: list[str], label: dict[int, int]) -> list[str]:
    """*NSET, its GENERATE written out."""
    members: list[str] = []
    for line in card[1:]:
        fields = [v.strip() for v in line.split(",") if v.strip()]
        if "GENERATE" in card[0].upper():
            first, last, *by = (int(v) for v in fields)
            members += [new_label(str(v), label) for v in range(first, last + 1, *by) if v in label]
        else:
            members += [new_label(v, label) for v in fields]
    return [re.sub(r",\s*GENERATE", "", card[0], flags=re.I), *members]


def renumbered_terms(line: str, label: dict[int, int]) -> str:
    """A line of *EQUATION: the number of terms, or node, component, factor in turn."""
    fields = line.split(",")
    return line if len(fields) < 3 else ", ".join(new_label(v, label) if i % 3 == 0 else v.strip() for i, v in enumerate(fields))


def new_label(text: str, label: dict[int, int]) -> str:
    """Of a node; the name of a set as it is."""
    return str(label[int(text)]) if text.strip().isdigit() else text
