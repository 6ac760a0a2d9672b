"""Random small assemblies under changes that may not change the result: an open pair far away, other numbers, a rotation, metres, two steps, general contact.

    python -m verify.study.random_assemblies --seeds 1 100       a row for each comparison that differs, and the sums
    python -m verify.study.random_assemblies --deck 17           the deck of one seed
    python -m verify.study.random_assemblies --deck 17 rotated   the same under a change
    python -m verify.study.random_assemblies --changes far-pair  one change alone

A block stands fixed. On it lies a block or a shell, on that a block; a small block is tied to a side of the lowest one. A coupling moves the highest one,
by a force or a displacement, directly or over a beam. Element kinds, meshes, moduli, friction, formulation, side of the slave, NLGEOM, sliding, dialect
and increments are drawn from the seed. Supports leave one equilibrium.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

import h5py
import numpy as np

from verify.decks.make_decks import Floats, block
from verify.decks.solids import as_kind

ROOT = Path(__file__).resolve().parents[2]
SOLIDS = ["C3D8", "C3D8I", "C3D10", "C3D20", "C3D20R", "C3D15", "C3D6", "C3D4"]
SHELLS = ["S4", "S4R", "S8R"]
LINEAR = {"C3D8", "C3D8I", "C3D4", "C3D6"}
REF, TIP = 90001, 90002  #: node of the coupling, and the other end of the beam
EQUAL = 1e-5  #: of the largest displacement or force: the controls are tight
BITS = 0.0
LIMIT = 120.0  #: seconds of a job
CHANGES = {
    "far-pair": EQUAL, "far-pair-slave": EQUAL, "renumbered": EQUAL, "rotated": EQUAL, "metres": EQUAL, "two-steps": EQUAL, "general": EQUAL, "resumed": BITS,
    "balance": EQUAL,
}  # fmt: skip


@dataclass
class Body:
    """A part: nodes, elements and the sides that contact, ties and loads need; indices from 0."""

    name: str
    kind: str
    nodes: Floats
    elements: list[list[int]]
    sides: dict[str, list[tuple[int, str]]]  #: (element, face) of each side
    ends: dict[str, list[int]]  #: nodes of each side
    thickness: float = 0.0  #: of a shell


@dataclass
class Assembly:
    """What a seed draws."""

    seed: int
    dialect: str
    bodies: list[Body]
    moduli: list[tuple[float, float]]
    pairs: list[tuple[str, str]]  #: slave and master surface
    form: str
    mu: float
    is_small_sliding: bool
    is_nlgeom: bool
    n_increments: int
    has_beam: bool
    is_force: bool
    down: float
    along: float
    top: float  #: height of the coupling's node
    held: dict[str, list[int]] = field(default_factory=dict)  #: nodes of a body that are held across

    @property
    def description(self) -> str:
        """The drawn parameters in a line."""
        kinds = " on ".join(body.kind for body in reversed(self.bodies[:3]))
        return (f"{self.dialect}, {kinds}, {self.form.lower()}, slaves {', '.join(s for s, _ in self.pairs)}, mu {self.mu}"
                f"{', beam' if self.has_beam else ''}, {'force' if self.is_force else 'displacement'}{', NLGEOM' if self.is_nlgeom else ''}"
                f"{', small sliding' if self.is_small_sliding else ''}, {self.n_increments} increments")  # fmt: skip


def solid(name: str, kind: str, cells: tuple[int, int, int], low: tuple[float, float, float], high: tuple[float, float, float]) -> Body:
    """A block of solids with the sides X0, X1, ... Z1."""
    lines = [np.linspace(low[k], high[k], cells[k] + 1) for k in range(3)]
    mesh = as_kind(block(*lines, name=name), kind)
    places = {f"{'XYZ'[axis]}{end}": mesh.where(axis, (low, high)[end][axis]) for axis in range(3) for end in (0, 1)}
    sides = {side: [(e, f"S{f}") for e, f in mesh.outer_faces(members)] for side, members in places.items()}
    return Body(name, kind, mesh.nodes, mesh.elements.tolist(), sides, {side: members.tolist() for side, members in places.items()})


def shell(name: str, kind: str, cells: tuple[int, int], low: tuple[float, float], high: tuple[float, float], middle: float, thickness: float) -> Body:
    """A plate of shells; its sides Z0 and Z1 are SNEG and SPOS."""
    nx, ny = cells
    xs, ys = np.linspace(low[0], high[0], 2 * nx + 1), np.linspace(low[1], high[1], 2 * ny + 1)
    is_quadratic = kind == "S8R"
    used = [(i, j) for j in range(2 * ny + 1) for i in range(2 * nx + 1) if (i % 2 == 0 and j % 2 == 0) or (is_quadratic and i % 2 + j % 2 == 1)]
    number = {place: k for k, place in enumerate(used)}
    around = [(0, 0), (2, 0), (2, 2), (0, 2)] + [(1, 0), (2, 1), (1, 2), (0, 1)] * is_quadratic
    elements = [[number[2 * i + a, 2 * j + b] for a, b in around] for j in range(ny) for i in range(nx)]
    nodes = np.array([(xs[i], ys[j], middle) for i, j in used])
    sides = {side: [(e, face) for e in range(len(elements))] for side, face in (("Z0", "SNEG"), ("Z1", "SPOS"))}
    everything = list(range(len(nodes)))
    return Body(name, kind, nodes, elements, sides, {"Z0": everything, "Z1": everything}, thickness)


def draw_assembly(seed: int) -> Assembly:
    """The assembly of a seed."""
    draw = Random(f"assembly {seed}")
    dialect = draw.choice(["abaqus", "abaqus", "calculix"])
    a = solid("A", draw.choice(SOLIDS), (draw.choice([2, 3, 4]), draw.choice([1, 2, 3]), draw.choice([1, 2])), (0.0, 0.0, 0.0), (10.0, 8.0, 4.0))
    has_shell = draw.random() < 0.4
    if has_shell:
        t = draw.choice([0.4, 0.8])
        b = shell("B", draw.choice(SHELLS), (draw.choice([2, 3, 5]), draw.choice([2, 3])), (1.3, 1.0), (8.7, 7.0), 4.0 + t / 2, t)
        high = 4.0 + t
    else:
        high = 4.0 + draw.choice([1.0, 2.0])
        b = solid("B", draw.choice(SOLIDS), (draw.choice([1, 2, 3]), draw.choice([1, 2]), draw.choice([1, 2])), (1.3, 1.0, 4.0), (8.7, 7.0, high))
    c = solid("C", draw.choice(SOLIDS), (draw.choice([1, 2, 3]), draw.choice([1, 2]), 1), (2.1, 1.7, high), (7.3, 6.1, high + 2.0))
    d = solid("D", draw.choice(sorted(LINEAR)), (1, 2, 1), (10.0, 2.0, 1.0), (12.0, 6.0, 3.0))
    pairs = [("B_Z0", "A_Z1"), ("C_Z0", "B_Z1")]
    if draw.random() < 0.3:
        pairs[0] = pairs[0][::-1]
    if draw.random() < 0.4:
        pairs[1] = pairs[1][::-1]
    form = draw.choice(["NODE TO SURFACE", "SURFACE TO SURFACE"])
    moduli = [(draw.choice([1e3, 1e4, 2e5]), draw.choice([0.0, 0.3])) for _ in range(4)]
    is_nlgeom = draw.random() < 0.5
    if has_shell:
        corners = [0, len(b.nodes) - 1] if b.kind != "S8R" else [0, int(np.argmax(b.nodes.sum(axis=1)))]
    else:
        corners = [int(np.argmin(b.nodes @ [1.0, 1.0, -1e-3])), int(np.argmax(b.nodes @ [1.0, 1.0, 1e-3]))]
    return Assembly(seed, dialect, [a, b, c, d], moduli, pairs, form, draw.choice([0.0, 0.1, 0.3]), is_nlgeom and draw.random() < 0.3, is_nlgeom,
                    draw.choice([2, 4]), draw.random() < 0.5, draw.random() < 0.5, draw.choice([0.002, 0.01, 0.04]), draw.choice([0.0, 0.01, 0.05]), high + 2.0,
                    {"B": corners})  # fmt: skip


def listed(labels: Iterable[int]) -> str:
    """Labels, one a line."""
    return "".join(f"{label}\n" for label in labels)


def element_row(labels: list[int]) -> str:
    """The data lines of an element."""
    text = [str(label) for label in labels]
    return ", ".join(text[:11]) + (",\n" + ", ".join(text[11:]) if len(text) > 11 else "") + "\n"


@dataclass
class Form:
    """How an assembly is written down."""

    scale: float = 1.0  #: of lengths; moduli follow so that forces stay
    turn: Floats = field(default_factory=lambda: np.eye(3))  #: rotation of the model
    is_renumbered: bool = False
    far: tuple[str, str] | None = None  #: a third pair, with a fixed block far away
    has_far_block: bool = False
    is_general: bool = False
    n_steps: int = 1


def labels_of(body: Body, k: int, form: Form) -> tuple[list[int], list[int], list[int]]:
    """Labels of the nodes and of the elements, and the order of the elements in the deck."""
    nodes = [1000 * (k + 1) + 1 + i for i in range(len(body.nodes))]
    elements = [1000 * (k + 1) + 1 + e for e in range(len(body.elements))]
    order = list(range(len(elements)))
    if form.is_renumbered:
        draw = Random(f"labels {k}")
        draw.shuffle(nodes)
        draw.shuffle(elements)
        draw.shuffle(order)
    return nodes, elements, order


def deck_of(it: Assembly, form: Form) -> str:
    """The deck of an assembly."""
    text = f"** seed {it.seed}: {it.description}\n** dialect: {it.dialect}\n"
    bodies = list(it.bodies)
    moduli = list(it.moduli)
    if form.has_far_block:
        bodies.append(solid("F", "C3D8", (1, 1, 1), (13.5, -1.0, -1.0), (15.0, 9.0, 9.0)))
        moduli.append((1e4, 0.3))
    s = form.scale
    surfaces, every_node, shown, rigid = "", [], [], ""
    for k, (body, (young, poisson)) in enumerate(zip(bodies, moduli, strict=True)):
        nodes, elements, order = labels_of(body, k, form)
        places = s * body.nodes @ form.turn.T
        rows = list(zip(nodes, places, strict=True))
        if form.is_renumbered:
            rows.sort(key=lambda row: row[0])
        text += "*NODE\n" + "".join(f"{n}, " + ", ".join(f"{v:.15g}" for v in x) + "\n" for n, x in rows)
        text += f"*ELEMENT, TYPE={body.kind}, ELSET={body.name}\n" + "".join(element_row([elements[e], *(nodes[n] for n in body.elements[e])]) for e in order)
        text += f"*MATERIAL, NAME=M{body.name}\n*ELASTIC\n{young / s**2:.12g}, {poisson}\n"
        section = f"*SHELL SECTION, ELSET={body.name}, MATERIAL=M{body.name}\n{body.thickness * s:.12g}\n"
        text += section if body.thickness else f"*SOLID SECTION, ELSET={body.name}, MATERIAL=M{body.name}\n"
        for side, faces in body.sides.items():
            surfaces += f"*SURFACE, NAME={body.name}_{side}\n" + "".join(f"{elements[e]}, {face}\n" for e, face in faces)
        for side, members in body.ends.items():
            rigid += f"*NSET, NSET={body.name}N_{side}\n{listed(nodes[n] for n in members)}"
        if body.name in it.held:
            rigid += f"*NSET, NSET={body.name}N_HELD\n{listed(nodes[n] for n in it.held[body.name])}"
        every_node += nodes
        if body.name != "F":
            shown += nodes
    ends = [(REF, (4.7, 3.9, it.top))] + [(TIP, (4.7, 3.9, it.top + 4.0))] * it.has_beam
    text += "*NODE\n" + "".join(f"{n}, " + ", ".join(f"{v:.15g}" for v in s * form.turn @ np.array(x)) + "\n" for n, x in ends)
    head = TIP if it.has_beam else REF
    if it.has_beam:
        axis = form.turn @ np.array([1.0, 0.0, 0.0])
        text += f"*ELEMENT, TYPE=B31, ELSET=BEAM\n9001, {REF}, {TIP}\n*MATERIAL, NAME=MBEAM\n*ELASTIC\n{2e5 / s**2:.12g}, 0.3\n"
        text += f"*BEAM SECTION, ELSET=BEAM, MATERIAL=MBEAM, SECTION=RECT\n{0.8 * s:.12g}, {0.6 * s:.12g}\n" + ", ".join(f"{v:.12g}" for v in axis) + "\n"
    text += surfaces + rigid + f"*NSET, NSET=SHOWN\n{listed(shown)}*NSET, NSET=ALL\n{listed([*every_node, *(n for n, _ in ends)])}"
    if not np.allclose(form.turn, np.eye(3)):
        text += "*TRANSFORM, NSET=ALL\n" + ", ".join(f"{v:.15g}" for v in [*form.turn[:, 0], *form.turn[:, 1]]) + "\n"
    text += f"*COUPLING, CONSTRAINT NAME=HEAD, REF NODE={REF}, SURFACE=C_Z1\n*KINEMATIC\n1, 3\n"
    text += "*TIE, NAME=TIED, POSITION TOLERANCE=" + f"{0.1 * s:.6g}\nD_X0, A_X1\n"
    text += contact_of(it, form)
    step = 1.0 / it.n_increments
    for part in range(1, form.n_steps + 1):
        share = part / form.n_steps
        text += f"*STEP, INC=500{', NLGEOM' if it.is_nlgeom else ''}\n*STATIC\n{step * form.n_steps:.12g}, 1., 1e-4, {step * form.n_steps:.12g}\n"
        text += "*CONTROLS, PARAMETERS=FIELD\n1e-8, 1e-6\n"
        if part == 1:
            text += "*BOUNDARY\nAN_Z0, 1, 3\nBN_HELD, 1, 2\n" + ("FN_X1, 1, 3\n" if form.has_far_block else "") + f"{head}, 2, 2\n{head}, 4, 6\n"
        text += f"*BOUNDARY\n{head}, 1, 1, {it.along * s * share:.15g}\n"
        if it.is_force:
            text += f"*CLOAD\n{head}, 3, {-it.down * min(e for e, _ in it.moduli[:3]) * 10 * share:.15g}\n"
        else:
            text += f"*BOUNDARY\n{head}, 3, 3, {-it.down * s * share:.15g}\n"
        text += "*END STEP\n"
    return text


def contact_of(it: Assembly, form: Form) -> str:
    """Interaction and pairs, or general contact with the same roles."""
    text = "*SURFACE INTERACTION, NAME=I\n"
    if it.dialect == "calculix":
        text += f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{1e6 / form.scale**3:.12g}\n"
    if it.mu:
        slope = f", {1e5 / form.scale**3:.12g}" if it.dialect == "calculix" else ""
        text += f"*FRICTION\n{it.mu}{slope}\n"
    if form.is_general:
        text += f"*CONTACT, TYPE={it.form}\n*CONTACT INCLUSIONS\n" + "".join(f"{slave}, {master}\n" for slave, master in it.pairs)
        return text + "*CONTACT PROPERTY ASSIGNMENT\n, , I\n*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES\n" + "".join(f"{a}, {b}, SLAVE\n" for a, b in it.pairs)
    options = f", TYPE={it.form}{', SMALL SLIDING' if it.is_small_sliding else ''}"
    return text + "".join(f"*CONTACT PAIR, INTERACTION=I{options}\n{slave}, {master}\n" for slave, master in [*it.pairs, *([form.far] if form.far else [])])


def form_of(it: Assembly, change: str) -> Form | None:
    """How a change writes an assembly; None: it has no such form."""
    side = Random(f"far {it.seed}").choice([body.name for body in it.bodies[:3] if not body.thickness]) + "_X1"
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]) @ np.array([[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]])
    if change == "general" and (it.dialect == "calculix" or it.is_small_sliding):
        return None
    if change == "two-steps" and (it.is_small_sliding or it.is_nlgeom is False or it.dialect == "calculix"):
        return None  # the geometry of contact is that of the start of the step; the other dialect ramps and redefines by steps
    return {
        "plain": Form(), "far-block": Form(has_far_block=True), "far-pair": Form(far=(side, "F_X0"), has_far_block=True),
        "far-pair-slave": Form(far=("F_X0", side), has_far_block=True), "renumbered": Form(is_renumbered=True), "rotated": Form(turn=turn),
        "metres": Form(scale=1e-3), "two-steps": Form(n_steps=2), "general": Form(is_general=True), "resumed": Form(), "balance": Form(),
    }[change]  # fmt: skip


@dataclass
class Result:
    """Displacements and reactions of the bodies at the end, in the axes and units of the plain form; the order is that of the bodies."""

    code: int
    said: str
    u: Floats
    rf: Floats


def solve(program: Path, it: Assembly, form: Form, folder: Path, kills: Random | None = None) -> Result:
    """Runs a deck in a folder of its own; with kills it is killed at random moments and resumed."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "job.inp").write_text(deck_of(it, form))
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    words = [str(program), "--quiet", *([] if kills else ["--no-checkpoint"]), "job"]
    for _ in range(3 if kills else 0):
        job = subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        began = time.monotonic()
        while job.poll() is None and not (folder / "job.restart").exists() and time.monotonic() - began < LIMIT:
            time.sleep(0.002)
        time.sleep(kills.uniform(0.0, 0.2))
        if job.poll() is None:
            job.send_signal(signal.SIGKILL)
        job.wait()
        if not (folder / "job.restart").exists():
            break
        words = [str(program), "--quiet", "--resume", "job"]
    if not kills or (folder / "job.restart").exists() or not (folder / "job.vtkhdf").exists():
        try:
            done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False)
        except subprocess.TimeoutExpired:
            return Result(124, "timeout", np.zeros((0, 3)), np.zeros((0, 3)))
        if done.returncode:
            said = [line for line in (done.stdout + done.stderr).splitlines() if "ERROR" in line]
            return Result(done.returncode, said[0] if said else "", np.zeros((0, 3)), np.zeros((0, 3)))
    with h5py.File(folder / "job.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        labels = np.asarray(file["AMONTONS/mesh/node_label"])[-n:]
        u, rf = (np.asarray(file[f"VTKHDF/PointData/{name}"])[-n:] for name in ("U", "RF"))
    at = {int(label): i for i, label in enumerate(labels)}
    order = [at[label] for k, body in enumerate(it.bodies) for label in labels_of(body, k, form)[0]]
    order_rf = order + [at[label] for label in (REF, TIP)[: 1 + it.has_beam]]  # other nodes are those of rotations: moments
    return Result(0, "", u[order] @ form.turn / form.scale, rf[order_rf] @ form.turn)


def compare(it: Assembly, change: str, plain: Result, program: Path, folder: Path) -> str:
    """'': the change changes nothing; else what differs."""
    form = form_of(it, change)
    if form is None:
        return ""
    if change.startswith("far-pair"):
        plain = solve(program, it, form_of(it, "far-block"), folder / f"{change}-without")  # type: ignore[arg-type]
    if change == "balance":
        applied = np.array([0.0, 0.0, -it.down * min(e for e, _ in it.moduli[:3]) * 10 if it.is_force else 0.0])
        left = np.abs(plain.rf.sum(axis=0) + (applied if it.dialect == "abaqus" else 0.0)).max() / max(np.abs(plain.rf).max(), 1e-30)
        return f"{left:.1e} of the largest reaction is not in balance" if it.dialect == "abaqus" and left > CHANGES[change] else ""
    result = solve(program, it, form, folder / change, Random(it.seed) if change == "resumed" else None)
    if change.startswith("far-pair") and "projects on the master at the start" in result.said:
        return ""  # a pair so far away is refused
    if plain.code or result.code:
        return "" if plain.code == result.code else f"exit {result.code} in place of {plain.code}: {(result if result.code else plain).said}"
    error = np.abs(result.u - plain.u).max() / np.abs(plain.u).max()
    return f"displacements differ by {error:.1e} of the largest" if error > CHANGES[change] else ""


def run(seed: int, program: Path, folder: Path, changes: list[str]) -> tuple[str, int, list[str]]:
    """The description of a seed, the exit code of its plain form, and what differs."""
    it = draw_assembly(seed)
    here = folder / f"{seed}"
    plain = solve(program, it, Form(), here / "plain")
    found = [f"exit {plain.code}: {plain.said}"] if plain.code else []
    if not plain.code:
        found += [f"{change}: {said}" for change in changes if (said := compare(it, change, plain, program, here))]
    return it.description, plain.code, found


def main() -> int:
    """Compares a range of seeds, or prints one deck."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs=2, default=(1, 100), metavar=("FIRST", "LAST"))
    parser.add_argument("--deck", nargs="+", metavar=("SEED", "CHANGE"))
    parser.add_argument("--changes", nargs="+", choices=sorted(CHANGES), default=list(CHANGES))
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    parser.add_argument("--jobs", type=int, default=1, help="at a time")
    parser.add_argument("--folder", type=Path, help="a new folder that keeps decks and results")
    arguments = parser.parse_args()
    if arguments.deck:
        it = draw_assembly(int(arguments.deck[0]))
        form = form_of(it, arguments.deck[1] if len(arguments.deck) > 1 else "plain")
        print("this seed has no such form" if form is None else deck_of(it, replace(form)), end="")
        return 0
    seeds = range(arguments.seeds[0], arguments.seeds[1] + 1)
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(arguments.jobs) as pool:
        folder = arguments.folder or Path(scratch)
        n_ended, n_different = 0, 0
        for seed, description, code, found in pool.map(lambda seed: (seed, *run(seed, arguments.program.resolve(), folder, arguments.changes)), seeds):
            n_ended += code == 0
            n_different += code == 0 and bool(found)
            for line in found:
                print(f"seed {seed} ({description}): {line}", flush=True)
    print(f"{len(seeds)} assemblies, {n_ended} finish, {n_different} of them differ under a change")
    return 0


if __name__ == "__main__":
    sys.exit(main())
