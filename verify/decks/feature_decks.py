"""Small decks of one feature each, as CalculiX's own tests have them: for a comparison with CalculiX itself, tables and fields.

Bodies of every element kind, tied, cut by a pre-tension section, closed to a ring, held by reference nodes, pulled by trusses and springs,
pressed on each other by every law of contact; the requests of output cards, and the times of loads. `cases()` gives all of them by name.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.decks.parts import Floats, Part, rows
from verify.decks.solids import FACES, KINDS

STEEL = "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n*DENSITY\n7.8E-9\n*EXPANSION\n1.2E-5\n"
SOFT = STEEL.replace("210000.", "10000.")
PRINTS = "*NODE PRINT, NSET=NALL\nU, RF\n*EL PRINT, ELSET=EALL\nS, E\n*NODE FILE\nU, RF\n*EL FILE\nS, E\n"
NONLINEAR = ", NLGEOM"


def sections(*names: str, rest: str = "") -> str:
    """Solid sections."""
    return "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=EL\n{rest}" for name in names)


def bodies(*parts: Part) -> str:
    """The cards of parts and the sets NALL, EALL."""
    text = "".join(part.cards() for part in parts)
    return text + "*NSET, NSET=NALL\n" + "".join(f"{p.name}N\n" for p in parts) + "*ELSET, ELSET=EALL\n" + "".join(f"{p.name}\n" for p in parts)


def step(cards: str, option: str = "", static: str = "*STATIC\n") -> str:
    """A step."""
    return f"*STEP{option}\n{static}{cards}*END STEP\n"


def options(name: str) -> Iterator[tuple[str, str]]:
    """A name, and that of the same under NLGEOM."""
    yield name, ""
    yield name + "-nl", NONLINEAR


def tie_cases() -> Iterator[tuple[str, str]]:
    """Bodies of different kinds tied, with gaps, overlaps and tolerances."""
    base = Part("A", "C3D8", (0, 0, 0), (2, 1, 1), (3, 2, 2))
    held = "*BOUNDARY\nA_Z0N, 1, 3\n"
    for i, kind in enumerate(KINDS):
        a = Part("A", kind, (0, 0, 0), (2, 1, 1), (3, 2, 2))
        b = Part("B", KINDS[(2 * i + 3) % len(KINDS)], (0.1, 0.1, 1.0), (1.9, 0.9, 2.0), (2, 2, 2), 1001)
        for name, option in options(f"tie-{kind}-{b.kind}"):
            size = 40 if option else 1
            load = "*DLOAD\n" + b.dload("Z1", -100.0 * size) + b.dload("X1", 50.0 * size)
            yield name, bodies(a, b) + STEEL + sections("A", "B") + "*TIE, NAME=T1\nB_Z0, A_Z1\n" + held + step(load + PRINTS, option)
    for word, z, x, option in (("gap", 1.2, 0.1, ", POSITION TOLERANCE=.5"), ("gap-kept", 1.2, 0.1, ", POSITION TOLERANCE=.5, ADJUST=NO"),
                               ("overlap", 0.93, 0.1, ", POSITION TOLERANCE=.2, ADJUST=NO"), ("partial", 1.0, 1.1, ", POSITION TOLERANCE=.01")):
        b = Part("B", "C3D8", (x, 0.1, z), (x + 1.8, 0.9, z + 1), (2, 2, 2), 1001)
        for name, nlgeom in options(f"tie-{word}"):
            load = "*DLOAD\n" + b.dload("Z1", -2000.0 if nlgeom else -100.0)
            yield name, bodies(base, b) + STEEL + sections("A", "B") + f"*TIE, NAME=T1{option}\nB_Z0, A_Z1\n" + held + step(load + PRINTS, nlgeom)
    b = Part("B", "C3D8", (0.1, 0.1, 1.0), (1.9, 0.9, 2.0), (2, 2, 2), 1001)
    yield "tie-transform", (bodies(base, b) + STEEL + sections("A", "B") + "*TRANSFORM, NSET=B_Z1N, TYPE=R\n1., 1., 0., -1., 1., 0.\n"
                            + "*TIE, NAME=T1\nB_Z0, A_Z1\n" + held + "*BOUNDARY\nB_Z1N, 1, 1, .01\n" + step("*CLOAD\nB_Z1N, 2, 20.\n" + PRINTS))
    yield "tie-temperature", (bodies(base, b) + STEEL + sections("A", "B") + "*TIE, NAME=T1\nB_Z0, A_Z1\n" + held
                              + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n" + step("*TEMPERATURE\nBN, 120.\n" + PRINTS))


def pretension_cases() -> Iterator[tuple[str, str]]:
    """A block cut across its middle: a force, then a shortening that is kept."""
    for kind in KINDS:
        if kind in ("C3D10",):
            continue  # CalculiX numbers the nodes that it adds in another order
        body = Part("A", kind, (0, 0, 0), (1, 1, 2), (2, 2, 4))
        corners = max(max(face) for face in FACES[kind]) + 1
        cut = ""
        for e, row in enumerate(body.elements):
            z = body.nodes[row[:corners], 2]
            cut += "".join(f"{e + 1}, S{f}\n" for f, face in enumerate(FACES[kind], 1) if z.max() < 1.001 and all(abs(z[k] - 1) < 1e-9 for k in face))
        model = bodies(body) + STEEL + sections("A") + f"*SURFACE, NAME=CUT\n{cut}*NODE, NSET=PN\n9999, 0., 0., 1.\n"
        model += "*PRE-TENSION SECTION, SURFACE=CUT, NODE=9999\n0., 0., 1.\n*BOUNDARY\nA_Z0N, 1, 3\nA_Z1N, 1, 3\n"
        out = PRINTS + "*NODE PRINT, NSET=PN\nU\n"
        for name, option in options(f"pretension-{kind}"):
            yield name, model + step("*CLOAD\n9999, 1, 100.\n" + out, option) + step("*BOUNDARY\nA_Z1N, 3, 3, .001\n" + out, option)
        if kind == "C3D8":
            yield "pretension-kept", model + step("*BOUNDARY\n9999, 1, 1, .003\n" + out) + step(
                "*BOUNDARY, FIXED\n9999, 1, 1\n*DLOAD\n" + body.dload("X1", 30.0) + out)


def ring_cases() -> Iterator[tuple[str, str]]:
    """A twelfth of a ring that turns, is pressed from inside and warmed."""

    def bend(x: Floats) -> Floats:
        angle = np.radians(x[:, 1])
        return np.stack([x[:, 0] * np.cos(angle), x[:, 0] * np.sin(angle), x[:, 2]], axis=1)

    for kind in ("C3D8", "C3D20", "C3D20R", "C3D10", "C3D4", "C3D15"):
        a = Part("A", kind, (1, 0, 0), (2, 30, 0.5), (3, 3, 2), bend=bend)
        free = [n for n in a.nodes_on("Z0") if n not in a.nodes_on("Y0")]  # dependent nodes can have no support
        point = a.label((float(np.cos(0.1745)), float(np.sin(0.1745)), 0.0))
        model = bodies(a) + f"*NSET, NSET=FREE\n{rows(free)}" + STEEL + sections("A") + "*TIE, CYCLIC SYMMETRY, NAME=T1\nA_Y0, A_Y1\n"
        model += "*CYCLIC SYMMETRY MODEL, N=12, TIE=T1\n0., 0., 0., 0., 0., 1.\n*BOUNDARY\nFREE, 3, 3\n"
        model += f"*TRANSFORM, TYPE=C, NSET=PT\n0., 0., 0., 0., 0., 1.\n*NSET, NSET=PT\n{point}\n*BOUNDARY\nPT, 2, 2\n"
        model += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n"
        for name, option in options(f"ring-{kind}"):
            load = "*DLOAD\nEALL, CENTRIF, 1.E8, 0., 0., 0., 0., 0., 1.\n" + a.dload("X0", 100.0)
            yield name, model + step(load + PRINTS, option) + step("*TEMPERATURE\nNALL, 120.\n" + PRINTS, option)


def line_cases() -> Iterator[tuple[str, str]]:
    """Trusses, springs, masses."""
    nodes = "*NODE, NSET=NALL\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 2., 0., 0.\n4, 1., 1., 0.\n5, 0., 1., 0.\n"
    frame = nodes + "*ELEMENT, TYPE=T3D2, ELSET=EALL\n1, 1, 2\n2, 2, 3\n3, 1, 4\n4, 2, 4\n5, 3, 4\n6, 5, 4\n" + STEEL + sections("EALL", rest=".01\n")
    frame += "*BOUNDARY\n1, 1, 3\n3, 2, 3\n5, 1, 3\n2, 3\n4, 3\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 0.\n"
    for name, option in options("truss"):
        yield name, (frame + step("*CLOAD\n4, 2, -10.\n" + PRINTS, option) + step("*DLOAD\nEALL, GRAV, 9.81E6, 0., -1., 0.\n" + PRINTS, option)
                     + step("*TEMPERATURE\nNALL, 50.\n" + PRINTS, option))
    body = Part("A", "C3D8", (0, 0, 0), (1, 1, 1), (2, 2, 2))
    corner, other = body.label((1, 1, 1)), body.label((0, 0, 1))
    model = bodies(body) + STEEL.replace("210000.", "2000.") + sections("A") + "*BOUNDARY\nA_Z0N, 1, 3\n"
    load = f"*CLOAD\n{corner}, 3, -30.\n{other}, 1, 5.\n" + PRINTS
    out = "*NODE PRINT, NSET=TN\nU, RF\n"
    far = "*NODE, NSET=TN\n501, 1.2, 1., 1.5\n*BOUNDARY\n501, 1, 3\n"
    table = "-20., -.5\n0., 0.\n10., .01\n40., .05\n"
    for name, option in options("spring1"):
        yield name, model + f"*ELEMENT, TYPE=SPRING1, ELSET=SP\n901, {corner}\n*SPRING, ELSET=SP\n3\n1000.\n" + step(load, option)
    for name, option in options("spring2"):
        yield name, model + far + f"*ELEMENT, TYPE=SPRING2, ELSET=SP\n901, {corner}, 501\n*SPRING, ELSET=SP\n3, 3\n1000.\n" + step(load + out, option)
    for law, data in (("", "1000.\n"), (", NONLINEAR", table)):
        yield f"springa{'-table' if law else ''}-nl", (model + far + f"*ELEMENT, TYPE=SPRINGA, ELSET=SP\n901, {corner}, 501\n"
                                                       + f"*SPRING, ELSET=SP{law}\n\n{data}" + step(load + out, NONLINEAR))
    yield "mass", (model + f"*ELEMENT, TYPE=MASS, ELSET=MS\n901, {corner}\n*MASS, ELSET=MS\n1.E-3\n"
                   + step("*DLOAD\nEALL, GRAV, 9810., 0., 0., -1.\nMS, GRAV, 9810., 0., 0., -1.\n" + PRINTS))


def reference_cases() -> Iterator[tuple[str, str]]:
    """Loads and motions of reference nodes, whose displacements and forces are printed."""
    body = Part("A", "C3D8", (0, 0, 0), (2, 1, 1), (4, 2, 2))
    model = bodies(body) + "*NODE, NSET=REF\n501, 2.5, .5, .6\n502, 2.5, .5, .6\n" + STEEL + sections("A") + "*BOUNDARY\nA_X0N, 1, 3\n"
    out = PRINTS + "*NODE PRINT, NSET=REF, TOTALS=YES\nU, RF\n"  # of a distributing coupling CalculiX prints no motion of the node
    kinds = {
        "rigid": ("*RIGID BODY, NSET=A_X1N, REF NODE=501, ROT NODE=502\n", [(501, 1, 10), (501, 2, 20), (502, 3, 15), (502, 1, -9)],
                  [(501, 1, 2e-4), (501, 2, -3e-4), (501, 3, 0), (502, 1, 0), (502, 2, 0), (502, 3, 1e-3)]),
        "rigid-ref": ("*RIGID BODY, NSET=A_X1N, REF NODE=501\n", [(501, 1, 10), (501, 2, 20)], [(501, 1, 2e-4), (501, 2, -3e-4), (501, 3, 0)]),
        "distributing": ("*COUPLING, REF NODE=501, SURFACE=A_X1, CONSTRAINT NAME=C1\n*DISTRIBUTING\n", [(501, 1, 10), (501, 2, 20), (501, 5, 15)], []),
        "kinematic": ("*COUPLING, REF NODE=501, SURFACE=A_X1, CONSTRAINT NAME=C1\n*KINEMATIC\n1, 3\n", [(501, 1, 10), (501, 2, 20), (501, 5, 15), (501, 6, -9)],
                      [(501, 1, 2e-4), (501, 2, -3e-4), (501, 3, 0), (501, 4, 0), (501, 5, 0), (501, 6, 1e-3)]),
    }
    for kind, (card, forces, motions) in kinds.items():
        for name, option in options(f"reference-{kind}"):
            size = 30 if option else 1
            print_out = PRINTS if kind == "distributing" else out
            yield f"{name}-loaded", model + card + step("*CLOAD\n" + "".join(f"{n}, {d}, {size * f}\n" for n, d, f in forces) + print_out, option)
            if motions:
                yield f"{name}-moved", model + card + step("*BOUNDARY\n" + "".join(f"{n}, {d}, {d}, {size * u}\n" for n, d, u in motions) + out, option)


def flow_cases() -> Iterator[tuple[str, str]]:
    """A bar of every kind bent and pulled until it flows, and back; creep that slows down with time; rings under large strain."""
    out = PRINTS.replace("S, E", "S, E, PEEQ, SDV")
    static = "*STATIC, DIRECT\n.25, 1.\n"
    for kind in KINDS:
        body = Part("A", kind, (0, 0, 0), (3, 1, 1), (3, 2, 2))
        model = bodies(body) + "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n*PLASTIC\n300., 0.\n400., .02\n450., .1\n" + sections("A") + "*BOUNDARY\nA_X0N, 1, 3\n"
        for name, option in options(f"flow-{kind}"):
            there, back = "*BOUNDARY\nA_X1N, 1, 1, .03\nA_X1N, 2, 2, .02\n", "*BOUNDARY\nA_X1N, 1, 1\n"
            yield name, model + step(there + out, option, static) + step(back + out, option, static)
    body = Part("A", "C3D8", (0, 0, 0), (3, 1, 1), (3, 2, 2))
    kinematic = bodies(body) + "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n*PLASTIC, HARDENING=KINEMATIC\n300., 0.\n800., .1\n" + sections("A")
    moved = "*BOUNDARY\nA_X0N, 1, 3\nA_X1N, 1, 1, .03\n"
    yield "flow-kinematic-nl", kinematic + step(moved + out, NONLINEAR, static) + step("*BOUNDARY\nA_X1N, 1, 1\n" + out, NONLINEAR, static)
    creeping = bodies(body) + "*MATERIAL, NAME=EL\n*ELASTIC\n210000., .3\n*CREEP, LAW=NORTON\n1.E-13, 4., -.3\n" + sections("A")
    load = "*BOUNDARY\nA_X0N, 1, 3\n*DLOAD\n" + body.dload("X1", -150.0)
    out = out.replace(", SDV", "")  # of creep laws CalculiX keeps fourteen values, the last one a rate
    # equal increments: in others t of time hardening is integrated here, and not there
    for name, option in options("creep"):
        yield name, creeping + step(load + out, option) + step(out, option, "*VISCO, CETOL=.01, DIRECT\n.5, 10.\n")
    # CalculiX passes over the exponent of time where the elasticity is anisotropic (each increment creeps as much): 0 here
    crystal = "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n210000., 150000., 90000., .3, .25, .2, 80000., 60000.\n50000.\n"
    yield "creep-orthotropic", creeping.replace("*ELASTIC\n210000., .3\n", crystal).replace("4., -.3", "4., 0.") + step(load + out) + step(
        out, "", "*VISCO, CETOL=.001, DIRECT\n.1, 10.\n"
    )
    for kind in ("CAX4", "CAX8R"):
        ring = Part("A", kind, (1, 0), (4, 1), (3, 2))
        model = bodies(ring) + "*MATERIAL, NAME=EL\n*HYPERELASTIC, NEO HOOKE\n5., .01\n" + sections("A") + "*BOUNDARY\nA_X0N, 1, 2\n"
        yield f"rubber-{kind}", model + step("*BOUNDARY\nA_X1N, 1, 1, .6\nA_X1N, 2, 2, .1\n*NODE PRINT, NSET=NALL\nU, RF\n", NONLINEAR, static)


LINEAR = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n2.E5, 1.\n"
HARD = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n"
EXPONENTIAL = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n1.E-3, 5.\n"
TABULAR = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., -1.E-4\n10., 0.\n300., 1.E-3\n2000., 2.E-3\n"
TIED = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.E5\n*FRICTION\n1., 5.E4\n"
RUB = "*FRICTION\n.3, 2.E4\n"
NODES, FACES_TYPE = "NODE TO SURFACE", "SURFACE TO SURFACE"


ONE_POINT_LAWS = {
    "elastic": "*ELASTIC\n10000., .3\n",
    "plastic": "*ELASTIC\n10000., .3\n*PLASTIC\n50., 0.\n100., .1\n",
    "creep": "*ELASTIC\n10000., .3\n*CREEP, LAW=NORTON\n1.E-6, 2., 0.\n",
    "orthotropic": "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n10000., 5000., 2000., .3, .25, .2, 2500., 3000.\n2000.\n",
    "rubber": "*HYPERELASTIC, MOONEY-RIVLIN\n800., 200., .0005\n",
}


def one_point_cases() -> Iterator[tuple[str, str]]:
    """A row of single elements with one point, stretched and pushed aside, which nothing resists but their hourglass stiffness."""
    for kind in ("C3D8R", "CPS4R", "CPE4R", "CAX4R"):
        for law, cards in ONE_POINT_LAWS.items():
            ends = ((0, 0, 0), (3, 1, 1), (3, 1, 1)) if kind == "C3D8R" else ((1, 0), (4, 1), (3, 1))
            body = Part("A", kind, *ends)
            model = bodies(body) + f"*MATERIAL, NAME=EL\n{cards}" + sections("A") + f"*BOUNDARY\nA_X0N, 1, {2 + (kind == 'C3D8R')}\n"
            static = "*VISCO, CETOL=.01, DIRECT\n.1, 1.\n" if law == "creep" else "*STATIC, DIRECT\n.25, 1.\n"
            out = "*NODE PRINT, NSET=NALL\nU\n*EL PRINT, ELSET=EALL\nS, E\n*NODE FILE\nU\n*EL FILE\nS, E\n"
            for name, option in options(f"one-point-{kind}-{law}"):
                if law != "rubber" or option:
                    yield name, model + step(f"*BOUNDARY\nA_X1N, 1, 1, {.3 if law == 'rubber' else .03}\n*CLOAD\nA_X1N, 2, {2. if law == 'rubber' else .2}\n" + out, option, static)


def contact_cases() -> Iterator[tuple[str, str]]:
    """A block on a wider one whose mesh does not match."""
    for kind in KINDS:
        for pair in (NODES, FACES_TYPE, "MORTAR"):
            yield f"contact-{kind}-{pair[0].lower()}", contact_deck(kind, pair, LINEAR, [push()])
    for pair in (NODES, FACES_TYPE, "MORTAR"):
        s = pair[0].lower()
        slide = [push(), push(x=0.001)]
        yield f"contact-hard-{s}", contact_deck("C3D8", pair, HARD, slide, NONLINEAR)
        yield f"contact-friction-{s}", contact_deck("C3D8", pair, LINEAR + RUB, slide, NONLINEAR)
        if pair == "MORTAR":
            continue
        yield f"contact-there-and-back-{s}", contact_deck("C3D8", pair, LINEAR + "*FRICTION\n.2, 5000.\n", [*slide, push(x=-0.002)], "", "*STATIC\n.5, 1.\n")
        yield f"contact-no-stick-slope-{s}", contact_deck("C3D8", pair, LINEAR + "*FRICTION\n.2\n", slide, NONLINEAR)
        yield f"contact-exponential-{s}", contact_deck("C3D8", pair, EXPONENTIAL + RUB, slide, NONLINEAR)
        yield f"contact-small-{s}", contact_deck("C3D8", pair, LINEAR, [push(), push(x=0.01)], NONLINEAR, option=", SMALL SLIDING")
        for word, gap, option in (("gap", 0.001, ""), ("adjust", 0.001, ", ADJUST=.002"), ("overlap", -0.001, ""), ("overlap-adjust", -0.001, ", ADJUST=0.")):
            yield f"contact-{word}-{s}", contact_deck("C3D8", pair, LINEAR, [push()], NONLINEAR, gap=gap, option=option)
        yield f"contact-clearance-{s}", contact_deck("C3D8", pair, LINEAR, [push()], NONLINEAR, gap=0.001,
                                                     extra="*CLEARANCE, SLAVE=B_Z0, MASTER=A_Z1, VALUE=.0005\n")
        change = "*CHANGE FRICTION, INTERACTION=SI\n*FRICTION\n.6, 2.E4\n"
        yield f"contact-change-{s}", contact_deck("C3D8", pair, LINEAR + RUB, [push(), change + push(x=0.002)], NONLINEAR)
    yield "contact-tabular-n", contact_deck("C3D8", NODES, TABULAR, [push(), push(-0.001)], NONLINEAR)
    yield "contact-tied-s", contact_deck("C3D8", FACES_TYPE, TIED, [push(0.001), push(0.001, 0.002)], NONLINEAR)


def push(z: float = -0.002, x: float = 0.0) -> str:
    """The top of the upper block is moved."""
    return f"*BOUNDARY\nB_Z1N, 1, 1, {x}\nB_Z1N, 2, 2\nB_Z1N, 3, 3, {z}\n"


def contact_deck(kind: str, pair: str, law: str, loads: list[str], nlgeom: str = "", static: str = "*STATIC\n", gap: float = 0.0,
                 option: str = "", extra: str = "") -> str:
    """Two blocks, a pair, and steps."""
    a = Part("A", kind, (-0.2, -0.3, -0.6), (1.5, 1.4, 0.0), (3, 4, 2))
    b = Part("B", kind, (0.0, 0.0, gap), (1.0, 1.0, 0.5 + gap), (2, 3, 2), 1001)
    out = "*NODE PRINT, NSET=NALL\nU, RF\n*EL PRINT, ELSET=EALL\nS\n*NODE FILE\nU, RF\n*EL FILE\nS\n"
    if pair != "MORTAR":  # CalculiX prints nothing of these
        out += "*CONTACT PRINT\nCDIS, CSTR\n*CONTACT PRINT, TOTALS=YES\nCELS, CNUM\n"
    if pair == FACES_TYPE:
        out += "*CONTACT PRINT, SLAVE=B_Z0, MASTER=A_Z1\nCF\n"
    text = bodies(a, b) + SOFT + sections("A", "B") + f"*SURFACE INTERACTION, NAME=SI\n{law}*CONTACT PAIR, INTERACTION=SI, TYPE={pair}{option}\nB_Z0, A_Z1\n"
    return text + extra + "*BOUNDARY\nA_Z0N, 1, 3\n" + "".join(step(load + out, nlgeom, static) for load in loads)


def output_cases() -> Iterator[tuple[str, str]]:
    """Requests of FILE and PRINT cards: local directions, sets of nodes, every field, its values over the increments."""
    axes = "*ORIENTATION, NAME=OR, SYSTEM=CYLINDRICAL\n0., 0., -1., 0., 0., 1.\n*TRANSFORM, NSET=AN, TYPE=C\n0., 0., -1., 0., 0., 1.\n"
    for kind in KINDS:
        a = Part("A", kind, (1, 0.3, 0), (2, 1.3, 1), (2, 2, 2))
        b = Part("B", kind, (2, 0.3, 0), (3, 1.3, 1), (2, 2, 2), 1001)
        model = bodies(a, b) + STEEL + "*SOLID SECTION, ELSET=A, MATERIAL=EL, ORIENTATION=OR\n" + sections("B") + axes
        model += "*NSET, NSET=SOME\n1, 2, 3, 1005, 1006\n*BOUNDARY\nA_Z0N, 1, 3\nB_Z0N, 1, 3\n"
        load = "*DLOAD\n" + a.dload("Z1", -100.0) + a.dload("X1", 250.0) + b.dload("Y1", 70.0)
        for word in ("NO", "YES"):
            out = f"*NODE PRINT, NSET=NALL, GLOBAL={word}\nU, RF\n*EL PRINT, ELSET=EALL, GLOBAL={word}\nS, E, ME\n"
            out += f"*NODE FILE, GLOBAL={word}\nU, RF\n*EL FILE, GLOBAL={word}\nS, E, ME, ERR\n"
            yield f"output-{kind}-global-{word.lower()}", model + step(load + out)
    out = "*NODE FILE, GLOBAL=NO, NSET=SOME\nU\n*NODE FILE\nRF\n*EL FILE, GLOBAL=NO\nS\n*EL FILE, NSET=SOME\nE, ENER\n*NODE PRINT, NSET=SOME\nU\n"
    yield "output-sets", model + step(load + out) + step("*NODE FILE\nRF, U\n") + step("*EL FILE\nME\n")
    a, b = Part("A", "C3D8", (0, 0, 0), (1, 1, 1), (2, 2, 2)), Part("B", "C3D8", (0.1, 0.1, 1), (0.9, 0.9, 2), (2, 2, 2), 1001)
    flowing = STEEL + "*PLASTIC\n200., 0.\n400., .1\n"
    model = bodies(a, b) + flowing + sections("A", "B") + f"*SURFACE INTERACTION, NAME=SI\n{LINEAR}{RUB}"
    model += "*CONTACT PAIR, INTERACTION=SI, TYPE=NODE TO SURFACE\nB_Z0, A_Z1\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*BOUNDARY\nA_Z0N, 1, 3\n"
    out = "*NODE FILE\nRF, U, NT\n*EL FILE\nERR, THE, PEEQ, ENER, S\n*CONTACT FILE\nCDIS, CSTR, CELS\n*EL PRINT, ELSET=EALL, TOTALS=YES\nENER, ELSE\n"
    for name, option in options("output-all"):
        yield name, model + step("*TEMPERATURE\nNALL, 50.\n" + push(-0.003) + out, option, "*STATIC, DIRECT\n.5, 1.\n")


def amplitude_cases() -> Iterator[tuple[str, str]]:
    """Supports of the model that are not zero, amplitudes over two steps: what acts at each increment."""
    body = Part("A", "C3D8", (0, 0, 0), (1, 1, 1), (1, 1, 1))
    model = bodies(body) + STEEL + "*AMPLITUDE, NAME=AM\n0., 0., .4, 1., 1., .5\n*AMPLITUDE, NAME=AT, TIME=TOTAL TIME\n0., 0., .4, 1., 2., .5\n"
    model += sections("A") + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*BOUNDARY\nA_Z0N, 1, 3\n"
    out, static = "*NODE PRINT, NSET=NALL\nU, RF\n", "*STATIC, DIRECT\n.2, 1.\n"
    pull, press, warm = "*BOUNDARY{}\nA_Z1N, 3, 3, -.1\n", "*CLOAD{}\nA_Z1N, 3, -100.\n", "*TEMPERATURE{}\nNALL, 100.\n"
    for word, amplitude in (("ramp", ""), ("amplitude", ", AMPLITUDE=AM"), ("total", ", AMPLITUDE=AT")):
        for option in ("", ", AMPLITUDE=STEP"):
            name = f"amplitude-model-{word}{'-step' if option else ''}"
            yield name, model + pull.format(amplitude) + step(out, NONLINEAR + option, static) + step("", NONLINEAR + option, static)
        yield f"amplitude-support-{word}", model + step(pull.format(amplitude) + out, NONLINEAR, static) + step("", NONLINEAR, static)
        yield f"amplitude-force-{word}", model + step(press.format(amplitude) + out, NONLINEAR, static) + step("", NONLINEAR, static)
        if word != "amplitude":  # in CalculiX it runs once more in a second step, at all nodes but one
            yield f"amplitude-warm-{word}", model + step(warm.format(amplitude) + "*NODE PRINT, NSET=NALL\nNT\n", NONLINEAR, static) + step("", NONLINEAR, static)
    heavy = model.replace("7.8E-9\n", "7.8E-9, 0.\n5.8E-9, 100.\n")
    for name, load in (("gravity", "GRAV, 9.81E6, 0., 0., -1."), ("turned", "CENTRIF, 1.E6, 0., 0., 0., 0., 0., 1.")):
        yield f"amplitude-density-{name}", heavy + step(f"*DLOAD\nEALL, {load}\n*TEMPERATURE\nNALL, 80.\n" + out, NONLINEAR, static)
    yield "amplitude-model-again", model + pull.format("") + step("*BOUNDARY\nA_Z1N, 3, 3, -.2\n" + out, NONLINEAR, static)
    yield "amplitude-perturbation", model + step(press.format("") + PRINTS, ", PERTURBATION")
    yield "amplitude-displaced", model + "*INITIAL CONDITIONS, TYPE=DISPLACEMENT\nA_Z1N, 3, -.1\n" + step(press.format("") + PRINTS, NONLINEAR)


def changed_cases() -> Iterator[tuple[str, str]]:
    """A bent bar whose stress goes and which is bent on; a face under the pressure of a node."""
    body = Part("A", "C3D20R", (0, 0, 0), (3, 1, 1), (3, 2, 2))
    model = bodies(body) + "*NODE\n900, 9., 9., 9.\n" + STEEL + sections("A") + "*BOUNDARY\nA_X0N, 1, 3\n"
    static = "*STATIC, DIRECT\n.5, 1.\n"
    bent, further = "*BOUNDARY\nA_X1N, 2, 2, .03\n", "*BOUNDARY\nA_X1N, 1, 1, .01\n"
    relief = "*MODEL CHANGE, TYPE=ELEMENT, MECHSTRAINTORESIDUAL\nA\n"
    yield "relieved", model + step(bent + PRINTS, NONLINEAR, static) + step(relief + further + PRINTS, NONLINEAR, static)
    for name, option in options("node-pressure"):
        faces = body.dload("X1", 900).replace(", 900", "NP, 900")
        yield name, model + step("*BOUNDARY\n900, 2, 2, 50.\n*DLOAD\n" + faces + PRINTS, option, static)


FAMILIES = [changed_cases, output_cases, amplitude_cases, tie_cases, pretension_cases, ring_cases, line_cases, reference_cases, flow_cases, one_point_cases, contact_cases]


def cases() -> dict[str, str]:
    """All decks by name."""
    return {name: text for family in FAMILIES for name, text in family()}
