"""Decks of contact as a user tries it: every element kind slides, pairs in chains, on both sides, out and in again, lifted off and put down
elsewhere; sets that are adjusted, laws that change; for a comparison with CalculiX itself.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterator

from verify.decks.feature_decks import HARD, LINEAR, NODES, NONLINEAR, SOFT, TABULAR, bodies, push, sections, step
from verify.decks.joint_decks import FACES, OUT, law, pair
from verify.decks.parts import Part, rows

MORTAR = "MORTAR"
RUB = "*FRICTION\n.3, 1.E5\n"
CHANGE_PAIR = "*MODEL CHANGE, TYPE=CONTACT PAIR, {}\nB_Z0, A_Z1\n"


def tables(kind: str, frequency: str = "") -> str:
    """What is printed: CalculiX prints nothing of mortar pairs, and counts the slip of points anew where they pass to another face."""
    words = {NODES: "CDIS, CSTR", FACES: "CSTR"}.get(kind, "")
    text = OUT.replace("PRINT,", f"PRINT{frequency},")
    return text + (f"*CONTACT PRINT{frequency}\n{words}\n*CONTACT PRINT, TOTALS=YES{frequency}\nCELS, CNUM\n" if words else "")


def two_blocks(kind: str, gap: float = 0.0) -> tuple[Part, Part]:
    """A block over a wider one whose mesh does not match."""
    return Part("A", kind, (-0.2, -0.3, -0.6), (1.5, 1.4, 0.0), (3, 4, 2)), Part("B", kind, (0, 0, gap), (1, 1, 0.5 + gap), (2, 3, 2), 1001)


def deck(blocks: tuple[Part, Part], behaviour: str, kind: str, loads: list[str], static: str = "*STATIC\n", option: str = "", frequency: str = "") -> str:
    """The pair of two blocks, and steps."""
    text = bodies(*blocks) + SOFT + sections("A", "B") + law(behaviour) + pair("B_Z0", "A_Z1", kind + option) + "*BOUNDARY\nA_Z0N, 1, 3\n"
    return text + "".join(step(load + tables(kind, frequency), NONLINEAR, static) for load in loads)


def sliding_cases() -> Iterator[tuple[str, str]]:
    """Pressed and dragged, by element kind; and dragged over several facets."""
    for element in ("C3D6", "C3D8I", "C3D10", "C3D15"):
        for kind in (NODES, FACES, MORTAR):
            static = "*STATIC\n" if kind == MORTAR else "*STATIC, DIRECT\n.5, 1.\n"
            yield f"drag-{element}-{kind[0].lower()}", deck(two_blocks(element), LINEAR + RUB, kind, [push(), push(x=0.002)], static)
    yield "drag-far-n", deck(two_blocks("C3D8"), LINEAR + RUB, NODES, [push(), push(x=0.3)], "*STATIC, DIRECT\n.1, 1.\n")


def path_cases() -> Iterator[tuple[str, str]]:
    """Laws that change from step to step, output at some increments, sets that are adjusted, pairs that go and come, blocks lifted off."""
    for kind in (NODES, FACES):
        k = kind[0].lower()
        changes = ["*CHANGE FRICTION, INTERACTION=SI\n*FRICTION\n.1, 1.E5\n", "*CHANGE SURFACE BEHAVIOR, INTERACTION=SI\n" + LINEAR.replace("1.E6", "2.E6")]
        yield f"changes-{k}", deck(two_blocks("C3D8"), LINEAR + RUB, kind, [push(-0.001), changes[0] + push(-0.001, 0.002), changes[1] + push(-0.001)], "*STATIC, DIRECT\n.5, 1.\n")
        apart = two_blocks("C3D8", 0.001)
        some = f"*NSET, NSET=SOME\n{rows(apart[1].nodes_on('Z0')[:6])}"
        text = deck(apart, LINEAR, kind, [push()], option=", ADJUST=SOME")
        yield f"adjusted-set-{k}", text.replace("*SURFACE INTERACTION", some + "*SURFACE INTERACTION", 1)
    there = [push(-0.001), CHANGE_PAIR.format("REMOVE") + push(-0.001, 0.01), CHANGE_PAIR.format("ADD") + push(-0.002, 0.01)]
    yield "elsewhere-s", deck(two_blocks("C3D8"), LINEAR + RUB, FACES, there, "*STATIC, DIRECT\n.25, 1.\n")
    yield "put-down-s", deck(two_blocks("C3D8"), LINEAR + RUB, FACES, [push(-0.002), push(0.001), push(-0.001, 0.001)])
    for kind in (NODES, FACES, MORTAR):
        yield f"some-increments-{kind[0].lower()}", deck(two_blocks("C3D8"), LINEAR, kind, [push()], "*STATIC, DIRECT\n.2, 1.\n", frequency=", FREQUENCY=2")
    yield "gaps-m", deck(two_blocks("C3D8"), LINEAR, MORTAR, [push() + "*CONTACT FILE\nCDIS, CSTR\n"])
    for kind in (NODES, MORTAR):   # CalculiX: no force by faces
        yield f"table-{kind[0].lower()}", deck(two_blocks("C3D8"), TABULAR, kind, [push(-0.001), push(-0.0015)])
    yield "hard-drag-n", deck(two_blocks("C3D8"), HARD + RUB, NODES, [push(-0.001), push(-0.001, 0.003)], "*STATIC, DIRECT\n.25, 1.\n")


def chain_cases() -> Iterator[tuple[str, str]]:
    """Three blocks, the middle one slave and master in turn, or both of one kind; and two whose faces are slaves of each other."""
    a = Part("A", "C3D8", (0, 0, 0), (2, 2, 1), (3, 3, 1))
    b = Part("B", "C3D8", (0.2, 0.2, 1), (1.8, 1.8, 2), (2, 2, 2), 1001)
    c = Part("C", "C3D8", (0.1, 0.1, 2), (1.9, 1.9, 3), (3, 3, 1), 2001)
    chains = {"up": ("B_Z0, A_Z1", "C_Z0, B_Z1"), "down": ("A_Z1, B_Z0", "B_Z1, C_Z0"), "master": ("A_Z1, B_Z0", "C_Z0, B_Z1")}
    for kind in (NODES, FACES):
        for name, pairs in chains.items():
            text = bodies(a, b, c) + SOFT + sections("A", "B", "C") + law(LINEAR + RUB) + "".join(pair(*words.split(", "), kind) for words in pairs)
            text += "*BOUNDARY\nA_Z0N, 1, 3\nC_Z1N, 1, 2\n" + step("*BOUNDARY\nC_Z1N, 3, 3, -.02\n" + tables(kind), NONLINEAR)
            yield f"chain-{name}-{kind[0].lower()}", text + step("*BOUNDARY\nC_Z1N, 1, 1, .01\n" + tables(kind), NONLINEAR, "*STATIC, DIRECT\n.5, 1.\n")
    both = pair("B_Z0", "A_Z1", NODES) + pair("A_Z1", "B_Z0", NODES)
    yield "both-sides-n", deck(two_blocks("C3D8"), LINEAR, NODES, [push()]).replace(pair("B_Z0", "A_Z1", NODES), both)


FAMILIES = [sliding_cases, path_cases, chain_cases]


def cases() -> dict[str, str]:
    """All decks by name."""
    return {name: text for family in FAMILIES for name, text in family()}
