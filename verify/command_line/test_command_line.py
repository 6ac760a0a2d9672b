"""The command line: options, wrong usage, exit codes, and the words that programs which start us look for."""

import os
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from verify.conftest import Run
from verify.decks.solids import unit_cube

USAGE, DECK, IO = 2, 3, 7

# One cube, pulled. The corner nodes form a hexahedron; the whole runs in a moment.
CUBE = "*HEADING\nOne cube, pulled by one part in a thousand.\n" + unit_cube() + """\
*MATERIAL, NAME=steel
*ELASTIC
210000, 0.3
*SOLID SECTION, ELSET=E, MATERIAL=steel
*BOUNDARY
LOW, 1, 3
*STEP
*STATIC
1, 1
*BOUNDARY
HIGH, 3, 3, 0.001
*END STEP
"""


def test_version(run: Run, root: Path) -> None:
    """--version prints the version that version.f90, CHANGELOG.md and CITATION.cff name."""
    done = run(["--version"])
    assert done.returncode == 0
    version = re.fullmatch(r"Amontons (\d+\.\d+\.\d+)\n", done.stdout)
    assert version, done.stdout
    assert f'version: "{version[1]}"' in (root / "CITATION.cff").read_text()
    assert version[1] in (root / "CHANGELOG.md").read_text()


def test_help_names_every_option_that_the_program_takes(run: Run, root: Path) -> None:
    """Each '--option' in quotation marks in main.f90 stands in the help text, and each exit code of errors.f90 too."""
    done = run(["--help"])
    assert done.returncode == 0
    taken = set(re.findall(r"'(--\w+)'", (root / "src" / "driver" / "main.f90").read_text()))
    assert {"--check", "--threads", "--quiet", "--progress", "--dialect", "--outdir"} <= taken
    assert taken <= set(re.findall(r"--\w+", done.stdout))
    codes = re.findall(r"EXIT_\w+ = (\d)", (root / "src" / "base" / "errors.f90").read_text())
    assert set(codes) <= set(re.findall(r"\b(\d) [a-z]", done.stdout.replace("\n", " ")))


def test_cards_are_listed(run: Run) -> None:
    """--cards names the cards of the table."""
    done = run(["--cards"])
    assert done.returncode == 0
    for card in ("CONTACT PAIR", "FRICTION", "LINE SEARCH"):
        assert card in done.stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "No job is named."),
        (["--nonsense", "job"], "There is no option --nonsense."),
        (["--threads"], "The option --threads needs a value."),
        (["--threads", "0", "job"], "it must be 1 or more"),
        (["--threads=two", "job"], "it must be 1 or more"),
        (["--progress=loud", "job"], "it can be auto, plain or none"),
        (["--dialect", "nastran", "job"], "it can be abaqus or calculix"),
        (["--quiet=yes", "job"], "takes no value"),
        (["one", "two"], "one at a time"),
    ],
)
def test_wrong_usage(run: Run, tmp_path: Path, words: list[str], sentence: str) -> None:
    """Exit code 2, the usage, and at last a sentence that says what is wrong."""
    done = run(words, cwd=tmp_path)
    assert done.returncode == USAGE
    assert "usage: amontons" in done.stdout
    last_line = done.stdout.splitlines()[-1]
    assert last_line.startswith("*ERROR")
    assert sentence in last_line


def test_no_such_deck(run: Run, tmp_path: Path) -> None:
    """A deck that is not there is trouble with a file, not with the usage."""
    done = run(["nothing"], cwd=tmp_path)
    assert done.returncode == IO
    assert done.stdout.splitlines()[-1].startswith("*ERROR: There is no file nothing.inp")


def test_no_such_folder_for_results(run: Run, tmp_path: Path) -> None:
    """--outdir must be there."""
    (tmp_path / "job.inp").write_text(CUBE)
    done = run(["--outdir", "nowhere", "job"], cwd=tmp_path)
    assert done.returncode == IO
    assert "no folder nowhere" in done.stdout.splitlines()[-1]


