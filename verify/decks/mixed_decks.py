"""Small decks of the calculix dialect over the cross product of what it has: for a comparison with CalculiX itself.

Each case is the text of a deck with a distorted mesh (the seed is fixed) and printed tables of all that can be printed. `cases()`
gives all of them by name.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from verify.decks.make_decks import block
from verify.decks.planes import grid_rows, number_mid_sides
from verify.decks.solids import KINDS, Solids, as_kind

Floats = NDArray[np.float64]
SEED = 20
PLANES = [f"{family}{n}" for family in ("CPS", "CPE", "CAX") for n in ("3", "4", "4R", "6", "8", "8R")]
STEEL = "*ELASTIC\n210000., .3\n*DENSITY\n7.8e-9\n"
TIP = {True: "TIP, 1, 3., \nTIP, 2, 1.5\nTIP, 3, -4.\n", False: "TIP, 1, 3.\nTIP, 2, -2.\n"}


@dataclass
class Body:
    """A mesh with named sets; indices from 0."""

    kind: str
    nodes: Floats
    elements: NDArray[np.int64]
    sets: dict[str, list[int]] = field(default_factory=dict)  #: of nodes
    faces: dict[str, list[tuple[int, int]]] = field(default_factory=dict)  #: (element, face from 1)

    @property
    def is_plane(self) -> bool:
        """Whether it lies in x-y."""
        return not self.kind.startswith("C3D")

    def cards(self) -> str:
        """Nodes, elements, sets NODES, ALL and those named, and surfaces."""
        lines = ["*NODE, NSET=NODES"]
        lines += [f"{i}, " + ", ".join(f"{v:.9g}" for v in x) for i, x in enumerate(self.nodes, start=1)]
        lines += [f"*ELEMENT, TYPE={self.kind}, ELSET=ALL"]
        for i, row in enumerate(self.elements, start=1):
            words = [str(i), *(str(n + 1) for n in row)]
            lines += [", ".join(words[:11]) + ("," if len(words) > 11 else "")]
            lines += [", ".join(words[11:])] if len(words) > 11 else []
        for name, members in self.sets.items():
            lines += [f"*NSET, NSET={name}"] + [", ".join(str(m + 1) for m in members[i : i + 8]) for i in range(0, len(members), 8)]
        for name, faces in self.faces.items():
            lines += [f"*SURFACE, NAME={name}"] + [f"{e + 1}, S{f}" for e, f in faces]
        return "\n".join(lines) + "\n"


def solid(kind: str, cells: tuple[int, int, int] = (2, 1, 1), distortion: float = 0.12, seed: int = SEED) -> Body:
    """A block of about 2 x 1 x 0.9 with the sets LEFT, RIGHT, TIP (one node), surfaces TOP and END; its left side is plane."""
    rng = np.random.default_rng(seed)
    name = {"C3D10M": "C3D10"}.get(kind, kind)
    axes = [np.linspace(0, length, n + 1) for length, n in zip((2.0, 1.0, 0.9), cells, strict=True)]
    grid = block(*axes, "B")
    ends = {}
    for axis, side in ((0, "x"), (2, "z")):
        ends[side] = set(np.flatnonzero(np.abs(grid.nodes[:, axis] - grid.nodes[:, axis].max()) < 1e-9).tolist())
    left = grid.nodes[:, 0] < 1e-9
    shift = distortion * (2 * rng.random(grid.nodes.shape) - 1)
    shift[left, 0] = 0.0
    grid.nodes = grid.nodes + shift
    made: Solids = as_kind(grid, name)
    n = len(grid.nodes)
    nodes = made.nodes.copy()
    if len(nodes) > n and distortion:
        bend = 0.03 * (2 * rng.random((len(nodes) - n, 3)) - 1)
        bend[nodes[n:, 0] < 1e-9, 0] = 0.0
        nodes[n:] += bend
    body = Body(kind, nodes, made.elements)
    body.sets["LEFT"] = np.flatnonzero(np.abs(nodes[:, 0]) < 1e-9).tolist()
    body.faces["END"] = [(int(e), int(f)) for e, f in made.outer_faces(ends["x"])]
    body.faces["TOP"] = [(int(e), int(f)) for e, f in made.outer_faces(ends["z"])]
    body.sets["RIGHT"] = sorted(nodes_of(made, body.faces["END"]))
    body.sets["TIP"] = [max(ends["x"] & ends["z"])]
    return body


def nodes_of(mesh: Solids, faces: Iterable[tuple[int, int]]) -> set[int]:
    """The corners of faces and the middles of their edges."""
    from verify.decks.solids import _EDGES, _HEX_EDGES, FACES, QUADRATIC

    edges = _EDGES.get(mesh.kind, _HEX_EDGES)
    result: set[int] = set()
    for e, f in faces:
        local = list(FACES[mesh.kind][f - 1])
        corners = set(local)
        if mesh.kind in QUADRATIC:
            first = 1 + max(max(edge) for edge in edges)
            local += [first + i for i, edge in enumerate(edges) if corners.issuperset(edge)]
        result.update(int(n) for n in mesh.elements[e][local])
    return result


def plane(kind: str, cells: tuple[int, int] = (2, 2), distortion: float = 0.1, seed: int = SEED, inner: float = 1.0) -> Body:
    """A sheet 2 x 1 (axisymmetric: of inner radius `inner`) with the sets of `solid`."""
    rng = np.random.default_rng(seed)
    x0 = inner if kind.startswith("CAX") else 0.0
    xs, ys = np.linspace(x0, x0 + 2, cells[0] + 1), np.linspace(0, 1, cells[1] + 1)
    nodes = np.array([[x, y] for y in ys for x in xs])
    is_left, is_right, is_top = nodes[:, 0] < x0 + 1e-9, nodes[:, 0] > x0 + 2 - 1e-9, nodes[:, 1] > 1 - 1e-9
    shift = distortion * (2 * rng.random(nodes.shape) - 1)
    shift[is_left, 0] = 0.0
    nodes = nodes + shift
    rows = grid_rows(len(xs), len(ys), kind)
    corners = len(rows[0])
    elements, made = number_mid_sides(rows, len(nodes), kind)
    places = [tuple(x) for x in nodes]
    for a, b in made:
        bend = 0.03 * (2 * rng.random(2) - 1) * bool(distortion)
        if is_left[a] and is_left[b]:
            bend[0] = 0.0
        places.append(tuple((nodes[a] + nodes[b]) / 2 + bend))
    body = Body(kind, np.array(places), np.array(elements))
    sides = {"LEFT": is_left, "RIGHT": is_right, "TOP": is_top}
    on = {name: set(np.flatnonzero(side).tolist()) for name, side in sides.items()}
    for name, members in on.items():
        all_members = members | {m for (a, b), m in made.items() if a in members and b in members}
        body.sets[name] = sorted(all_members)
    for name, side in (("END", "RIGHT"), ("TOP", "TOP")):
        body.faces[name] = [(e, i + 1) for e, row in enumerate(rows) for i in range(corners)
                            if {row[i], row[(i + 1) % corners]} <= on[side]]
    body.sets["TIP"] = [max(on["RIGHT"] & on["TOP"])]
    return body


def section(body: Body, material: str = "M", orientation: str = "", thickness: str = "") -> str:
    """*SOLID SECTION."""
    number = thickness or ("0.5" if body.kind[:3] in ("CPS", "CPE") else "")
    words = f", ORIENTATION={orientation}" if orientation else ""
    return f"*SOLID SECTION, ELSET=ALL, MATERIAL={material}{words}\n" + (number + "\n" if number else "")


def prints(node_items: str = "U, RF", element_items: str = "S, E, ENER, EVOL, ELSE", options: str = "") -> str:
    """Tables of all nodes and elements."""
    text = f"*NODE PRINT, NSET=NODES{options}, TOTALS=YES\n{node_items}\n"
    return text + (f"*EL PRINT, ELSET=ALL{options}, TOTALS=YES\n{element_items}\n" if element_items else "")


def step(cards: str, is_nlgeom: bool = False, static: str = "", options: str = "", kind: str = "*STATIC") -> str:
    """A step."""
    return f"*STEP{', NLGEOM' if is_nlgeom else ''}, INC=1000{options}\n{kind}\n{static}{cards}*END STEP\n"


def deck(body: Body, material: str, model: str, steps: str, sections: str = "") -> str:
    """A deck of one material M, its model cards and its steps."""
    return body.cards() + f"*MATERIAL, NAME=M\n{material}" + (sections or section(body)) + model + steps


def hold(body: Body) -> str:
    """The left side clamped."""
    return f"*BOUNDARY\nLEFT, 1, {2 if body.is_plane else 3}\n"


# ---------------------------------------------------------------------------------------------------- families


def pressures(body: Body, names: Iterable[str], value: float) -> str:
    """*DLOAD of the faces of surfaces."""
    return "*DLOAD\n" + "".join(f"{e + 1}, P{f}, {value * (1 + 0.1 * e):g}\n" for name in names for e, f in body.faces[name])


def element_cases() -> Iterator[tuple[str, str]]:
    """Every element under every load, at small displacements and with NLGEOM."""
    for kind in [*KINDS, "C3D10M", *PLANES]:
        body = plane(kind) if not kind.startswith("C3D") else solid(kind)
        for is_nlgeom in (False, True):
            yield f"element-{kind}{'-nl' if is_nlgeom else ''}", element_deck(body, is_nlgeom)


def element_deck(body: Body, is_nlgeom: bool) -> str:
    """Steps: a force, pressures, gravity and rotation, temperatures."""
    strong = 40.0 if is_nlgeom else 1.0
    material = STEEL + "*EXPANSION, ZERO=20.\n1.2e-5\n"
    model = hold(body) + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 30.\n"
    axis = "0., 0., 0., 0., 1., 0." if body.kind.startswith("CAX") else "0.3, 0.2, 0.1, 0., 0., 1."
    pull = "0., -1., 0." if body.kind.startswith("CAX") else "0.6, -.8, 0."
    tip = "".join(f"TIP, {i}, {v * strong}\n" for i, v in ((1, 30.0), (2, -20.0), (3, 10.0)) if i < 3 or not body.is_plane)
    loads = [
        f"*CLOAD\n{tip}",
        "*CLOAD, OP=NEW\n" + pressures(body, ["END", "TOP"], 10 * strong).replace("*DLOAD", "*DLOAD, OP=NEW"),
        f"*DLOAD, OP=NEW\nALL, GRAV, 9.81E8, {pull}\nALL, CENTRIF, 1.E9, {axis}\n",
        "*DLOAD, OP=NEW\n*TEMPERATURE\nNODES, 220.\n",
    ]
    if is_nlgeom:
        loads = loads[:1] + [loads[1]] + loads[2:]
    return deck(body, material, model, "".join(step(load + prints(), is_nlgeom) for load in loads))


# ---------------------------------------------------------------------------------------------------- materials

ELASTIC = {
    "iso": "*ELASTIC\n210000., .3\n",
    "iso-table": "*ELASTIC\n210000., .3, 20.\n180000., .33, 120.\n150000., .36, 320.\n",
    "ortho": "*ELASTIC, TYPE=ORTHO\n500000., 157200., 400000., 157200., 157200., 300000., 126200., 106200.,\n86200.\n",
    "engineering": "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n200000., 150000., 100000., .3, .25, .2, 70000., 60000.,\n50000.\n",
    "aniso": "*ELASTIC, TYPE=ANISO\n500000., 157200., 400000., 157200., 157200., 300000., 8000., -6000.,\n"
             "5000., 126200., 4000., 3000., -2000., 6000., 106200., 7000.,\n1000., 2000., 3000., 4000., 86200.\n",
}
ORIENTATIONS = {
    "": "",
    "rect": "*ORIENTATION, NAME=OR\n.8, .3, .2, -.2, .9, .1\n",
    "rect-turn": "*ORIENTATION, NAME=OR\n.8, .3, .2, -.2, .9, .1\n3, 25.\n",
    "cyl": "*ORIENTATION, NAME=OR, SYSTEM=CYLINDRICAL\n-.5, -1., 0., -.4, -1., 1.\n",
}
PLASTIC = {
    "isotropic": "*PLASTIC\n200., 0.\n300., .002\n350., .01\n",
    "isotropic-T": "*PLASTIC\n200., 0., 20.\n300., .002, 20.\n350., .01, 20.\n100., 0., 220.\n130., .004, 220.\n",
    "kinematic": "*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n300., .002\n350., .01\n",
    "combined": "*PLASTIC, HARDENING=COMBINED\n200., 0.\n300., .002\n350., .01\n*CYCLIC HARDENING\n200., 0.\n230., .004\n250., .02\n",
    "perfect": "*PLASTIC\n250., 0.\n",
}
RUBBER = {
    "neo-hooke": "*HYPERELASTIC, NEO HOOKE\n50., .004\n",
    "mooney": "*HYPERELASTIC, MOONEY-RIVLIN\n40., 10., .004\n",
    "yeoh": "*HYPERELASTIC, YEOH\n50., 5., .5, .004, .004, .004\n",
    "poly1": "*HYPERELASTIC, POLYNOMIAL, N=1\n40., 10., .004\n",
    "poly2": "*HYPERELASTIC, POLYNOMIAL, N=2\n40., 10., 1., 1., 1., .004, .004\n",
    "poly3": "*HYPERELASTIC, POLYNOMIAL, N=3\n40., 10., 1., 1., 1., .1, .1, .1,\n.1, .004, .004, .004\n",
    "reduced1": "*HYPERELASTIC, REDUCED POLYNOMIAL, N=1\n50., .004\n",
    "reduced2": "*HYPERELASTIC, REDUCED POLYNOMIAL, N=2\n50., 5., .004, .004\n",
    "reduced3": "*HYPERELASTIC, REDUCED POLYNOMIAL, N=3\n50., 5., 1., .004, .004, .004\n",
    "ogden1": "*HYPERELASTIC, OGDEN, N=1\n100., 1.8, .004\n",
    "ogden2": "*HYPERELASTIC, OGDEN, N=2\n80., 1.8, 10., -2., .004, .004\n",
    "ogden3": "*HYPERELASTIC, OGDEN, N=3\n80., 1.8, 10., -2., 5., 4., .004, .004,\n.004\n",
    "arruda": "*HYPERELASTIC, ARRUDA-BOYCE\n100., 2., .004\n",
    "foam1": "*HYPERFOAM, N=1\n100., 4., .2\n",
    "foam2": "*HYPERFOAM, N=2\n100., 4., 20., -2., .2, .1\n",
    "foam3": "*HYPERFOAM, N=3\n100., 4., 20., -2., 10., 2., .2, .1,\n.3\n",
}


def shove(size: float) -> str:
    """The right side is moved."""
    return f"*BOUNDARY\nRIGHT, 1, 1, {size}\nRIGHT, 2, 2, {-0.6 * size}\nRIGHT, 3, 3, {0.4 * size}\n"


def material_cases() -> Iterator[tuple[str, str]]:
    """Every law."""
    for kind in ("C3D8", "C3D20R", "C3D10"):
        body = solid(kind)
        for name, elastic in ELASTIC.items():
            for turned, orientation in ORIENTATIONS.items():
                if (turned and name.startswith("iso")) or (kind != "C3D20R" and turned in ("rect", "rect-turn")):
                    continue
                for is_nlgeom in (False, True):
                    yield (f"elastic-{kind}-{name}{turned and '-' + turned}{'-nl' if is_nlgeom else ''}",
                           elastic_deck(body, elastic, turned and orientation, is_nlgeom))
        for name, plastic in PLASTIC.items():
            for is_nlgeom in (False, True):
                yield f"plastic-{kind}-{name}{'-nl' if is_nlgeom else ''}", plastic_deck(body, plastic, is_nlgeom)
        for name, rubber in RUBBER.items():
            if kind == "C3D20R" or name in ("neo-hooke", "foam1", "ogden1"):
                yield f"rubber-{kind}-{name}", rubber_deck(body, rubber)
        yield f"ramberg-{kind}", deck(body, "*DEFORMATION PLASTICITY\n210000., .3, 200., 6., .4\n", hold(body),
                                      step(shove(0.01) + prints()))
        yield f"ramberg-{kind}-nl", deck(body, "*DEFORMATION PLASTICITY\n210000., .3, 200., 6., .4\n", hold(body),
                                         step(shove(0.01) + prints(), True))
        for is_nlgeom in (False, True):
            yield f"creep-{kind}{'-nl' if is_nlgeom else ''}", creep_deck(body, is_nlgeom)
    yield from expansion_cases()


def elastic_deck(body: Body, elastic: str, orientation: str, is_nlgeom: bool) -> str:
    """Pulled and heated; printed in global axes and in those of the material."""
    size = 0.1 if is_nlgeom else 0.002
    model = orientation + hold(body) + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n"
    local = "*EL PRINT, ELSET=ALL, GLOBAL=NO\nS, E\n" if orientation else ""
    steps = step(shove(size) + prints(element_items="S, E, ME, ENER"), is_nlgeom)
    steps += step("*TEMPERATURE\nNODES, 150.\n" + ("*NODE PRINT, NSET=NODES\nU, RF\n" + local if local else prints()), is_nlgeom)
    return deck(body, elastic + "*EXPANSION\n1.E-5\n", model, steps, section(body, orientation="OR" if orientation else ""))


def plastic_deck(body: Body, plastic: str, is_nlgeom: bool) -> str:
    """There, back, and heated."""
    size = 0.08 if is_nlgeom else 0.008
    model = hold(body) + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n"
    direct = "*STATIC, DIRECT"
    steps = step(shove(size) + prints(element_items="S, E, ME, PEEQ, ENER"), is_nlgeom, ".25, 1.\n", kind=direct)
    steps += step(shove(-0.5 * size) + prints(element_items="S, E, ME, PEEQ, ENER"), is_nlgeom, ".25, 1.\n", kind=direct)
    steps += step("*TEMPERATURE\nNODES, 150.\n" + prints(element_items="S, PEEQ"), is_nlgeom, ".5, 1.\n", kind=direct)
    return deck(body, "*ELASTIC\n210000., .3\n" + plastic + "*EXPANSION\n1.E-5\n", model, steps)


def rubber_deck(body: Body, rubber: str) -> str:
    """Sheared, pulled and pressed."""
    steps = step(shove(0.3) + prints(element_items="S, E, ME, ENER"), True, ".25, 1.\n", kind="*STATIC, DIRECT")
    steps += step(shove(-0.3) + prints(element_items="S, E, ME, ENER"), True, ".25, 1.\n", kind="*STATIC, DIRECT")
    return deck(body, rubber, hold(body), steps)


def creep_deck(body: Body, is_nlgeom: bool) -> str:
    """Loaded at once, then creeping."""
    material = "*ELASTIC\n210000., .3\n*CREEP, LAW=NORTON\n1.E-12, 4., 0.\n"
    steps = step(shove(0.002) + prints(element_items="S, E, PEEQ"), is_nlgeom)
    steps += step(prints(element_items="S, E, PEEQ"), is_nlgeom, ".1, 1.\n", kind="*VISCO, CETOL=1.E-3, DIRECT")
    return deck(body, material, hold(body), steps)


def expansion_cases() -> Iterator[tuple[str, str]]:
    """Thermal strain: tables, ZERO, ortho, fields that vary."""
    body = solid("C3D20R")
    field = "".join(f"{i + 1}, {100 + 40 * x[0] + 10 * x[1] * x[2]:.6g}\n" for i, x in enumerate(body.nodes))
    laws = {
        "iso": "*EXPANSION\n1.E-5\n", "zero": "*EXPANSION, ZERO=50.\n1.E-5\n",
        "table": "*EXPANSION, ZERO=-20.\n1.E-5, 0.\n1.6E-5, 100.\n2.E-5, 300.\n",
        "ortho": "*EXPANSION, TYPE=ORTHO\n1.E-5, 2.E-5, -.5E-5\n",
        "aniso": "*EXPANSION, TYPE=ANISO\n1.E-5, 2.E-5, -.5E-5, .3E-5, .2E-5, .1E-5\n",
    }
    for name, law in laws.items():
        for turned in ("", "rect"):
            for is_nlgeom in (False, True):
                model = ORIENTATIONS[turned] + hold(body) + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 30.\n"
                steps = step("*TEMPERATURE\n" + field + prints("U, RF, NT", "S, E, ME, ENER"), is_nlgeom)
                steps += step("*TEMPERATURE, OP=NEW\n" + prints("U, RF, NT", "S, E, ME, ENER"), is_nlgeom)
                yield (f"expansion-{name}{turned and '-' + turned}{'-nl' if is_nlgeom else ''}",
                       deck(body, ELASTIC["iso-table"] + law, model, steps, section(body, orientation=turned and "OR")))


# ---------------------------------------------------------------------------------------------------- constraints


def constraint_cases() -> Iterator[tuple[str, str]]:
    """Ties of motions, small and with NLGEOM."""
    for kind in ("C3D8", "C3D20R", "C3D10"):
        for name, (model, cards) in constraints(solid(kind)).items():
            body = solid(kind, distortion=0.0 if name in ("plane", "straight") else 0.12)  # these start in a plane, on a line
            for is_nlgeom in (False, True):
                strong = 20.0 if is_nlgeom else 1.0
                load = re.sub(r"(TIP|REF|ROT)(, \d, )(\S+)", lambda m: f"{m[1]}{m[2]}{strong * float(m[3]):g}", cards)
                items = prints(element_items="S, E")
                text = deck(body, STEEL, model, step(load + items, is_nlgeom) + step("*CLOAD, OP=NEW\nTIP, 2, 20.\n" + items, is_nlgeom))
                yield f"bond-{kind}-{name}{'-nl' if is_nlgeom else ''}", text


def constraints(body: Body) -> dict[str, tuple[str, str]]:
    """Model cards and loads by name."""
    held = hold(body)
    n = len(body.nodes)
    ref = f"*NODE, NSET=REF\n{n + 1}, 2.2, .4, .5\n*NODE, NSET=ROT\n{n + 2}, 2.2, .4, .5\n"
    tip = "*CLOAD\nTIP, 1, 30.\nTIP, 2, -20.\nTIP, 3, 10.\n"
    moved = "*CLOAD\nREF, 1, 30.\nREF, 2, -40.\nREF, 3, 10.\n"
    turned = "*CLOAD\nROT, 1, 20.\nROT, 2, 30.\nROT, 3, -20.\n"
    right = [m + 1 for m in body.sets["RIGHT"]]
    a, b, c = right[0], right[1], right[2]
    corners = right[:4]
    surface = f"*COUPLING, REF NODE={n + 1}, SURFACE=END, CONSTRAINT NAME=C\n"
    moment = "*CLOAD\nREF, 1, 30.\nREF, 2, -40.\nREF, 4, 5.\nREF, 5, 12.\nREF, 6, -9.\n"
    return {
        "equation": (held + f"*EQUATION\n3\n{a}, 1, 1., {b}, 2, -.5, {c}, 3, .7\n2\n{a}, 3, 1., {b}, 3, -1.\n", tip),
        "equation-load": (held + f"*EQUATION\n3\n{body.sets['TIP'][0] + 1}, 1, 2., {a}, 1, -.5, {a}, 2, .7\n", tip),
        "plane": (held + "*MPC\nPLANE, " + ", ".join(map(str, corners)) + "\n", tip),
        "straight": (held + "*MPC\nSTRAIGHT, " + ", ".join(str(m) for m in (1, 2, 3)) + "\n", tip),
        "rigid": (ref + held + f"*RIGID BODY, NSET=RIGHT, REF NODE={n + 1}, ROT NODE={n + 2}\n", moved + turned.replace("*CLOAD\n", "")),
        "rigid-ref": (ref + held + f"*RIGID BODY, NSET=RIGHT, REF NODE={n + 1}\n", moved),
        "rigid-elset": (ref + held.replace("LEFT", "REF") + f"*BOUNDARY\nROT, 1, 3\n*RIGID BODY, NSET=LEFT, REF NODE={n + 1}, ROT NODE={n + 2}\n", tip),
        "kinematic": (ref + held + surface + "*KINEMATIC\n1, 3\n", moment),
        "kinematic-12": (ref + held + surface + "*KINEMATIC\n1, 2\n", moment),
        "kinematic-or": (ref + held + ORIENTATIONS["cyl"] + surface.rstrip() + ", ORIENTATION=OR\n*KINEMATIC\n2, 3\n", moment),
        "distributing": (ref + held + surface + "*DISTRIBUTING\n1, 3\n", moment),
        "distributing-or": (ref + held + ORIENTATIONS["rect"] + surface.rstrip() + ", ORIENTATION=OR\n*DISTRIBUTING\n1, 3\n", moment),
        "transform": (held + "*TRANSFORM, NSET=TIP, TYPE=R\n.8, .3, .2, -.2, .9, .1\n", tip),
        "transform-cyl": (held.replace("LEFT, 1, 3", "LEFT, 2, 3") + "*TRANSFORM, NSET=NODES, TYPE=C\n-.5, -1., 0., -.4, -1., 1.\n"
                          + "*BOUNDARY\nLEFT, 1, 1\n", tip + "*NODE PRINT, NSET=NODES, GLOBAL=NO\nU, RF\n"),
        "meanrot": (ref.replace(f"{n + 1}, 2.2, .4, .5", f"{n + 1}, 1., 0., 0.") + held + f"*MPC\nMEANROT, {', '.join(f'{m}, {m}, {m}' for m in corners)}, {n + 1}\n", tip),
    }


# ---------------------------------------------------------------------------------------------------- steps


def step_cases() -> Iterator[tuple[str, str]]:
    """Loads that stay, go, ramp and follow amplitudes; increments; what is printed when."""
    body = solid("C3D8")
    held = hold(body)
    short = "*NODE PRINT, NSET=TIP\nU\n*NODE PRINT, NSET=LEFT, TOTALS=ONLY\nRF\n"
    force = "*CLOAD\nTIP, 1, 30.\nTIP, 2, -20.\n"
    ramp = "*AMPLITUDE, NAME=A\n0., 0., .3, .8, .5, .2, 1., 1.\n"
    total = "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., .5, 1., 1.5, .4, 3., 1.\n"
    quarter = ".25, 1.\n"

    def make(*steps: str, model: str = "") -> str:
        return deck(body, STEEL, held + model, "".join(steps))

    def direct(cards: str, static: str = quarter, is_nlgeom: bool = False, options: str = "") -> str:
        return step(cards + short, is_nlgeom, static, options, "*STATIC, DIRECT")

    yield "steps-op-mod", make(direct(force), direct("*CLOAD, OP=MOD\nTIP, 2, 10.\n"), direct("*CLOAD\nTIP, 3, 10.\n"))
    yield "steps-op-new", make(direct(force), direct("*CLOAD, OP=NEW\nTIP, 2, 10.\n"), direct("*CLOAD, OP=NEW\n"))
    yield "steps-op-new-total", make(direct(force.replace("*CLOAD", "*CLOAD, AMPLITUDE=A") + "*DLOAD, AMPLITUDE=A\n1, P1, 10.\nALL, GRAV, 1.E9, 0., 0., -1.\n", is_nlgeom=True),
                                     direct("*CLOAD, OP=NEW\nTIP, 3, 7.\n*DLOAD, OP=NEW\n", is_nlgeom=True), model=total)
    yield "steps-dload", make(direct("*DLOAD\n1, P1, 10.\n2, P4, 5.\nALL, GRAV, 1.E9, 0., 0., -1.\n"), direct("*DLOAD\n1, P1, 20.\n"),
                              direct("*DLOAD, OP=NEW\n2, P4, 1.\n"))
    yield "steps-amplitude", make(direct(force.replace("*CLOAD", "*CLOAD, AMPLITUDE=A")), direct("*CLOAD\nTIP, 2, 10.\n"), model=ramp)
    yield "steps-total-time", make(direct(force.replace("*CLOAD", "*CLOAD, AMPLITUDE=A")), direct(""), direct(""), model=total)
    yield "steps-step", make(direct(force, options=", AMPLITUDE=STEP"), direct("*CLOAD, OP=NEW\nTIP, 1, 5.\n", options=", AMPLITUDE=STEP"))
    yield "steps-boundary", make(direct("*BOUNDARY\nTIP, 1, 1, .01\n"), direct("*BOUNDARY\nTIP, 2, 2, .02\n"), direct(
        "*BOUNDARY, OP=NEW\nLEFT, 1, 3\nTIP, 2, 2, .01\n"))
    yield "steps-boundary-new", make(direct("*BOUNDARY\nTIP, 1, 1, .01\n" + force), direct("*BOUNDARY, OP=NEW\nLEFT, 1, 3\n"))
    yield "steps-boundary-amplitude", make(direct("*BOUNDARY, AMPLITUDE=A\nTIP, 1, 1, .01\n"), direct("*BOUNDARY\nTIP, 2, 2, .02\n"), model=ramp)
    yield "steps-fixed", make(direct(force), direct("*CLOAD, OP=NEW\n*BOUNDARY, FIXED\nTIP, 1, 3\n"), direct(""))
    yield "steps-delay", make(direct("*CLOAD, AMPLITUDE=A, TIME DELAY=.5\nTIP, 1, 30.\n", ".125, 1.\n"), model=ramp)
    yield "steps-reset", make(direct(force), step("*CLOAD\nTIP, 1, 10.\n" + short, False, quarter, kind="*STATIC, DIRECT, TIME RESET"), direct(""))
    yield "steps-start", make(step(force + short, False, quarter, kind="*STATIC, DIRECT, TOTAL TIME AT START=2."), direct(""))
    yield "steps-auto", make(step(force + short, False, ".1, 1.\n"), step("*CLOAD\nTIP, 1, 50.\n" + short, False, ".1, 2., , .5\n"))
    yield "steps-auto-nl", make(step("*CLOAD\nTIP, 1, 3000.\nTIP, 2, 2000.\n" + short, True, ".1, 1.\n"))
    yield "steps-default", make(step(force + short), step("*CLOAD\nTIP, 1, 50.\n" + short, True), step("*CLOAD, OP=NEW\nTIP, 2, 9.\n" + short))
    yield "steps-uneven", make(direct(force, ".3, 1.\n"), direct("*CLOAD\nTIP, 1, 10.\n", ".4, 1.5\n"))
    yield "steps-frequency-nl", make(step(force + "*NODE PRINT, NSET=TIP, FREQUENCY=3\nU\n", True, ".1, 1.\n", kind="*STATIC, DIRECT"),
                                     step("*CLOAD\nTIP, 2, 1.\n", True, ".25, 1.\n", kind="*STATIC, DIRECT"))
    times = "*TIME POINTS, NAME=T\n.33, .5, .91\n"
    yield "steps-points", make(step("*CLOAD\nTIP, 1, 30.\n*NODE PRINT, NSET=TIP, TIME POINTS=T\nU\n", False, ".1, 1.\n"), model=times)
    yield "steps-points-nl", make(step("*CLOAD\nTIP, 1, 30.\n*NODE PRINT, NSET=TIP, TIME POINTS=T\nU\n", True, ".1, 1., , .4\n"), model=times)
    yield "steps-temperature", make(
        step("*TEMPERATURE, AMPLITUDE=A\nNODES, 100.\n" + prints("U, NT", "S"), False, quarter, kind="*STATIC, DIRECT"),
        step("*TEMPERATURE\nTIP, 50.\n" + prints("U, NT", "S"), False, quarter, kind="*STATIC, DIRECT"),
        model=ramp + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNODES, 20.\n").replace(STEEL, STEEL + "*EXPANSION\n1.E-5\n")
    yield "steps-mixed-nl", make(direct(force), direct("*CLOAD\nTIP, 1, 2000.\n", is_nlgeom=True), direct("*CLOAD, OP=NEW\n"))
    for kind in ("C3D8", "C3D20R"):
        stressed = solid(kind)
        points = {"C3D8": 8, "C3D20R": 8}[kind]
        lines = "".join(f"{e + 1}, {p + 1}, {10 + e}, {p}, 5., 2., 1., -{p}.\n" for e in range(len(stressed.elements)) for p in range(points))
        for is_nlgeom in (False, True):
            yield f"stress-{kind}{'-nl' if is_nlgeom else ''}", deck(
                stressed, STEEL, hold(stressed) + "*INITIAL CONDITIONS, TYPE=STRESS\n" + lines, step(force + prints(), is_nlgeom))
        if kind == "C3D20R":
            continue  # two of them have modes of nearly no energy
        strains = "".join(f"{e + 1}, {p + 1}, {5 + e}E-4, {p}E-4, 1.E-4, 1.E-4, 0., -1.E-4\n" for e in range(len(stressed.elements)) for p in range(points))
        yield f"strained-{kind}-plastic-nl", deck(stressed, STEEL + "*PLASTIC\n900., 0.\n1200., .1\n", hold(stressed)
                                                       + "*INITIAL CONDITIONS, TYPE=PLASTIC STRAIN\n" + strains, step(force + prints(), True))


# ---------------------------------------------------------------------------------------------------- output


def output_cases() -> Iterator[tuple[str, str]]:
    """What can be printed, in what order."""
    body = solid("C3D8")
    load = "*CLOAD\nTIP, 1, 30.\nTIP, 2, -20.\n"
    for kind in ("C3D8", "C3D20R", "C3D10", "C3D6", "C3D4", "C3D15", "C3D20"):
        body = solid(kind)
        yield f"output-section-{kind}", deck(body, STEEL, hold(body), step(
            load + "*SECTION PRINT, SURFACE=END, NAME=SP\nSOF, SOM, SOAREA\n*SECTION PRINT, SURFACE=TOP, NAME=SQ\nSOF, SOM, SOAREA\n"))
        yield f"output-all-{kind}", deck(body, STEEL, hold(body), step(
            load + "*EL PRINT, ELSET=ALL, TOTALS=YES\nEVOL, ELSE, ENER, E, S, COORD, ME\n"
            "*NODE PRINT, NSET=TIP\nRF, U, COORD\n*NODE PRINT, NSET=RIGHT, TOTALS=YES\nRF\n*NODE PRINT, NSET=LEFT, TOTALS=ONLY\nRF\n"
            "*EL PRINT, ELSET=ALL, TOTALS=ONLY\nEVOL, ELSE\n*SECTION PRINT, SURFACE=END, NAME=SP\nSOF\n"))


# ---------------------------------------------------------------------------------------------------- all


def cases() -> dict[str, str]:
    """All decks by name."""
    result: dict[str, str] = {}
    for family in FAMILIES:
        result.update(dict(family()))
    return result


FAMILIES = [element_cases, material_cases, constraint_cases, step_cases, output_cases]
