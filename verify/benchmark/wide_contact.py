"""Two thin plates that touch over their whole width: how contact scales with the number of slave nodes.

    python -m verify.benchmark.wide_contact [--sizes 10 20 40] [--law hard linear] [--type node surface] [--thickness 0.1] [--mu 0.3]
        [--nlgeom] [--displacement] [--blocks] [--threads 1] [--interface DENSE|SKIN] [--limit SECONDS] [--keep FOLDER] [--deck FILE]

A plate of 1 x 1 with N x N x 3 elements lies on one of 1.3 x 1.3 with 1.3 N x 1.3 N x 3; the meshes do not match. The lower face of
the upper plate is domed by 0.002 (x^2 + y^2) about its centre, fading to its top. The lower plate is held at its bottom, one side of
the upper plate in x and y. Step 1 presses the top by 50 in ten increments, step 2 moves the side by 0.002 in x in ten more.

| option | |
|---|---|
| --law | hard: exact contact; linear: 5e7 with a stick slope of a tenth of it (calculix dialect) |
| --type | node to surface, or surface to surface (mortar; with --law linear springs at points of the faces) |
| --displacement | the top is moved by 5e-5 in place of the pressure, so that CalculiX has no free body (with --law linear) |
| --blocks | N x N x N elements on 1.3 N x 1.3 N x N in place of the plates, both of the height 1 |

Processor time is the operating system's account of the process. Rounds are corrections of directions and directions themselves:
solutions of the linearised contact problem. The program measures its phases in elapsed time; here they are scaled to processor time.
Exponents are fitted over all sizes: seconds a round over the unknowns, and seconds a round of each phase over the slave nodes.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np
from verify.decks.make_decks import STEEL, Mesh, block, join, material_cards, mesh_cards

ROOT = Path(__file__).resolve().parents[2]


DOME = 0.002
PRESSURE = 50.0
APPROACH = -5.0e-5
DRAG = 0.002
SLOPE = 5.0e7


@dataclass
class Model:
    """What a deck is made of."""

    size: int
    law: str = "hard"
    kind: str = "node"
    thickness: float = 0.1
    mu: float = 0.3
    is_nlgeom: bool = False
    by_displacement: bool = False
    is_block: bool = False
    increments: int = 10
    dome: float = DOME  #: [1/length]
    criteria: float = 0.0  #: of residual and correction; 0: the dialect's own [-]


@dataclass
class Cost:
    """What a job took."""

    seconds: float
    elapsed: float
    megabytes: float
    increments: int = 0
    failed: int = 0
    iterations: int = 0
    rounds: int = 0
    krylov: int = 0
    factorisations: int = 0
    ended: int = 0
    phases: dict[str, float] = field(default_factory=dict)  #: processor time of each [s]


def plates(model: Model) -> Mesh:
    """Both bodies, with the sets that supports and loads need."""
    n, high = model.size, 1.0 if model.is_block else model.thickness
    layers = n if model.is_block else 3
    wide = np.linspace(-0.65, 0.65, round(1.3 * n) + 1)
    line = np.linspace(-0.5, 0.5, n + 1)
    lower = block(wide, wide, np.linspace(-high, 0.0, layers + 1), "LOWER")
    upper = block(line, line, np.linspace(0.0, high, layers + 1), "UPPER")
    x, y, z = upper.nodes.T
    upper.nodes[:, 2] = z + model.dome * (x**2 + y**2) * (1.0 - z / high)
    upper.select("SIDE", lambda p: np.abs(p[:, 0] + 0.5) < 1e-9)
    mesh = join([lower, upper])
    mesh.element_sets["ALL"] = np.arange(len(mesh.elements))
    return mesh


def interaction(model: Model) -> str:
    """The cards of the contact pair."""
    kind = "SURFACE TO SURFACE" if model.kind == "surface" else "NODE TO SURFACE"
    if model.law == "linear":
        law = f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{SLOPE:g}, 1.\n*FRICTION\n{model.mu}, {SLOPE / 10:g}\n"
    else:
        law = f"*FRICTION\n{model.mu}\n"
    return (
        f"*SURFACE INTERACTION, NAME=RUB\n{law}*CONTACT PAIR, INTERACTION=RUB, TYPE={kind}\nUPPER_BOTTOM, LOWER_TOP\n"
    )


def deck_of(model: Model, interface: str = "") -> str:
    """The whole deck."""
    mesh = plates(model)
    step = "*STEP, NLGEOM, INC=1000" if model.is_nlgeom else "*STEP, INC=1000"
    increment = f"{1.0 / model.increments:g}, 1., , {1.0 / model.increments:g}"
    controls = f"*CONTROLS, PARAMETERS=FIELD\n{model.criteria:g}, {model.criteria:g}, , {model.criteria:g}\n" if model.criteria else ""
    search = f"*LINE SEARCH, TYPE=AUTO, INTERFACE={interface}\n" if interface else ""
    if model.by_displacement:
        press = f"*BOUNDARY\nUPPER_TOP, 3, 3, {APPROACH}\n"
    else:
        press = f"*DLOAD\nUPPER_E2, P2, {PRESSURE}\n"
    return (
        ("** dialect: calculix\n" if model.law == "linear" else "")
        + f"** Two plates that touch over {model.size} x {model.size} faces.\n"
        + mesh_cards(mesh)
        + material_cards("STEEL", STEEL, "ALL")
        + interaction(model)
        + f"{step}\nPress\n*STATIC\n{increment}\n{controls}{search}*BOUNDARY\nLOWER_BOTTOM, 1, 3\nSIDE, 1, 2\n{press}"
        + "*NODE PRINT, NSET=LOWER_BOTTOM, TOTALS=ONLY\nRF\n*NODE FILE\nU, RF\n*END STEP\n"
        + f"{step}\nDrag\n*STATIC\n{increment}\n{controls}{search}*BOUNDARY\nSIDE, 1, 1, {DRAG}\n*END STEP\n"
    )


def timed(command: list[str], folder: Path, threads: int, limit: float) -> Cost:
    """Time and peak memory of one process; ended is its exit code, or -1 where the limit was passed."""
    environment = os.environ | {"OMP_NUM_THREADS": str(threads), "CCX_NPROC_STIFFNESS": "1", "NUMBER_OF_CPUS": "1"}
    start = time.monotonic()
    with (folder / "job.out").open("w") as out:
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=out, stderr=subprocess.STDOUT)
    ended = None
    while ended is None:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            ended = os.waitstatus_to_exitcode(status)
        elif time.monotonic() - start > limit:
            process.kill()
            _, _, usage = os.wait4(process.pid, 0)
            ended = -1
        else:
            time.sleep(0.05)
    return Cost(usage.ru_utime + usage.ru_stime, time.monotonic() - start, usage.ru_maxrss / 1024.0, ended=ended)


def read_counts(path: Path, cost: Cost) -> None:
    """The counts of the result file."""
    if not path.exists():
        return
    with h5py.File(path) as file:
        history, iterations = file["AMONTONS/history"], file["AMONTONS/iterations"]
        cost.increments = int(history["is_converged"][:].sum())
        cost.failed = int((history["increment"][:] > 0).sum()) - cost.increments
        cost.factorisations = int(history["n_factorisations"][:].sum())
        cost.iterations = len(iterations["n_rounds"])
        cost.rounds = int(iterations["n_rounds"][:].sum()) + cost.iterations
        cost.krylov = int(iterations["n_krylov"][:].sum())


def read_phases(path: Path, cost: Cost) -> None:
    """The table of the phases that the program prints at its end, scaled from elapsed to processor time."""
    _, _, table = path.read_text().partition("by phase")
    rows = re.findall(r"^ +([a-z][a-z ]*?) {2,}([0-9.]+) ", table.partition("peak of memory by unknown")[0], re.MULTILINE)
    elapsed = {name: float(seconds) for name, seconds in rows}
    whole = elapsed.pop("the whole job", 0.0)
    if whole > 0.0:
        cost.phases = {name: seconds * cost.seconds / whole for name, seconds in elapsed.items()}


def run(model: Model, options: argparse.Namespace) -> Cost:
    """One job."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(options.keep or temporary) / f"wide-{model.size}-{model.law}-{model.kind}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "job.inp").write_text(deck_of(model, options.interface))
        command = [str(options.program.resolve()), "--progress=plain", "--threads", str(options.threads), "job.inp"]
        cost = timed(command, folder, options.threads, options.limit)
        read_counts(folder / "job.vtkhdf", cost)
        read_phases(folder / "job.out", cost)
        if shutil.which("ccx") and options.ccx:
            theirs = timed(["ccx", "-i", "job"], folder, 1, options.limit)
            print(f"CalculiX: {theirs.seconds:.1f} s, {theirs.megabytes:.0f} MB, exit code {theirs.ended}")
        return cost


