"""Decks of bodies that meet like machine parts: stacks, punches, domes, joints; for a comparison with CalculiX itself.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.decks.feature_decks import SOFT, STEEL, bodies, sections, step
from verify.decks.parts import Floats, Part

NODES, FACES = "NODE TO SURFACE", "SURFACE TO SURFACE"
OUT = "*NODE PRINT, NSET=NALL\nU, RF\n*EL PRINT, ELSET=EALL\nS\n*NODE FILE\nU, RF\n*EL FILE\nS\n"
POINTS = "*CONTACT PRINT\nCSTR\n*CONTACT PRINT, TOTALS=YES\nCELS, CNUM\n"
SUMS = "*CONTACT PRINT, SLAVE=B_Z0, MASTER=A_Z1\nCF\n"  # where faces are not parallel their points differ, their forces do not
LINEAR = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E6\n"
HARD = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n"
RUB = "*FRICTION\n.3, 1.E5\n"
STEADY, HALVES, QUARTERS = "*STATIC\n", "*STATIC\n.5, 1.\n", "*STATIC\n.25, 1.\n"
NONLINEAR = ", NLGEOM"


def law(cards: str) -> str:
    """The interaction SI."""
    return f"*SURFACE INTERACTION, NAME=SI\n{cards}"


def pair(slave: str, master: str, kind: str) -> str:
    """A contact pair under it."""
    return f"*CONTACT PAIR, INTERACTION=SI, TYPE={kind}\n{slave}, {master}\n"


def motion(cards: str, static: str = STEADY, out: str = POINTS) -> str:
    """A step."""
    return step(cards + OUT + out, NONLINEAR, static)


def stack_cases() -> Iterator[tuple[str, str]]:
    """Three blocks: contact and friction alone hold the middle one."""
    a = Part("A", "C3D8", (0, 0, 0), (2, 2, 1), (3, 3, 1))
    b = Part("B", "C3D8", (0.2, 0.2, 1), (1.8, 1.8, 2), (2, 2, 2), 1001)
    c = Part("C", "C3D8", (0.1, 0.1, 2), (1.9, 1.9, 3), (3, 3, 1), 2001)
    for kind in (NODES, FACES):
        for name, cards in (("", LINEAR), ("-hard", HARD)):
            text = bodies(a, b, c) + SOFT + sections("A", "B", "C") + law(cards + RUB) + pair("B_Z0", "A_Z1", kind) + pair("B_Z1", "C_Z0", kind)
            text += "*BOUNDARY\nA_Z0N, 1, 3\nC_Z1N, 1, 2\n"
            yield f"stack{name}-{kind[0].lower()}", text + motion("*BOUNDARY\nC_Z1N, 3, 3, -.02\n") + motion("*BOUNDARY\nC_Z1N, 1, 1, .01\n", HALVES)


def punch_cases() -> Iterator[tuple[str, str]]:
    """A punch whose top is a rigid body: pressed and turned, or pressed and tilted by a moment."""
    a = Part("A", "C3D8", (-1, -1, -1), (2, 2, 0), (6, 6, 2))
    b = Part("B", "C3D8", (0, 0, 0), (1, 1, 0.5), (3, 3, 1), 1001)
    rigid = "*NODE, NSET=REF\n5001, .5, .5, .5\n5002, .5, .5, .5\n*RIGID BODY, NSET=B_Z1N, REF NODE=5001, ROT NODE=5002\n"
    for kind in (NODES, FACES):
        text = bodies(a, b) + SOFT + sections("A", "B") + rigid + law(LINEAR + RUB) + pair("B_Z0", "A_Z1", kind) + "*BOUNDARY\nA_Z0N, 1, 3\n"
        out = SUMS if kind == FACES else POINTS
        pressed = motion("*BOUNDARY\n5001, 1, 2\n5002, 1, 3\n*CLOAD\n5001, 3, -50.\n", out=out)
        freed = "*BOUNDARY, OP=NEW\nA_Z0N, 1, 3\n5001, 1, 2\n5002, 1, 1\n5002, 3, 3\n"
        yield f"punch-tilted-{kind[0].lower()}", text + pressed + motion(freed + "*CLOAD\n5002, 2, 5.\n", QUARTERS, out)


def dome_cases() -> Iterator[tuple[str, str]]:
    """A dome whose nodes lie over edges and corners of the facets of its master, pressed and dragged."""

    def bend(x: Floats) -> Floats:
        x, r = x.copy(), np.hypot(x[:, 0] - 0.5, x[:, 1] - 0.5)
        x[:, 2] += 0.05 * r**2 * (1 - x[:, 2])
        return x

    for element in ("C3D4", "C3D6", "C3D8"):
        for kind in (NODES, FACES):
            a = Part("A", element, (-0.5, -0.5, -1), (1.5, 1.5, -0.001), (4, 4, 2))
            b = Part("B", element, (0, 0, 0), (1, 1, 1), (3, 3, 2), 1001, bend=bend)
            text = bodies(a, b) + STEEL + sections("A", "B") + law(LINEAR + RUB) + pair("B_Z0", "A_Z1", kind) + "*BOUNDARY\nA_Z0N, 1, 3\nB_Z1N, 1, 2\n"
            out = SUMS if kind == FACES else POINTS
            yield f"dome-{element}-{kind[0].lower()}", (text + motion("*BOUNDARY\nB_Z1N, 3, 3, -.02\n", HALVES, out)
                                                        + motion("*BOUNDARY\nB_Z1N, 1, 1, .02\n", QUARTERS, out))


def change_cases() -> Iterator[tuple[str, str]]:
    """A pair out and in again, relaxation by creep, a gap that closes as bodies grow warm, weight on a slope."""
    a = Part("A", "C3D8", (-0.5, -0.5, -1), (1.5, 1.5, 0), (3, 3, 2))
    b = Part("B", "C3D8", (0, 0, 0), (1, 1, 1), (2, 2, 2), 1001)
    left, right = Part("A", "C3D8", (0, 0, 0), (2, 1, 1), (3, 2, 2)), Part("B", "C3D8", (2.002, 0, 0), (4, 1, 1), (4, 3, 2), 1001)
    slope = Part("A", "C3D8", (-1, -1, -1), (4, 2, 0), (5, 3, 1))
    held = "*BOUNDARY\nA_Z0N, 1, 3\nB_Z1N, 1, 2\n"
    for kind in (NODES, FACES):
        k = kind[0].lower()

        def switch(word: str) -> str:
            return f"*MODEL CHANGE, TYPE=CONTACT PAIR, {word}\nB_Z0, A_Z1\n"

        text = bodies(a, b) + STEEL + sections("A", "B") + law(LINEAR) + pair("B_Z0", "A_Z1", kind) + held
        yield f"out-and-in-{k}", (text + motion(switch("REMOVE") + "*BOUNDARY\nB_Z1N, 3, 3, -.01\n*DLOAD\n" + b.dload("X1", 10.0) + a.dload("X1", 10.0)) + motion(switch("ADD"), HALVES)
                                  + motion("*BOUNDARY\nB_Z1N, 3, 3, -.005\n"))
        creep = "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n*CREEP, LAW=NORTON\n1.E-12, 4., 0.\n"
        text = bodies(a, b) + creep + sections("A", "B") + law(LINEAR) + pair("B_Z0", "A_Z1", kind) + held
        yield f"relaxing-{k}", text + step("*BOUNDARY\nB_Z1N, 3, 3, -.003\n" + OUT + POINTS) + step(OUT + POINTS, "", "*VISCO, CETOL=.01\n.1, 10.\n")
        text = bodies(left, right) + STEEL + sections("A", "B") + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*BOUNDARY\nA_X0N, 1, 3\nB_X1N, 1, 3\n"
        yield f"warming-{k}", text + law(LINEAR) + pair("B_X0", "A_X1", kind) + motion("*TEMPERATURE\nNALL, 220.\n", QUARTERS)
        text = bodies(slope, b) + STEEL + sections("A", "B") + law(LINEAR + "*FRICTION\n.5, 1.E5\n") + pair("B_Z0", "A_Z1", kind)
        yield f"slope-{k}", text + "*BOUNDARY\nA_Z0N, 1, 3\n" + motion("*DLOAD\nB, GRAV, 1.E10, .3, 0., -1.\n", QUARTERS)


def lap_cases() -> Iterator[tuple[str, str]]:
    """Two plates that overlap, clamped by pressures and drawn apart, by a motion or by a force that is new in the second step.

    The master reaches beyond the slave's nodes unless the name says `flush`; a force is stated as zero in the first step unless it says `new`.
    """
    for beyond in (0.0, 0.3):
        a = Part("A", "C3D8", (0, -beyond / 3, 0), (6 + beyond, 2 + beyond / 3, 0.5), (9, 3, 1))
        b = Part("B", "C3D8", (3, 0, 0.5), (9, 2, 1), (8, 3, 1), 1001)
        clamp = "".join(f"{label + part.first}, P{face}, 50.\n" for part, side in ((a, "Z0"), (b, "Z1")) for label, face in part.faces[side]
                        if 3 < part.nodes[part.elements[label]][:, 0].mean() < 6)
        for kind in (NODES, FACES):
            text = bodies(a, b) + STEEL + sections("A", "B") + law(LINEAR + RUB) + pair("B_Z0", "A_Z1", kind) + "*BOUNDARY\nA_X0N, 1, 3\nB_X1N, 2, 3\n"
            k, out = kind[0].lower(), SUMS if kind == FACES else POINTS
            held, fifths = "*BOUNDARY\nB_X1N, 1, 1\n*DLOAD\n" + clamp, "*STATIC, DIRECT\n.1, 1.\n"
            yield f"lap-{'moved' if beyond else 'flush'}-{k}", text + motion(held, out=out) + motion("*BOUNDARY\nB_X1N, 1, 1, .01\n", fifths, out)
            if beyond:
                drawn = motion("*BOUNDARY, OP=NEW\nA_X0N, 1, 3\nB_X1N, 2, 3\n*DLOAD\n" + b.dload("X1", -20.0), fifths, out)
                yield f"lap-drawn-{k}", text + motion(held + b.dload("X1", 0.0), out=out) + drawn
                if kind == FACES:
                    yield "lap-new-load", text + motion(held, out=out) + drawn


def axis_cases() -> Iterator[tuple[str, str]]:
    """A punch that presses a soft disc, with and without a bore, surface to surface."""
    for name, r in (("axis", 0.0), ("bore", 1.0)):
        a, b = Part("A", "CAX4", (r, -2), (r + 3, 0), (9, 5)), Part("B", "CAX4", (r, 0), (r + 1, 1), (3, 2), 1001)
        text = bodies(a, b) + STEEL + SOFT.replace("NAME=EL", "NAME=SOFT")
        text += "*SOLID SECTION, ELSET=A, MATERIAL=SOFT\n*SOLID SECTION, ELSET=B, MATERIAL=EL\n*BOUNDARY\nA_Y0N, 1, 2\nA_X0N, 1, 1\nB_X0N, 1, 1\n"
        text += law(LINEAR) + pair("B_Y0", "A_Y1", FACES)
        yield f"{name}-CAX4", text + motion("*BOUNDARY\nB_Y1N, 2, 2, -.1\n", "*STATIC, DIRECT\n.25, 1.\n", SUMS.replace("Z", "Y"))


FAMILIES = [stack_cases, punch_cases, dome_cases, change_cases, lap_cases, axis_cases]


def cases() -> dict[str, str]:
    """All decks by name."""
    return {name: text for family in FAMILIES for name, text in family()}
