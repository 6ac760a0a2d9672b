"""The same results on the dense interface and by the contact skin: two plates, pressed and dragged, under all laws and formulations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from verify.benchmark.wide_contact import Model, deck_of
from verify.cases.proof import Job
from verify.conftest import Run

MODELS = {
    "hard": Model(8, increments=4, dome=0.0),
    "hard, surface to surface": Model(8, kind="surface", increments=4, dome=0.0),
    "hard, NLGEOM": Model(8, is_nlgeom=True, increments=4, dome=0.0),
    "hard, thick": Model(6, thickness=0.5, mu=0.8, increments=4, dome=0.0),
    "hard, domed without friction": Model(8, mu=0.0, increments=4),
    "surface to surface, domed without friction": Model(8, kind="surface", mu=0.0, increments=4),
    "hard, domed": Model(8, increments=5),
    "hard, domed, surface to surface": Model(8, kind="surface", increments=5),
    "hard, domed, NLGEOM": Model(8, is_nlgeom=True, increments=5),
    "hard, blocks": Model(5, is_block=True, increments=5),
    "linear": Model(8, law="linear", increments=4, criteria=1e-7),
    "linear, domed": Model(10, law="linear", increments=5, criteria=1e-7),
    "linear, integration points": Model(5, law="linear", kind="surface", increments=10, criteria=1e-7),
}


@pytest.mark.parametrize("name", MODELS)
def test_both_interfaces(run: Run, tmp_path: Path, name: str) -> None:
    """The statuses are the same and no attempt fails; fields agree to 1e-6 of the largest, Newton's tolerance. Nodes that close
    within an increment have the same origin of slip on both."""
    jobs = []
    for interface in ("DENSE", "SKIN"):
        (tmp_path / f"{interface}.inp").write_text(deck_of(MODELS[name], interface))
        done = run([interface], cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        jobs.append(Job(tmp_path / f"{interface}.vtkhdf", interface))
        assert not jobs[-1].history["n_cutbacks"].any()
    dense, skin = jobs
    assert skin.history["n_krylov"].sum() > 2 * dense.history["n_krylov"].sum(), "the second job did not use the skin"
    assert (skin.last("CSTATUS") == dense.last("CSTATUS")).all()
    for field, scale in (("U", "U"), ("CNORMF", "CNORMF"), ("CSHEARF", "CNORMF")):
        largest = np.abs(dense.last(scale)).max()
        assert np.abs(skin.last(field) - dense.last(field)).max() <= 1e-6 * largest, field
