"""The floors of src/depends.mk hold, and lint.py and layout.py find what they are there to find."""

import subprocess
import sys
from pathlib import Path

import pytest

from verify.tools import lint

HEAD = "!> Sample: a room for this test.\n!! SPDX-License-Identifier: GPL-3.0-or-later\n"


def write_room(path: Path, declarations: str = "", body: str = "") -> Path:
    """A file sample.f90 with a module of that name."""
    file = path / "sample.f90"
    file.write_text(
        f"{HEAD}module amontons_sample\n  implicit none\n  private\n{declarations}\ncontains\n\n{body}\nend module amontons_sample\n"
    )
    return file


def wrap(body: str, arguments: str = "") -> str:
    """A procedure with a docstring around some lines."""
    return f"  !> Does nothing.\n  subroutine do_nothing({arguments})\n{body}\n  end subroutine do_nothing\n"


NESTED = "\n".join(["    if (.true.) then"] * 5 + ["    end if"] * 5)


def test_floors_hold() -> None:
    """Nothing upward, nothing stale, nothing missing. `python3 -m verify.tools.lint --write` mends the last two."""
    rooms = {path.stem: lint.read_room(path) for path in sorted(lint.SOURCE.glob("*.f90"))}
    assert len(rooms) > 20
    assert lint.check_floors(rooms, lint.read_floors()) == []


ROOT = lint.ROOT


@pytest.mark.slow
def test_the_house_is_clean() -> None:
    """`make lint` finds nothing: the limits of the rooms, and fortitude's rules."""
    sources = sorted(ROOT.glob("src/*.f90")) + sorted(ROOT.glob("verify/unit/**/*.f90"))
    for command in ([sys.executable, lint.__file__], [Path(sys.executable).with_name("fortitude"), "check", "--output-format", "concise", *sources]):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def test_clean_room_has_no_trouble(tmp_path: Path) -> None:
    """A room as it should be, with the forms that could be taken for something else."""
    declarations = """\
  integer, parameter :: N = 1
  type :: thing_type
    integer :: n = 0
    procedure(apply), pointer, nopass :: stop_here => null()
  contains
    procedure :: do_nothing
  end type thing_type"""
    body = wrap(
        """\
    type(thing_type) :: thing
    character(4) :: text
    text = 'stop'   ! stop is only a word here
    write (text, '(a)') 'print'
    thing%n = &
      1""",
        ", ".join("abcdefghi"),
    )
    assert lint.read_room(write_room(tmp_path, declarations, body)).troubles == []


@pytest.mark.parametrize(
    ("declarations", "body", "trouble"),
    [
        ("  integer :: n", "", "module variable: n"),
        ("", wrap("    integer, save :: n"), "save"),
        ("  use iso_fortran_env", "", "use without only"),
        ("", "  subroutine no_docstring()\n  end subroutine no_docstring", "no_docstring has no docstring"),
        ("", wrap("    stop 1"), "only main.f90 stops"),
        ("", wrap("    if (.true.) error stop 'why'"), "only main.f90 stops"),
        ("", wrap("    print *, 1"), "only the journal"),
        ("", wrap("    write (*, *) 1"), "only the journal"),
        ("", wrap("    write (output_unit, *) 1"), "only the journal"),
        ("", wrap("", ", ".join("abcdefghij")), "10 arguments"),
        ("", wrap("\n".join(["    continue"] * 119)), "121 lines"),
        ("", wrap(NESTED), "nests 5 deep"),
        ("", "\n" * 900, "lines, allowed are 900"),
    ],
)
def test_trouble_is_found(tmp_path: Path, declarations: str, body: str, trouble: str) -> None:
    """Each limit of the house, broken once, is one trouble."""
    troubles = lint.read_room(write_room(tmp_path, declarations, body)).troubles
    assert len(troubles) == 1, troubles
    assert trouble in troubles[0]


def test_wrong_name_and_head_are_found(tmp_path: Path) -> None:
    """File = module; the first two lines."""
    file = tmp_path / "other.f90"
    file.write_text("module amontons_sample\nend module amontons_sample\n")
    troubles = " ".join(lint.read_room(file).troubles)
    for trouble in ("wants amontons_other", "One sentence", "licence"):
        assert trouble in troubles


def test_wrong_floors_are_found() -> None:
    """Upward, stale, missing, unknown."""
    rooms = {name: lint.Room(name, [], uses) for name, uses in {"a": ["b"], "b": ["a"], "c": [], "d": []}.items()}
    troubles = lint.check_floors(rooms, {"a": ["b"], "b": [], "c": ["a"], "e": []})
    assert troubles == [
        "src/depends.mk: e is not in src",
        "src/depends.mk: a uses b, which does not stand below it",
        "src/depends.mk: b uses a, and that is missing",
        "src/depends.mk: c does not use a: stale",
        "src/depends.mk: d is missing",
    ]


def lay_out(*words: str | Path) -> int:
    """Runs layout.py by itself (fprettify takes the standard input away, which pytest needs); returns its exit code."""
    command = [sys.executable, str(Path(lint.__file__).with_name("layout.py")), *map(str, words)]
    return subprocess.run(command, capture_output=True, timeout=60).returncode


def test_rooms_of_the_documents(tmp_path: Path) -> None:
    """A heading of the theory and the table of floors name rooms that are there."""
    theory, developer = tmp_path / "doc" / "theory", tmp_path / "doc" / "developer"
    theory.mkdir(parents=True)
    developer.mkdir()
    (theory / "contact.md").write_text("## Slip [slip: classify_slip, gap]\n\ntext [stepper]\n### Lost [crossing]\n")
    (developer / "architecture.md").write_text("| floor | rooms |\n|---|---|\n| 4 kernels | `slip` `kernel` | pure `procedures` |\n")
    assert lint.check_documents({"slip", "gap"}, tmp_path) == [
        "doc/theory/contact.md:4: there is no room crossing", "doc/developer/architecture.md:3: there is no room kernel"]


def test_search_paths_stay_as_they_are(tmp_path: Path) -> None:
    """A file or page that changes the search path of Python is found; one that only names a path is not."""
    (tmp_path / "verify" / "study").mkdir(parents=True)
    (tmp_path / "doc").mkdir()
    (tmp_path / "verify" / "study" / "table.py").write_text("import sys\n\nsys" + ".path.insert(0, 'decks')\n")
    (tmp_path / "doc" / "page.md").write_text("os.path, syspath\n")
    assert lint.check_search_paths(tmp_path) == [
        "verify/study/table.py:3: the search path of Python is changed; import from the package verify"]


def test_layout(tmp_path: Path) -> None:
    """Blanks around operators, two blank lines between procedures, continuation lines left alone; and then no change."""
    first, second = wrap("    x=2*[1,2]\n    call say('a//b'//text, &\n      y)   ! c//d"), wrap("    y = 1")
    file = write_room(tmp_path, "", f"{first}\n{second}")
    assert lay_out("--check", file) == 1
    assert lay_out(file) == 0
    text = file.read_text()
    assert "    x = 2 * [1, 2]\n" in text
    assert "    call say('a//b' // text, &\n      y)   ! c//d\n" in text
    assert "end subroutine do_nothing\n\n\n  !> Does" in text
    assert lay_out("--check", file) == 0
