"""A reader finds for every measured figure of README and doc how it is made: each section with one names the command, the test or
the page that has it. Figures that are reckoned, not measured, are marked so by a comment.

The pages of the verification are written by their cases and name them; those that `make doc` writes hold no measured figure.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from verify.conftest import ROOT

PAGES = [ROOT / "README.md", *sorted(path for path in (ROOT / "doc").rglob("*.md") if path.parent.name != "verification" and path.name not in ("cards.md", "modules.md"))]
FIGURE = re.compile(
    r"(?<![\w.*/-])(?:\d[\d .,]*\d|\d)\s?(?:%|per cent\b|(?:s|ms|MB|GB|kB|seconds?|minutes?|iterations?|attempts?|factorisations?)\b)"
)
COMMAND = re.compile(
    r"`(?:make |python3? |pytest |bin/amontons |amontons |AMONTONS_|perf |fuzz\.py )[^`]*`|`(?:verify|input)/[^`]+`|`test_\w+(?:\.py)?`"
    r"|^    (?:make|bin/amontons|\.venv|python|amontons) |\]\([^)]*(?:verification/|study/|performance\.md)[^)]*\)"
    r"|<!-- figures: reckoned, not measured -->",
    re.M,
)


CELL = re.compile(r"\(?-?\d+\.\d+(?:e[-+]?\d+)?\)?(?: ?%)?(?: \(\d+\))?")  #: of a table: a measured number, perhaps in brackets


def has_table_of_figures(section: str) -> bool:
    """Whether a table of the section has cells that hold a decimal number and nothing else."""
    cells = [cell.strip() for line in section.splitlines() if line.startswith("|") for cell in line.strip("|").split("|")]
    return sum(CELL.fullmatch(cell) is not None for cell in cells) >= 2


def sections_with_figures(text: str) -> list[str]:
    """The headings of the sections with a figure and without a command."""
    prose = re.sub(r"```.*?```", "", text, flags=re.S)
    sections = re.split(r"^(?=#+ )", prose, flags=re.M)
    return [section.splitlines()[0] for section in sections if (FIGURE.search(section) or has_table_of_figures(section)) and not COMMAND.search(section)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_figures_name_their_command(page: Path) -> None:
    """Section by section."""
    assert sections_with_figures(page.read_text()) == []


def test_the_rule_finds_what_it_should() -> None:
    """A figure without a command is found, one with a command, a constant or code is not."""
    assert sections_with_figures("# A\nIt takes 3.5 s.\n# B\nIt takes 3 s (`make bench`).\n# C\nmu = 0.3\n# D\n```\n12 %\n```\n") == ["# A"]
    assert sections_with_figures("# A\nSome 12 iterations\n") == ["# A"]
    assert sections_with_figures("# A\n| a | b |\n|---|---|\n| (1.5) | 2.25 % |\n# B\n| E | 1000 |\n") == ["# A"]


def test_scripts_that_are_named_are_there() -> None:
    """The files that the commands name."""
    for page in PAGES:
        text = page.read_text()
        modules = (f"{name.replace('.', '/')}.py" for name in re.findall(r"-m (verify[\w.]*\w)", text))
        for name in [*re.findall(r"\b(verify/[a-z0-9_/]+\.\w+)", text), *modules]:
            assert (ROOT / name).exists(), f"{page.name} names {name}"


def test_study_figure_comes_from_its_table(tmp_path: Path) -> None:
    """The bars of doc/study/line_search.png are the cells of the table above it."""
    from verify.study.line_search_table import MODES, draw, rows_of

    cases, bars = rows_of((ROOT / "doc" / "study" / "line_search.md").read_text())
    assert len(cases) == 6
    assert [len(bars[mode]) for mode in MODES] == [6] * len(MODES)
    assert rows_of("| flat | 0.3 | 0.4 | 1.5 (0) | stopped at 1.20 | 3.0 (1) | 4.0 (0) | 5.0 (0) |\n")[1]["GLOBAL"] == [3.0]
    draw(cases, bars, tmp_path / "line_search.png")
    drawn, kept = (np.asarray(Image.open(file).convert("L").resize((350, 200)), dtype=float) for file in
                   (tmp_path / "line_search.png", ROOT / "doc" / "study" / "line_search.png"))  # fmt: skip
    assert np.abs(drawn - kept).mean() < 3, "draw it again: python -m verify.study.line_search_table --draw doc/study/line_search.md"


def test_study_tables_come_from_its_runs(tmp_path: Path) -> None:
    """Each table over all contact cases in doc/study/line_search.md, and its figure, are those of doc/study/runs.csv."""
    from verify.study.contact_table import DIRECTIONS, FRICTIONS, MODES, PROBLEMS, SIZES, Run, draw, show
    from verify.study.runs import read_runs

    runs = read_runs(ROOT / "doc" / "study" / "runs.csv", Run)
    assert len(runs) == len(DIRECTIONS) * len(PROBLEMS) * len(FRICTIONS) * len(SIZES) * len(MODES)
    page = (ROOT / "doc" / "study" / "line_search.md").read_text()
    for table in show(runs).split("\n\n"):
        assert table in page, "write it again: python -m verify.study.contact_table --show doc/study/runs.csv"
    draw(runs, tmp_path / "contact_table.png")
    drawn, kept = (np.asarray(Image.open(file).convert("L").resize((350, 150)), dtype=float) for file in
                   (tmp_path / "contact_table.png", ROOT / "doc" / "study" / "contact_table.png"))  # fmt: skip
    assert np.abs(drawn - kept).mean() < 3, "draw it again: the same with --figure doc/study/contact_table.png"


def test_gradient_tables_come_from_their_runs(tmp_path: Path) -> None:
    """Each table of conjugate gradients in doc/study/line_search.md, and its figure, are those of doc/study/gradients.csv."""
    from verify.study.gradients_table import Run, draw, find_ratio, show
    from verify.study.runs import read_runs

    runs = read_runs(ROOT / "doc" / "study" / "gradients.csv", Run)
    page = (ROOT / "doc" / "study" / "line_search.md").read_text()
    for table in show(runs).split("\n\n")[:-1]:
        assert table in page, "write it again: python -m verify.study.gradients_table --show doc/study/gradients.csv"
    draw(runs, tmp_path / "gradients.png")
    drawn, kept = (np.asarray(Image.open(file).convert("L").resize((350, 150)), dtype=float) for file in
                   (tmp_path / "gradients.png", ROOT / "doc" / "study" / "gradients.png"))  # fmt: skip
    assert np.abs(drawn - kept).mean() < 3, "draw it again: the same with --figure doc/study/gradients.png"
    assert find_ratio([(0.0, 0), (0.5, 30)], [(0.0, 0), (1.0, 20)]) == 3.0
    assert find_ratio([(0.0, 0)], [(0.0, 0), (1.0, 20)]) == -1.0
