"""Assemblies with plates in contact on both faces, held by their corners: rotated, with *TRANSFORM, they move the same.

The corners hold one face of the plate by the other, so that forces on one face act on the slave nodes of the other; the local axes of a corner are oblique
to the global ones. Of the seeds of verify.study.random_assemblies those are taken in which plates are slaves of one pair (54, by nodes; 57, by faces) or of
both (42; 74, without convergence when rotated before), and whose S8R have inner nodes (13, 66). In 147 nodes start without pressure and without slip: rounding
chose whether they stick.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.study.random_assemblies import Form, compare, draw_assembly, solve


@pytest.mark.parametrize("seed", [13, 42, 54, 57, 66, 74, 147])
def test_rotated(program: Path, tmp_path: Path, seed: int) -> None:
    """The displacements are equal to 1e-5 of the largest one (EQUAL of the study): some differed by 0.2 of it, or ended as free bodies."""
    assembly = draw_assembly(seed)
    plain = solve(program, assembly, Form(), tmp_path / "plain")
    assert plain.code == 0, plain.said
    assert compare(assembly, "rotated", plain, program, tmp_path) == ""
    if seed == 147:
        plain_rows, rotated_rows = ((tmp_path / name / "job.sta").read_text().splitlines() for name in ("plain", "rotated"))
        assert len(rotated_rows) == len(plain_rows), "an attempt failed, and shorter increments followed"
