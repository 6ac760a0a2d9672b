"""The runner of the verification cases: its limits of iterations.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from verify.cases.proof import CHAPTERS, MAX_OVER_ALL, Case, Check, page, write_index


def made(name: str, **words: str) -> dict:
    """The facts of a case that ran nothing."""
    return Case(name, **{"title": name, "model": "", "formula": "", "source": "", "proves": ""} | words, runner=None, work=Path(), pages=None).facts()


def test_mean_effort(tmp_path: Path) -> None:
    """The mean is over requested increments, with the iterations of failed attempts, over all cases together."""
    for name, requested, iterations in (("a", 10, 20), ("b", 2, 64)):
        facts = made(name) | {"effort": [(requested, iterations, 1)], "requested": [requested]}
        (tmp_path / f"{name}.json").write_text(json.dumps(facts))
    mean = write_index(tmp_path)
    assert mean == pytest.approx(84 / 12)
    assert mean > MAX_OVER_ALL
    assert not list(tmp_path.glob("*.json"))
    assert "| all | 12 | 84 | 2 | 7.0 |" in (tmp_path / "index.md").read_text()


def test_index_lists_the_worst(tmp_path: Path) -> None:
    """One row for each quantity, under the chapter of its file; a check that fails is marked, whatever its place."""
    first = Check("stress", "A", "the end", "1", 1.01, 0.01, 0.02, "mesh", "2.0")
    second = Check("stress", "B", "the end", "1", 1.05, 0.05, 0.02, "mesh")
    facts = made("x") | {"title": "X", "file": "test_hyperelasticity", "checks": [asdict(first), asdict(second)], "effort": [(1, 1, 0)], "requested": [1]}
    (tmp_path / "x.json").write_text(json.dumps(facts))
    write_index(tmp_path)
    text = (tmp_path / "index.md").read_text()
    assert "## Rubber and foam\n" in text
    assert "| [X](x.md) | stress, B | 1 | 1.05 | 5.0e-02 **fails** | 2e-02 | 2.0 |" in text
    assert "stress, A" not in text


def test_bands_and_truths_are_marked(tmp_path: Path) -> None:
    """No error of 0 where none is allowed: a number is inside its band or outside by so much, and what is so is true."""
    case = Case("x", "X", "", "", "", "", runner=None, work=tmp_path, pages=None, test="verify/test_x.py::test_x")
    words = {"place": "A", "time": "the end", "why": "published"}
    case.within("V", 324.5, (268.0, 332.0), **words)
    case.within("H", 3.0, (0.0, 2.0), **words)
    case.true("it is done", True, **words)
    text = page([case.facts()])
    for row in ("| V | A | the end | 268 to 332 | 324.5 | inside |  |", "| H | A | the end | at most 2 | 3 | outside by 1.0e+00 |  |",
                "| it is done | A | the end | true | true |  |  |"):  # fmt: skip
        assert row in text
    assert "pytest 'verify/test_x.py::test_x'" in text


def test_a_page_for_each_test(tmp_path: Path) -> None:
    """Of three cases of one test the first in its table has the page, with what differs of the others; pages and pictures that the others had
    before go, those of another test stay."""
    for name, values in (("second", [1]), ("third", [2]), ("one", [0])):
        case = made(name, test=f"verify/test_x.py::test_x[{name}]", model="One model" if name != "third" else "Another model", title="X")
        (tmp_path / f"{name}.json").write_text(json.dumps(case | {"values": values, "figures": [["one-1.png", "shape"]] if name == "one" else []}))
    (tmp_path / "other.json").write_text(json.dumps(made("other")))
    for old in ("second.md", "second-1.png", "one-1.png", "one-by-one-1.png", "standing.md"):
        (tmp_path / old).write_text("")
    write_index(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.md", "one-1.png", "one-by-one-1.png", "one.md", "other.md", "standing.md"]
    text = (tmp_path / "one.md").read_text()
    assert text.count("One model") == 1
    assert text.index("One model") < text.index("### X: second") < text.index("### X: third") < text.index("Another model")


def test_every_case_has_a_chapter() -> None:
    """The files that write cases are in CHAPTERS."""
    here = Path(__file__).parent
    writers = {path.stem for path in here.glob("*/test_*.py") if "proof: Proof" in path.read_text()}
    assert writers == {file for files in CHAPTERS.values() for file in files}


@pytest.mark.parametrize("missing", ["place", "time", "why"])
def test_checks_say_all(missing: str, tmp_path: Path) -> None:
    """A check without its place, time or reason cannot be written."""
    case = Case("x", "X", "", "", "", "", runner=None, work=tmp_path, pages=None)
    words = {"place": "A", "time": "the end", "why": "exact"}
    case.near("stress", 1.0, 1.0, 0.1, **words)
    del words[missing]
    with pytest.raises(TypeError, match=missing):
        case.near("stress", 1.0, 1.0, 0.1, **words)
