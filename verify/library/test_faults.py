"""Faults: each ends with its exit code and a message, never with a wrong success. The table is doc/developer/reliability.md.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import re
import resource
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from common import block, cubes, same_results  # noqa: F401
from conftest import Run

DECK, SETUP, NOT_CONVERGED, SOLVER, IO = 3, 4, 5, 6, 7


def fails(done: subprocess.CompletedProcess[str], code: int, sentence: str) -> None:
    """Exit code, and a sentence somewhere in the output, whose last line starts with *ERROR."""
    assert done.returncode == code, f"exit code {done.returncode}, not {code}\n{done.stdout}{done.stderr}"
    assert re.search(sentence, done.stdout), done.stdout
    assert done.stdout.splitlines()[-1].startswith("*ERROR"), done.stdout


def cube_deck(cubes: Path, folder: Path, *changes: tuple[str, str]) -> Path:  # noqa: F811
    """The three cubes in one file, with some texts replaced."""
    mesh = (cubes.parent / "three_cubes.mesh").read_text()
    text = cubes.read_text().replace("*INCLUDE, INPUT=three_cubes.mesh\n", mesh)
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    deck = folder / "job.inp"
    deck.write_text(text)
    return deck


def test_missing_include(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """An include that is not there is told with its line."""
    (tmp_path / "job.inp").write_text(cubes.read_text())
    done = run(["job"], cwd=tmp_path)
    assert done.returncode in (DECK, IO), done.stdout
    assert "three_cubes.mesh" in done.stdout
    assert not (tmp_path / "job.vtkhdf").exists()


def test_a_million_lines(run: Run, tmp_path: Path) -> None:
    """A deck of a million lines is read, and a mistake in its last lines is told with its line."""
    n = 1_000_000
    cube = "0., 0.;1., 0.;1., 1.;0., 1."
    corners = [f"{4 * k + i}, {place}, {k}." for k in range(2) for i, place in enumerate(cube.split(";"), 1)]
    nodes = [f"{i}, {i % 100}., {i // 100 % 100}., {i // 10000}." for i in range(9, n + 1)]
    end = ["*ELEMENT, TYPE=C3D8, ELSET=BODY", "1, 1, 2, 3, 4, 5, 6, 7, 8", "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3",
           "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "*BOUNDARY", "1, 1, 3", "2, 2, 3", "4, 1, 3", "*STEP", "*STATIC",
           "*CLOAD", "7, 3, 1.", "*END STEP", ""]  # fmt: skip
    (tmp_path / "job.inp").write_text("\n".join(["*NODE", *corners, *nodes, *end]))
    done = run(["--check", "job"], cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    (tmp_path / "job.inp").write_text("\n".join(["*NODE", *corners, *nodes, *end]).replace("7, 3, 1.", "seven, 3, 1."))
    fails(run(["job"], cwd=tmp_path), DECK, rf"job\.inp:{n + 15}: .*seven")


def test_an_included_file_that_changes(program: Path, run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A job that was stopped does not go on if a file that its deck includes is another one now."""
    (tmp_path / "job.inp").write_text(cubes.read_text().replace("*STATIC\n", "*RESTART, WRITE\n*STATIC\n", 1))
    mesh = (cubes.parent / "three_cubes.mesh").read_text()
    (tmp_path / "three_cubes.mesh").write_text(mesh)
    assert run(["job"], cwd=tmp_path).returncode == 0
    (tmp_path / "three_cubes.mesh").write_text(mesh + "** another one\n")
    fails(run(["--resume", "job"], cwd=tmp_path), IO, "it has been changed")
    (tmp_path / "three_cubes.mesh").write_text(mesh)
    assert run(["--resume", "job"], cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("word", ["NaN", "Infinity", "1e999", "-inf", "0x1p3"])
def test_no_number_in_a_deck(run: Run, cubes: Path, tmp_path: Path, word: str) -> None:  # noqa: F811
    """What is no finite number is an error of the deck."""
    cube_deck(cubes, tmp_path, ("-0.001", word))
    fails(run(["job"], cwd=tmp_path), DECK, r"job\.inp:\d+")


def test_element_without_volume(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """An element squashed flat is found before the first step."""
    deck = cube_deck(cubes, tmp_path)
    lines = deck.read_text().splitlines()
    start = lines.index(next(line for line in lines if line.upper().startswith("*NODE")))
    for i in range(start + 1, start + 21):
        label, x, y, _ = lines[i].split(",")
        lines[i] = f"{label},{x},{y}, 0."
    deck.write_text("\n".join(lines) + "\n")
    fails(run(["job"], cwd=tmp_path), SETUP, "volume|inverted|inside out")


def test_singular_matrix(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A body that nothing holds is told before the first step, or the solver tells it; it is never solved."""
    cube_deck(cubes, tmp_path, ("FLOOR, 1, 3\n", "FLOOR, 3, 3\n"), ("*FRICTION\n0.3\n", ""))
    done = run(["job"], cwd=tmp_path)
    assert done.returncode in (SETUP, NOT_CONVERGED, SOLVER), done.stdout
    assert done.stdout.splitlines()[-1].startswith("*ERROR")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_unwritable_folder(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A folder that may not be written."""
    tmp_path.chmod(0o500)
    fails(run(["--outdir", tmp_path, cubes]), IO, "cannot create it")


def test_folder_that_takes_no_files(run: Run, cubes: Path) -> None:  # noqa: F811
    """The same for everyone, root included: /proc takes no files."""
    fails(run(["--outdir", "/proc", cubes]), IO, "cannot create it")


def test_result_file_is_a_folder(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A folder stands where the result file should."""
    for name in ("three_cubes.vtkhdf", "three_cubes.restart"):
        folder = tmp_path / name
        folder.mkdir()
        fails(run(["--outdir", tmp_path, cubes]), IO, "annot")
        folder.rmdir()


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 3 megabytes, where mounting is permitted."""
    disk = tmp_path / "disk"
    disk.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "none", str(disk)], capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"mounting a small disk is not permitted here: {done.stderr.strip()}")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


def test_full_disk(run: Run, block: Path, small_disk: Path, tmp_path: Path) -> None:  # noqa: F811
    """The job ends with exit code 7; with room again it goes on bitwise."""
    whole = tmp_path / "whole"
    whole.mkdir()
    assert run(["--outdir", whole, block]).returncode == 0
    fails(run(["--outdir", small_disk, block]), IO, "No space left on device|disk full")
    assert (small_disk / "block.restart").exists()
    room = tmp_path / "room"
    shutil.copytree(small_disk, room)
    assert run(["--resume", "--outdir", room, block]).returncode == 0
    assert same_results(whole / "block.vtkhdf", room / "block.vtkhdf") == []


@pytest.mark.parametrize("kilobytes", [0, 20, 200, 1000])
def test_no_room_for_any_file(program: Path, block: Path, tmp_path: Path, kilobytes: int) -> None:  # noqa: F811
    """Files that may not grow beyond a limit: exit code 7, whichever of them meets it first."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024 * kilobytes, 1024 * kilobytes))

    done = subprocess.run([str(program), "--outdir", str(tmp_path), str(block)], capture_output=True, text=True,
                          preexec_fn=limit, env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
    assert done.returncode == IO, f"exit code {done.returncode}\n{done.stdout}{done.stderr}"
    assert done.stdout.splitlines()[-1].startswith("*ERROR")


@pytest.mark.parametrize("megabytes", [200, 240, 280, 320, 400])
def test_no_memory(program: Path, root: Path, tmp_path: Path, megabytes: int) -> None:
    """With too little memory the job ends with exit code 6 (8 if a library ends it its own way), never as if done."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (1024 * 1024 * megabytes, 1024 * 1024 * megabytes))

    done = subprocess.run([str(program), "--outdir", str(tmp_path), str(root / "input" / "shear_block.inp")],
                          capture_output=True, text=True, preexec_fn=limit,
                          env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})  # fmt: skip
    if done.returncode == 0:
        assert (tmp_path / "shear_block.sta").read_text().count("\n") == 22
        pytest.skip(f"{megabytes} megabytes are enough")
    assert done.returncode in (SOLVER, 8), f"exit code {done.returncode}\n{done.stdout[-600:]}{done.stderr[-600:]}"
    assert done.stdout.splitlines()[-1].startswith("*ERROR"), done.stdout[-600:]


def test_screen_that_is_gone(program: Path, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """A screen that takes no lines does not end the job."""
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([str(program), "--outdir", str(tmp_path), str(cubes)], stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 0
    assert len((tmp_path / "three_cubes.sta").read_text().splitlines()) == 22


def test_long_names(run: Run, cubes: Path, tmp_path: Path) -> None:  # noqa: F811
    """Names of 80 characters."""
    cube_deck(cubes, tmp_path, ("CUBE_SOLE", "S" * 80), ("TABLE_TOP", "T" * 80), ("RUBBING", "R" * 80))
    assert run(["job"], cwd=tmp_path).returncode == 0
