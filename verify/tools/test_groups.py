"""Tests that share a job run on one worker, which runs it once.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os

import pytest


@pytest.fixture(scope="module")
def worker() -> str:
    """What these tests share: where the fixture ran."""
    return os.environ.get("PYTEST_XDIST_WORKER", "")


@pytest.mark.parametrize("number", range(6))
def test_one_worker(worker: str, number: int, request: pytest.FixtureRequest) -> None:
    """The group stands at the end of the name, where pytest-xdist looks for it."""
    if not worker or not request.config.getoption("loadgroup", False):
        pytest.skip("tests are not dealt out by groups (--dist loadgroup)")
    assert request.node.nodeid == f"verify/tools/test_groups.py::test_one_worker[{number}]@test_groups"
