"""The commands of README, first job and joints run as they are written, from a bare clone.

Each block of commands (```sh) of a page runs in one shell, which ends at the first command that fails; a block of a file (```geo,
```inp, ```py after "`name`") is saved under its name first, as the reader does. Two things need the network and have a stand-in: the
address of the repository is that of this working copy, and the Python packages of .venv are those installed here. The objects of an
up-to-date build are taken over, because continuous integration has just built a bare checkout; else the clone is built from nothing.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from verify.conftest import ROOT

BLOCK = re.compile(r"```sh\n(.*?)```", re.DOTALL)
FILE = re.compile(r"`([\w.]+\.(?:geo|inp|py))`[^`]*```(?:geo|inp|py)\n(.*?)```", re.DOTALL)
PACKAGES = Path(sys.prefix)  #: the environment of this test, which has what verify/requirements.txt lists
LINKED = ("bin", "include", "lib", "lib64", "pyvenv.cfg", "share")


def commands_of(page: str) -> str:
    """All blocks of a page, one after the other."""
    blocks = BLOCK.findall((ROOT / page).read_text())
    assert blocks, f"{page} has no block of commands"
    return "".join(blocks)


def with_packages(commands: str) -> str:
    """The commands; after the clone .venv leads to the packages installed here, which pip would get from the network."""
    assert "cd amontons\n" in commands
    links = "".join(f"ln -s {PACKAGES / name} .venv/{name}\n" for name in LINKED if (PACKAGES / name).exists())
    return commands.replace("cd amontons\n", f"cd amontons\nmkdir .venv\n{links}touch .venv/installed\n{built_objects()}", 1)


def built_objects() -> str:
    """Commands that take over the objects of the build here, which has to be newer than all sources; else ''."""
    products = [ROOT / "bin" / "amontons", ROOT / "lib" / "libamontons.a", ROOT / "lib" / "libamontons.so"]
    sources = [path.stat().st_mtime for path in (*(ROOT / "src").rglob("*.*"), ROOT / "Makefile")]
    if not all(path.exists() and path.stat().st_mtime > max(sources) for path in products):
        return ""
    return ("git ls-files -z | xargs -0 touch -d 2000-01-01\nmkdir build\n"
            f"cp -a {ROOT}/build/*.o {ROOT}/build/*.mod build/\ncp -a {ROOT}/bin {ROOT}/lib .\n")  # fmt: skip


def run_commands(commands: str, cwd: Path, **environment: str) -> str:
    """Runs them in bash; all that they print."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("AMONTONS_", "MAKE", "PYTEST", "GIT_", "PYTHONPATH"))}
    done = subprocess.run(["bash", "-e", "-x", "-c", commands], cwd=cwd, env=kept | environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=1800, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout[-5000:]
    return done.stdout


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A clone of this working copy, made and built by the commands of the README."""
    if not (PACKAGES / "pyvenv.cfg").exists():
        pytest.skip("the Python packages are in no virtual environment: .venv would have to come from the network")
    folder = tmp_path_factory.mktemp("bare")
    origin = folder / "origin"
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        pytest.skip("this copy is no git repository, so that it cannot be cloned")
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).is_file():
            (origin / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, origin / name)
    run_commands("git init -q\ngit add -A\ngit -c user.name=test -c user.email=test commit -qm test", origin)
    address = {"GIT_CONFIG_COUNT": "1", "GIT_CONFIG_KEY_0": f"url.{origin}.insteadOf", "GIT_CONFIG_VALUE_0": "https://ADDRESS/amontons.git"}
    printed = run_commands(with_packages(commands_of("README.md")), folder, **address)
    made = folder / "amontons" / "results"
    for name in ("shear_block.vtkhdf", "shear_block.png", "shear_block.html", "three_cubes.vtkhdf"):
        assert (made / name).stat().st_size > 10_000, f"{name}\n{printed[-3000:]}"
    return folder / "amontons"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "made"),
    [
        (
            "doc/manual/first_job.md",
            ["results/three_cubes.png", "results/three_cubes.html", "bracket.dat", "bracket.png", "bracket.html", "pinned.png", "pinned_pairs.csv"],
        ),
        ("doc/manual/joints.md", [f"results/{name}.png" for name in ("press_fit", "bolted_joint", "snap_fit")]),
    ],
)
def test_commands_run_as_written(clone: Path, page: str, made: list[str]) -> None:
    """And write the files of which the page speaks."""
    for name, text in FILE.findall((ROOT / page).read_text()):
        if not (clone / name).exists():
            (clone / name).write_text(text)
    printed = run_commands(commands_of(page), clone)
    for name in made:
        assert (clone / name).stat().st_size > (10_000 if name.endswith(("png", "html")) else 0), f"{name}\n{printed[-3000:]}"
    if "pinned_pairs.csv" in made:
        check_pair_forces(clone / "pinned_pairs.csv")


def check_pair_forces(path: Path) -> None:
    """The pin hands its 2 kN to the bore, in proportion to time, and slips. T = mu N holds node by node; of the sums of the vectors
    N is a little smaller than the sum of its sizes, as the normals of the bore differ, so that T/N lies a little above mu."""
    with path.open() as table:
        rows = [{name: float(value) for name, value in row.items() if name} for row in csv.DictReader(table)]
    assert rows[-1]["total_time"] == 1
    for row in rows:
        assert abs(row["CFN3"] + row["CFS3"]) == pytest.approx(2000 * row["total_time"], rel=1e-4), row
        assert row["CFSM"] == pytest.approx(0.15 * row["CFNM"], rel=0.03), row
    assert rows[-1]["CAREA"] > 0
    assert rows[-1]["n_slip"] > 0



def test_a_command_that_fails_is_seen(tmp_path: Path) -> None:
    """Else the tests above prove nothing."""
    with pytest.raises(AssertionError, match="nothing_of_this_name"):
        run_commands("cat nothing_of_this_name\ntrue", tmp_path)


def test_no_other_commands_are_shown() -> None:
    """A command in an indented block, or one of .venv, would not be run by the test above."""
    for page in ("README.md", "doc/manual/first_job.md", "doc/manual/joints.md"):
        text = (ROOT / page).read_text()
        assert not re.findall(r"^    (?:make|bin/|\.venv|python|git|cd|mkdir)\b.*", text, re.M), page
        outside = BLOCK.sub("", text)
        assert ".venv/bin" not in outside, page
