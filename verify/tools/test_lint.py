"""The layers of src are respected, and lint.py and layout.py find what they are there to find."""

import subprocess
import sys
from pathlib import Path

import pytest

from verify.tools import lint
from verify.tools import wrap as pages

HEAD = "!> Sample: a module for this test.\n!! SPDX-License-Identifier: GPL-3.0-or-later\n"


def write_module(path: Path, declarations: str = "", body: str = "") -> Path:
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


def test_layers_hold() -> None:
    """Nothing is used upward or in a cycle, and src/depends.mk is what `make depends` generates."""
    listed = lint.read_modules()
    layers = list(lint.read_layers())
    modules = {module.name: module for module in listed}
    order, _ = lint.in_order(modules, layers)
    assert len(order) == len(listed) > 100
    assert lint.check_layers(listed, layers) == []
    assert (lint.SOURCE / "depends.mk").read_text() == lint.depends_text(modules, order)


ROOT = lint.ROOT


@pytest.mark.slow
def test_the_source_is_clean() -> None:
    """`make lint` finds nothing: the limits of style.md, and fortitude's rules."""
    sources = sorted(ROOT.glob("src/**/*.f90")) + sorted(ROOT.glob("verify/unit/**/*.f90"))
    for command in ([sys.executable, "-m", "verify.tools.lint"], [Path(sys.executable).with_name("fortitude"), "check", "--output-format", "concise", *sources]):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def test_clean_module_has_no_trouble(tmp_path: Path) -> None:
    """A module as it should be, with the forms that could be taken for something else."""
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
    assert lint.read_module(write_module(tmp_path, declarations, body)).troubles == []


@pytest.mark.parametrize(
    ("declarations", "body", "trouble"),
    [
        ("  integer :: n", "", "module variable: n"),
        ("", wrap("    integer, save :: n"), "save"),
        ("  use iso_fortran_env", "", "use without only"),
        ("", "  subroutine no_docstring()\n  end subroutine no_docstring", "no_docstring has no docstring"),
        ("", wrap("    stop 1"), "only main.f90 stops"),
        ("", wrap("    if (.true.) error stop 'why'"), "only main.f90 stops"),
        ("", wrap("    print *, 1"), "only the logger"),
        ("", wrap("    write (*, *) 1"), "only the logger"),
        ("", wrap("    write (output_unit, *) 1"), "only the logger"),
        ("", wrap("    type(model_type), intent(inout) :: model"), "frozen"),
        ("", wrap("    type(model_type), allocatable, intent(in out) :: other"), "frozen"),
        ("", wrap("    type(model_type), intent(out) :: model"), "frozen"),
        ("", wrap("    model%mesh%coordinates(:, 1) = 0"), "frozen"),
        ("", wrap("    if (is_new(1)) job%analysis%model%steps(2)%period = 1"), "frozen"),
        ("", wrap("", ", ".join("abcdefghij")), "10 arguments"),
        ("", wrap("\n".join(["    continue"] * 119)), "121 lines"),
        ("", wrap(NESTED), "nests 5 deep"),
        ("", "\n" * 900, "lines, allowed are 900"),
    ],
)
def test_trouble_is_found(tmp_path: Path, declarations: str, body: str, trouble: str) -> None:
    """Each limit of style.md, broken once, is one trouble."""
    troubles = lint.read_module(write_module(tmp_path, declarations, body)).troubles
    assert len(troubles) == 1, troubles
    assert trouble in troubles[0]


def test_a_model_may_be_read_and_set_up(tmp_path: Path) -> None:
    """Reading a model, comparing with it, and copies of it are no trouble; nor is a change before the model is frozen."""
    body = wrap(
        "    type(model_type), intent(in) :: model\n    type(model_type) :: linear\n    linear%pairs = model%pairs\n"
        "    if (model%steps(1)%number == 1) n = size(model%steps)\n    associate (mesh => model%mesh)\n    end associate"
    )
    assert lint.read_module(write_module(tmp_path, "", body)).troubles == []
    change = wrap("    type(model_type), intent(inout) :: model\n    model%is_checked_only = .true.")
    module = lint.Module("model_setup", change.splitlines(), "driver")
    lint.read_statements(module)
    assert module.troubles == []
    module = lint.Module("deck", change.splitlines(), "input")
    lint.read_statements(module)
    assert module.troubles == []


def test_wrong_name_and_head_are_found(tmp_path: Path) -> None:
    """File = module; the first two lines."""
    file = tmp_path / "other.f90"
    file.write_text("module amontons_sample\nend module amontons_sample\n")
    troubles = " ".join(lint.read_module(file).troubles)
    for trouble in ("needs amontons_other", "One sentence", "licence"):
        assert trouble in troubles


def test_wrong_layers_are_found() -> None:
    """Upward, in a cycle, unknown, twice."""
    low, high = "low", "high"
    listed = [
        lint.Module("a", [], low, ["b"]), lint.Module("b", [], high, ["a"]), lint.Module("c", [], high, ["d"], ["x_type"]),
        lint.Module("d", [], high, ["c", "e"], ["x_type"]), lint.Module("b", [], "odd"),
    ]  # fmt: skip
    assert lint.check_layers(listed[:4], [low, high, "none"]) == [
        "src/README.md: there is no folder none in src",
        "src/high/d.f90: the type x_type stands in src/high/c.f90, too",
        "src/low/a.f90: uses b of the higher folder high",
        "src/high/c.f90: a cycle of modules: c -> d -> c",
        "src/high/d.f90: there is no module e in src",
    ]
    assert "src/README.md: the folder odd is missing" in lint.check_layers(listed, [low, high])
    assert "src/odd/b.f90: the module b stands in src/high/b.f90, too" in lint.check_layers(listed, [low, high])