HEAD = (
    "| law | type | N | slave nodes | unknowns | increments | failed | iterations an increment | rounds | Krylov a round "
    "| factorisations | s | s a round | MB | ended |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def unknowns_of(model: Model) -> int:
    """Unknowns of both bodies, those at supports counted."""
    layers = model.size if model.is_block else 3
    return 3 * (layers + 1) * ((model.size + 1) ** 2 + (round(1.3 * model.size) + 1) ** 2)


def row_of(model: Model, cost: Cost) -> str:
    """A row of the table."""
    cells = [
        model.law + (", NLGEOM" if model.is_nlgeom else "") + (", blocks" if model.is_block else ""),
        model.kind,
        str(model.size),
        str((model.size + 1) ** 2),
        str(unknowns_of(model)),
        str(cost.increments),
        str(cost.failed),
        f"{cost.iterations / max(cost.increments, 1):.1f}",
        str(cost.rounds),
        f"{cost.krylov / max(cost.rounds, 1):.1f}",
        str(cost.factorisations),
        f"{cost.seconds:.1f}",
        f"{cost.seconds / max(cost.rounds, 1):.3f}",
        f"{cost.megabytes:.0f}",
        "limit" if cost.ended == -1 else str(cost.ended),
    ]
    return "| " + " | ".join(cells) + " |"


def growth(points: list[tuple[float, float]]) -> str:
    """The exponent of a fit of costs over sizes."""
    slope = np.polyfit(np.log([n for n, _ in points]), np.log([t for _, t in points]), 1)[0]
    return f"{slope:.2f}"


def phase_table(ended: list[tuple[int, Cost]]) -> str:
    """Processor time of the phases at each number of slave nodes, and the exponents of their growth."""
    lines = [
        "| phase | " + " | ".join(f"s, {slaves} slave nodes" for slaves, _ in ended) + " | s a round grow as slave nodes to the power |",
        "|---" * (len(ended) + 2) + "|",
    ]
    for phase in ended[0][1].phases:
        seconds = [cost.phases[phase] for _, cost in ended]
        rounds = [(slaves, cost.phases[phase] / cost.rounds) for slaves, cost in ended]
        power = growth(rounds) if min(seconds) > 0.0 else "-"
        lines.append(f"| {phase} | " + " | ".join(f"{t:.2f}" for t in seconds) + f" | {power} |")
    return "\n".join(lines)


def main() -> int:
    """Runs the sizes and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 20])
    parser.add_argument("--law", nargs="+", choices=["hard", "linear"], default=["hard"])
    parser.add_argument("--type", nargs="+", choices=["node", "surface"], default=["node"])
    parser.add_argument("--thickness", type=float, default=0.1)
    parser.add_argument("--mu", type=float, default=0.3)
    parser.add_argument("--increments", type=int, default=10, help="of each step")
    parser.add_argument("--nlgeom", action="store_true")
    parser.add_argument("--displacement", action="store_true")
    parser.add_argument("--blocks", action="store_true")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--interface", default="", choices=["", "DENSE", "SKIN"], help="how the contact subproblem is solved")
    parser.add_argument("--limit", type=float, default=3600.0, help="seconds after which a job is ended")
    parser.add_argument("--ccx", action="store_true", help="run CalculiX too, where it is in the path")
    parser.add_argument("--keep", type=Path, help="folder in which decks and results are kept")
    parser.add_argument("--deck", type=Path, help="write the deck of the first size to this file and stop")
    parser.add_argument("--program", type=Path, default=ROOT / "bin" / "amontons")
    options = parser.parse_args()
    print(HEAD, flush=True)
    for law in options.law:
        for kind in options.type:
            points, ended = [], []
            for size in options.sizes:
                model = Model(
                    size, law, kind, options.thickness, options.mu, options.nlgeom, options.displacement, options.blocks
                )
                model.increments = options.increments
                if options.deck:
                    options.deck.write_text(deck_of(model, options.interface))
                    return 0
                cost = run(model, options)
                line = row_of(model, cost)
                print(line, flush=True)
                if cost.rounds and cost.ended == 0:
                    points.append((unknowns_of(model), cost.seconds / cost.rounds))
                    ended.append(((size + 1) ** 2, cost))
            if len(points) > 1:
                print(f"{law}, {kind}: seconds a round grow as unknowns to the power {growth(points)}.", flush=True)
                print(phase_table(ended), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
