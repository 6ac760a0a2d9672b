"""Thin cantilevers: what is left of rounding, which in one linear solution grows with (h L/t^2)^2; h size of elements, L length, t thickness.

    python -m verify.study.thin_shells [--program bin/amontons]

The displacement by a force at the end, over that of the same mesh at t = 0.05, where it is the same but for shear (1e-5).

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from verify.decks.shells import Floats, held, section, shell


def flat(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """A strip 10 x 1 in the plane."""
    return 10 * u, v, 0 * u


def tip(program: str, kind: str, cells: int, thickness: float) -> float:
    """Displacement of the end over F L^3 / (3 E I); nan if the job is refused or does not finish."""
    body = shell(kind, (cells, 1), flat)
    rigidity = 1.2e6 * thickness**3 / 12
    load = "*STEP\n*STATIC\n*CLOAD\n" + "".join(f"{i + 1}, 3, {rigidity * w:.15g}\n" for i, w in body.edge_weights(0, 1.0).items()) + "*END STEP\n"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "thin.inp"
        path.write_text(body.cards() + section(1.2e6, 0.0, thickness) + held(body.where(0, 0.0), "ENCASTRE") + load)
        if subprocess.run([program, "--outdir", folder, str(path)], capture_output=True, check=False).returncode != 0:
            return float("nan")
        with h5py.File(Path(folder) / "thin.vtkhdf") as file:
            points = int(file["VTKHDF/NumberOfPoints"][0])
            return float(file["VTKHDF/PointData/U"][-points:][body.at(1, 0.5), 2]) / (1000 / 3)


def main(arguments: list[str] | None = None) -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--program", default="bin/amontons")
    options = parser.parse_args(arguments)
    print("| kind | cells | h L/t^2 | error | 1e-14 (h L/t^2)^2 |\n|---|---|---|---|---|")
    for kind, cells in (("S4", 10), ("S4", 20), ("S8R", 10)):
        exact = tip(options.program, kind, cells, 0.05)
        for thickness in np.geomspace(0.02, 0.00125, 5):
            slenderness = np.hypot(10 / cells, 1) * np.hypot(10, 1) / thickness**2
            error = tip(options.program, kind, cells, float(thickness)) / exact - 1
            print(f"| {kind} | {cells} | {slenderness:.1e} | {error:.1e} | {1e-14 * slenderness**2:.1e} |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
