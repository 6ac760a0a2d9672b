"""names.py finds retired words, constants with two values, and public names without a user."""

from pathlib import Path

import pytest

from verify.tools import names


@pytest.mark.parametrize(
    ("line", "is_retired"),
    [
        ("  logical :: is_told", True),
        ("enum { TEXT_ROOM = 8192 };", True),
        ("The solver asks the elements.", True),
        ("Contact settles within an iteration.", True),
        ("the job goes on with the next step", True),
        ("a number of threads that is none", True),
        ("integer, parameter :: MOST_ROUNDS = 3", True),
        ("the size of the model as lever arm", False),
        ("a mushroom on the task list", False),
        ("x = minloc(most, 1)", False),
    ],
)
def test_retired_words(tmp_path: Path, line: str, is_retired: bool) -> None:
    """Private words are found in prose and within identifiers, with the standard term; longer words are not."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "sample.f90").write_text(f"! nothing\n{line}\n")
    for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "Makefile"):
        (tmp_path / name).write_text("")
    found = names.check_words(tmp_path)
    assert [trouble.split(": ")[0] for trouble in found] == ["src/sample.f90:2"] * is_retired
    assert all("standard terms: " in trouble for trouble in found)


@pytest.mark.parametrize(
    ("first", "second", "found"),
    [
        ("  real(DP), parameter :: FAR_OFF = 100.0_DP", "  real(DP), parameter :: FAR_OFF = 0.5_DP", "FAR_OFF stands in a.f90 with another value"),
        ("  real(DP), parameter :: REACH = 3.0_DP", "  real(DP), parameter :: &\n    FIRST = 1.0_DP, REACH = 3.0_DP ! again", "REACH stands in a.f90 too"),
        ("  character(*), parameter :: ROOT = 'a'", "  character(*), parameter :: ROOT = 'b, c'", "ROOT stands in a.f90 with another value"),
        ("contains\n  integer, parameter :: FIELDS = 8", "contains\n  integer, parameter :: FIELDS = 6", "FIELDS stands in a.f90 with another value"),
        ("contains\n  integer, parameter :: NODES(2) = [1, 2]", "contains\n  integer, parameter :: NODES(2) = [3, 4]", ""),
        ("  integer, parameter :: N = 1", "  integer, parameter :: N = 2", ""),
    ],
)
def test_constants(first: str, second: str, found: str) -> None:
    """One name, one value, one place; lists within procedures and symbols of one letter are free."""
    troubles = names.check_constants({"a.f90": first.splitlines(), "b.f90": second.splitlines()})
    assert (len(troubles) == 1 and found in troubles[0]) if found else troubles == []


def test_public_names() -> None:
    """A public procedure that src does not use is found; one that another module or its own module uses is not."""
    tested = "public :: alone, used_here, used_there, NEVER\ninteger, parameter :: NEVER = 1\ncontains\n"
    tested += "pure subroutine alone(x)\nend subroutine alone\nreal function used_here()\nend function used_here\n"
    tested += "subroutine used_there()\nx = used_here() ! alone\nend subroutine used_there\n"
    other = "use tested, only: used_there\ncall used_there('alone')\n"
    troubles = names.check_public_names({"tested.f90": tested.splitlines(), "other.f90": other.splitlines()})
    assert [trouble.split(" name ")[1].split(";")[0] for trouble in troubles] == ["alone", "never"]


def test_glossary(tmp_path: Path) -> None:
    """A module or a procedure that the glossary names and src does not have is found."""
    (tmp_path / "doc" / "developer").mkdir(parents=True)
    rows = ["| term | L | `laws`: `find_limit`, `find_force` | |", "| other | | `laws`: `find_limit`; `lost`: `find_gap` | P. W. |"]
    (tmp_path / "doc" / "developer" / "glossary.md").write_text("\n".join(rows))
    source = {"src/contact/laws.f90": ["  pure real(DP) function find_limit(mu) result(limit)", "  call find_force()"]}
    assert [trouble.split(": ", 1)[1] for trouble in names.check_glossary(source, tmp_path)] == [
        "laws has no procedure find_force",
        "there is no module lost",
    ]
