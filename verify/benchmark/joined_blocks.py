"""Time by phase of two joined blocks with a rigid body or a coupling at their end: a table in Markdown.

    python -m verify.benchmark.joined_blocks [--edges 44 36] [--program bin/amontons] [--joints tie rigid-face ...]

A cube of C3D8 is clamped at its bottom, and another one stands on it. `tie` ties them; the others add to this tie a rigid body of the
upper face, one of the whole upper cube (as the slave or as the master of the tie), a kinematic or a distributing coupling of the upper
face, all of them loaded at the reference node; `free-faces` adds a surface of all free faces of the upper cube. The default has 425 000
unknowns. One thread; elapsed seconds of the program's table of phases.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

from verify.benchmark.bench import timed, unknowns_of
from verify.benchmark.large_cube import krylov_iterations, phases_of
from verify.decks.make_decks import block, join, material_cards, mesh_cards

REFERENCE = 9999999  #: label of the reference node
COUPLING = f"*COUPLING, REF NODE={REFERENCE}, SURFACE=UPPER_TOP, CONSTRAINT NAME=C\n"
JOINTS = {
    "tie": "",
    "rigid-face": f"*RIGID BODY, NSET=HEAD, REF NODE={REFERENCE}\n",
    "rigid-slave": f"*RIGID BODY, ELSET=UPPER, REF NODE={REFERENCE}\n",
    "rigid-master": f"*RIGID BODY, ELSET=UPPER, REF NODE={REFERENCE}\n",
    "kinematic": f"{COUPLING}*KINEMATIC\n1, 6\n",
    "distributing": f"{COUPLING}*DISTRIBUTING\n1, 6\n",
    "free-faces": "*SURFACE, NAME=FREE\nUPPER,\n",
}  #: and the cards beside the tie
PHASES = ("reading", "model", "planning", "assembly", "contact", "factor", "krylov")


def deck_of(joint: str, edges: tuple[int, int]) -> str:
    """Two cubes, one on the other."""
    blocks = zip(edges, (0, 1), ("LOWER", "UPPER"), strict=True)
    mesh = join(block(*(np.linspace(a, a + 1, n + 1) for a in (0, 0, z)), name) for n, z, name in blocks)
    mesh.select("CLAMP", lambda x: x[:, 2] < 1e-9)
    mesh.select("HEAD", lambda x: x[:, 2] > 2 - 1e-9)
    surfaces = ("LOWER_TOP", "UPPER_BOTTOM") if joint == "rigid-master" else ("UPPER_BOTTOM", "LOWER_TOP")
    loads = "HEAD, 1, 0.01\n" if joint in ("tie", "free-faces") else f"{REFERENCE}, 1, 10.\n"
    return (
        f"{mesh_cards(mesh)}*NODE\n{REFERENCE}, 0.5, 0.5, 2.5\n"
        f"{material_cards('STEEL', (2.1e5, 0.3), 'LOWER')}*SOLID SECTION, ELSET=UPPER, MATERIAL=STEEL\n"
        f"*TIE, NAME=T\n{', '.join(surfaces)}\n{JOINTS[joint]}"
        f"*BOUNDARY\nCLAMP, 1, 3\n*STEP\n*STATIC, SOLVER=ITERATIVE SCALING\n*CLOAD\n{loads}*END STEP\n"
    )


def main() -> int:
    """Runs the jobs and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edges", type=int, nargs=2, default=[44, 36], help="elements on an edge of the lower and the upper cube")
    parser.add_argument("--joints", nargs="+", choices=JOINTS, default=list(JOINTS))
    parser.add_argument("--program", type=Path, default=Path("bin/amontons"))
    options = parser.parse_args()
    print(f"| joint | unknowns | {' | '.join(PHASES)} | all | MB | Krylov iterations |\n{'|---' * (len(PHASES) + 5)}|")
    with tempfile.TemporaryDirectory() as temporary:
        for joint in options.joints:
            deck = deck_of(joint, tuple(options.edges))
            (Path(temporary) / "joined.inp").write_text(deck)
            run = timed([str(options.program.resolve()), "joined", "--progress=none", "--dialect=abaqus"], Path(temporary), 1)
            phases = phases_of(run.text)
            print(f"| {joint} | {unknowns_of(deck)} | {' | '.join(f'{phases[name][0]:.1f}' for name in PHASES)} | {run.elapsed:.1f} | "
                  f"{run.megabytes:.0f} | {krylov_iterations(run.text)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