@pytest.mark.parametrize("words", [["job"], ["job.inp"], ["-i", "job"], ["-i", "job.inp", "--quiet"]])
def test_job_names_on_the_command_line(run: Run, tmp_path: Path, words: list[str]) -> None:
    """With and without extension, as Abaqus and as CalculiX are called; results lie beside the deck."""
    (tmp_path / "job.inp").write_text(CUBE)
    done = run(words, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "*ERROR" not in done.stdout + done.stderr
    assert (tmp_path / "job.vtkhdf").exists()
    assert (tmp_path / "job.sta").exists()


SETTINGS = ("GOMP_SPINCOUNT", "OMP_WAIT_POLICY", "GLIBC_TUNABLES")


@pytest.mark.parametrize(("wait", "wanted"), [
    ({}, {"GOMP_SPINCOUNT=10000", "GLIBC_TUNABLES=glibc.malloc.hugetlb=1"}),
    ({"GOMP_SPINCOUNT": "77"}, {"GOMP_SPINCOUNT=77", "GLIBC_TUNABLES=glibc.malloc.hugetlb=1"}),
    ({"OMP_WAIT_POLICY": "passive", "GLIBC_TUNABLES": "glibc.malloc.top_pad=0"}, {"OMP_WAIT_POLICY=passive", "GLIBC_TUNABLES=glibc.malloc.top_pad=0"}),
])
@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="only where the system shows the environment of a process")
def test_settings_of_libraries(program: Path, root: Path, tmp_path: Path, wait: dict[str, str], wanted: set[str]) -> None:
    """The program runs on with a short wait of its threads and large pages, under its own number, unless the environment says how to."""
    clean = {name: value for name, value in os.environ.items() if name not in SETTINGS}
    job = subprocess.Popen([program, "--outdir", tmp_path, root / "input" / "shear_block.inp"], env=clean | wait, stdout=subprocess.DEVNULL)
    try:
        for _ in range(1000):                      # until the job runs
            if job.poll() is not None or (tmp_path / "shear_block.sta").exists():
                break
            time.sleep(0.02)
        assert job.poll() is None
        assert {line for line in Path(f"/proc/{job.pid}/environ").read_text().split("\0") if line.startswith(SETTINGS)} == wanted
        assert Path(f"/proc/{job.pid}/comm").read_text() == f"{program.name}\n"
    finally:
        job.kill()
        job.wait()


def test_outdir(run: Run, tmp_path: Path) -> None:
    """The results go where --outdir says, and nothing is left beside the deck."""
    decks, results = tmp_path / "decks", tmp_path / "results"
    decks.mkdir()
    results.mkdir()
    (decks / "job.inp").write_text(CUBE)
    done = run(["--outdir", results, decks / "job.inp"])
    assert done.returncode == 0, done.stdout + done.stderr
    assert [path.name for path in decks.iterdir()] == ["job.inp"]
    assert (results / "job.vtkhdf").exists()