def test_depends_follow_the_layers() -> None:
    """A module comes after those that it uses, and folder by folder."""
    modules = {name: lint.Module(name, [], folder, uses) for name, folder, uses in [("a", "two", ["c"]), ("b", "one", ["d"]), ("c", "one", []), ("d", "one", [])]}
    order, troubles = lint.in_order(modules, ["one", "two"])
    assert (order, troubles) == (["d", "b", "c", "a"], [])
    assert lint.depends_text(modules, order).splitlines()[2:] == ["# one", "uses_d =", "uses_b = d", "uses_c =", "", "# two", "uses_a = c"]


def lay_out(*words: str | Path) -> int:
    """Runs layout.py by itself (fprettify takes the standard input away, which pytest needs); returns its exit code."""
    command = [sys.executable, str(Path(lint.__file__).with_name("layout.py")), *map(str, words)]
    return subprocess.run(command, capture_output=True, timeout=60).returncode


def test_modules_of_the_documents(tmp_path: Path) -> None:
    """A heading of the theory names modules that exist."""
    theory = tmp_path / "doc" / "theory"
    theory.mkdir(parents=True)
    (theory / "contact.md").write_text("## Slip [slip: classify_slip, gap]\n\ntext [stepping]\n### Lost [crossing]\n")
    assert lint.check_documents({"slip", "gap"}, tmp_path) == ["doc/theory/contact.md:4: there is no module crossing"]


def test_a_module_without_a_unit_program_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each module has a program in the folder of its name or a reason to have none; a reason that is not needed is found."""
    (tmp_path / "verify" / "unit" / "base").mkdir(parents=True)
    for name in ("kinds", "spare"):
        (tmp_path / "verify" / "unit" / "base" / f"test_{name}.f90").touch()
    modules = [lint.Module(name, [], "base") for name in ("kinds", "lost", "main", "spare")] + [lint.Module("kinds", [], "mesh")]
    monkeypatch.setattr(lint, "MODULES_WITHOUT_PROGRAM", {"main": "", "spare": "", "gone": ""})
    assert lint.check_unit_programs(modules, tmp_path) == [
        "src/base/lost.f90: has no unit program verify/unit/base/test_lost.f90",
        "src/mesh/kinds.f90: has no unit program verify/unit/mesh/test_kinds.f90",
        "verify/tools/lint.py: spare needs no reason to have no unit program",
        "verify/tools/lint.py: gone needs no reason to have no unit program"]


def test_controls_are_counted() -> None:
    """Those of the nonlinear solver count, not those of a linear one, nor the parts of a step's controls."""
    field = "    real(DP) :: a{} = 1.0_DP   !< one [-]\n"
    fields = "".join(field.format(i) for i in range(lint.MAX_STEERING_CONTROLS))
    few = f"  type :: newton_controls_type\n{fields}  end type newton_controls_type\n  type :: krylov_controls_type\n{fields}  end type krylov_controls_type\n"
    assert lint.check_controls(few) == []
    assert lint.check_controls(f"{few}  type :: cycling_controls_type\n    integer :: n = 3   !< three\n  end type cycling_controls_type\n") == [
        "src/model/controls.f90: 51 constants steer the nonlinear solver, allowed are 50"]


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
    file = write_module(tmp_path, "", f"{first}\n{second}")
    assert lay_out("--check", file) == 1
    assert lay_out(file) == 0
    text = file.read_text()
    assert "    x = 2 * [1, 2]\n" in text
    assert "    call say('a//b' // text, &\n      y)   ! c//d\n" in text
    assert "end subroutine do_nothing\n\n\n  !> Does" in text
    assert lay_out("--check", file) == 0


LONG = "word " * 30 + "end"
PAGE = f"""# A heading that is {LONG}

{LONG}
and what follows it, with `code that is one
- {LONG} $a + b$ - 1
  more of it
1. {LONG}

| {LONG} |

    {LONG}

```
{LONG}
```
"""


def test_prose_is_wrapped_and_nothing_else() -> None:
    """Words stay in their order; headings, tables and code stay as they are; no wrapped line opens a list or a heading."""
    made = pages.wrapped(PAGE)
    assert pages.too_long(PAGE) == [3, 5, 7]
    assert pages.too_long(made) == []
    assert made.split() == PAGE.split()
    assert pages.wrapped(made) == made
    assert [line for line in made.split("\n") if line.startswith(("#", "|", "    ", "```"))] == [
        line for line in PAGE.split("\n") if line.startswith(("#", "|", "    ", "```"))
    ]
    assert sum(pages.ITEM.match(line) is not None for line in made.split("\n")) == 2
    dashes = pages.filled("- ".join(["x" * 20] * 30), "", "")
    assert all(not line.startswith("-") for line in dashes)
    assert pages.filled("a " * 65 + "# b - c", "", "")[-1][0] not in "#-"


def test_long_lines_are_reported(tmp_path: Path) -> None:
    """With page, line and remedy; pages that `make verify` writes are free."""
    (tmp_path / "doc").mkdir()
    (tmp_path / "doc" / "page.md").write_text(PAGE)
    (tmp_path / "doc" / "written.md").write_text(f"{PAGE}\n`make verify` writes this page.\n")
    reported = pages.check_widths(tmp_path)
    assert [line.split(": ")[0] for line in reported] == ["doc/page.md:3", "doc/page.md:5", "doc/page.md:7"]
    assert "python3 -m verify.tools.wrap doc/page.md" in reported[0]