def test_check_writes_nothing(run: Run, tmp_path: Path) -> None:
    """--check reads and checks the model, and writes no file."""
    (tmp_path / "job.inp").write_text(CUBE)
    done = run(["--check", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["job.inp"]


def test_quiet_is_quiet(run: Run, tmp_path: Path) -> None:
    """--quiet writes nothing when all is well."""
    (tmp_path / "job.inp").write_text(CUBE)
    done = run(["--quiet", "job"], cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_progress(run: Run, tmp_path: Path) -> None:
    """plain has a line for the increment, none has not; no control characters where there is no terminal."""
    (tmp_path / "job.inp").write_text(CUBE)
    head = re.compile(r"^ *step +inc", re.M)
    plain = run(["--progress=plain", "job"], cwd=tmp_path).stdout
    automatic = run(["job"], cwd=tmp_path).stdout
    silent = run(["--progress", "none", "job"], cwd=tmp_path).stdout
    assert head.search(plain)
    assert "100 %" in plain
    assert head.search(automatic)
    assert not head.search(silent)
    assert not re.search(r"[\x1b\r]", plain + automatic + silent)


def test_a_deck_that_talks_of_errors_does_not_look_like_one(run_deck: Run) -> None:
    """Calling programs search the output for *ERROR; a heading must not make a good job look bad."""
    done = run_deck(CUBE.replace("One cube, pulled", "** *ERROR in line 1: not really; one cube, pulled"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "*ERROR" not in done.stdout + done.stderr


def test_all_errors_of_a_deck_at_once(run_deck: Run, tmp_path: Path) -> None:
    """Exit code 3, each error with file, line and card, and no file is touched."""
    deck = CUBE.replace("*SOLID SECTION, ELSET=E", "*SOLID SECTION, ELSET=Es").replace("*MATERIAL", "*MATERAIL")
    done = run_deck(deck)
    assert done.returncode == DECK
    lines = done.stdout.splitlines()
    places = [line for line in lines if re.match(r"\S*job\.inp:\d+: \*ERROR", line)]
    assert len(places) >= 2, done.stdout
    for card in ("*MATERAIL, NAME=steel", "*SOLID SECTION, ELSET=Es, MATERIAL=steel"):
        assert any(line.strip() == card for line in lines), f"the card {card} is not shown:\n{done.stdout}"
    assert lines[-1].startswith("*ERROR")
    assert [path.name for path in tmp_path.iterdir()] == ["job.inp"]


def test_table_of_phases(run: Run, tmp_path: Path) -> None:
    """The table at the end: shares of the phases make 100 %, their seconds the whole job, and what they add to the peak of memory the peak."""
    (tmp_path / "cube.inp").write_text(CUBE)
    done = run(["cube"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    table = done.stdout.split("by phase", 1)[1]
    rows = re.findall(r"^    (\w+) +([\d.]+) +([\d.]+) % +([\d.]+)\.$", table, re.M)
    phases = ["reading", "model", "planning", "assembly", "contact", "factor", "krylov", "output", "other"]
    assert [name for name, *_ in rows] == phases, table
    whole = re.search(r"^    the whole job +([\d.]+) +(\d+)\.$", table, re.M)
    assert whole, table
    assert abs(sum(float(share) for *_, share, _ in rows) - 100) < 1
    seconds = sum(float(seconds) for _, seconds, *_ in rows)
    assert abs(seconds - float(whole[1])) <= 0.02 * float(whole[1]) + 0.005 * (len(phases) + 1), "each rounded to 0.01 s"
    grown = sum(float(megabytes) for *_, megabytes in rows)
    assert abs(grown - float(whole[2])) <= 0.5 * (len(phases) + 1), "each rounded to a megabyte"
    assert 5 < float(whole[2]) < 200
    by_unknown = re.search(r"^  peak of memory by unknown +([\d.]+) kB   \((\d+) unknowns\)$", table, re.M)
    assert by_unknown, table
    assert int(by_unknown[2]) == 24
    assert abs(float(by_unknown[1]) * 24 / 1048.576 - float(whole[2])) <= 0.5 + 0.01, "a peak rounded to a megabyte"


def test_contact_that_never_closes_is_reported(run: Run, root: Path, tmp_path: Path) -> None:
    """A cube that is lifted off its table, and one whose master is the slave, end well, but not without a word; the one that is pressed is fine."""
    shutil.copy(root / "input" / "three_cubes.mesh", tmp_path)
    deck = (root / "input" / "three_cubes.inp").read_text()
    lifted, swapped = deck.replace("LID, 3, 3, -0.001", "LID, 3, 3, 0.001"), deck.replace("CUBE_SOLE, TABLE_TOP", "TABLE_TOP, CUBE_SOLE")
    for text, is_reported in ((deck, False), (lifted, True), (swapped, True)):
        (tmp_path / "job.inp").write_text(text)
        done = run(["job"], cwd=tmp_path)
        assert done.returncode == 0, done.stdout
        assert ("*WARNING: No slave node touched its master" in done.stdout) == is_reported


@pytest.mark.parametrize(("wrong", "right", "message"), [
    ("210000., 0.3", "210000. 0.3", "a comma parts two numbers, and a point is the decimal mark"),
    ("*SOLID SECTION, ELSET", "*SOLID SECTION ELSET", "is not known; a comma is missing after *SOLID SECTION."),
    ("INPUT=three_cubes.mesh", "INPUT=four_cubes.mesh", "\n    *INCLUDE, INPUT=four_cubes.mesh\n"),
    ("*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n", "", "There is no material 'STEEL'; the deck has none at all."),
])  # fmt: skip
def test_slips_of_the_pen(run: Run, root: Path, tmp_path: Path, wrong: str, right: str, message: str) -> None:
    """The message gives the right form."""
    shutil.copy(root / "input" / "three_cubes.mesh", tmp_path)
    (tmp_path / "job.inp").write_text((root / "input" / "three_cubes.inp").read_text().replace(wrong, right))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode == 3
    assert message in done.stdout + done.stderr
