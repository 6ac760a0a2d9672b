"""Runs jobs with a program built with sanitizers, and reports what these found: `make sanitize`, `make races`.

SPDX-License-Identifier: GPL-3.0-or-later

The jobs are all decks of the card reference (each card is in one of them), three cubes with friction, the decks of the page on
restarts, and jobs with UMAT (also unsymmetric), FRIC and UINTER; contact by springs at points, by the dual mortar method and with analytic masters; the
iterative solver: each kind of element, law, load, constraint and output once. With --preload the program is one built with
ThreadSanitizer: two larger blocks come along, one of them large enough for threads to share the elimination tree, and a C program with
two jobs in two threads.

With --suite pytest runs the tests that are named behind it with the program, the library and the unit programs of a build with
BUILD=sanitize, and the findings of all processes are reported at the end:

    make BUILD=sanitize programs
    .venv/bin/python -m verify.sanitizers.run --program build/sanitize/bin/amontons --suite -n 2 verify
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
FINDING = re.compile(r"runtime error: .*|ERROR: AddressSanitizer.*|WARNING: ThreadSanitizer.*|^ +#[0-4] .*", re.MULTILINE)
LIMIT = 1800  #: seconds for a job


def jobs(folder: Path) -> list[list[str]]:
    """The words of each job; decks that are not files of the repository are written into the folder."""
    decks = [*sorted((ROOT / "doc" / "manual" / "examples").glob("*.inp")), ROOT / "input" / "three_cubes.inp"]
    found = [["--outdir", str(folder), str(deck)] for deck in decks]
    page = (ROOT / "doc" / "manual" / "restart.md").read_text()
    for name, deck in zip(("first", "second"), re.findall(r"```abaqus\S*\n(.*?)```", page, re.DOTALL), strict=True):
        (folder / f"{name}.inp").write_text(deck)
    found += [["first"], ["second", "oldjob=first"]]
    page = (ROOT / "doc" / "manual" / "user_routines.md").read_text()
    (folder / "mine.f90").write_text(re.findall(r"```fortran\n(.*?)```", page, re.DOTALL)[0])
    (folder / "mine.inp").write_text(re.findall(r"```abaqus-user\n(.*?)```", page, re.DOTALL)[0])
    return [*found, ["mine", "user=mine.f90"], *surface_jobs(folder), *routine_jobs(folder)]


def surface_jobs(folder: Path) -> list[list[str]]:
    """Contact by other means than at nodes, and without a factor; decks of the tests."""
    from verify.decks import make_decks
    from verify.library import test_restart

    (folder / "points.inp").write_text(test_restart.points_deck())
    (folder / "mortar.inp").write_text(test_restart.mortar_deck())
    iterative = make_decks.block_deck(4).replace("*STATIC", "*STATIC, SOLVER=ITERATIVE CHOLESKY")
    (folder / "iterative.inp").write_text(iterative)
    return [["points"], ["mortar"], ["iterative"]]


def routine_jobs(folder: Path) -> list[list[str]]:
    """FRIC, UINTER, and laws that are not symmetric."""
    from verify.library import test_user_contact, test_user_routines

    routines = test_user_contact.ROUTINES
    (folder / "fric.inp").write_text(test_user_contact.rubbed(test_user_contact.SOFT_FRIC, nlgeom=True))
    (folder / "uinter.inp").write_text(test_user_contact.rubbed(test_user_contact.UINTER, nlgeom=True))
    found = [["fric", f"user={routines}"], ["uinter", f"user={routines}"]]
    for kind in ("C3D8", "C3D20R", "CAX4R"):
        (folder / f"sand_{kind}.inp").write_text(test_user_routines.unsymmetric_deck(kind, test_user_routines.FRICTIONAL))
        found.append([f"sand_{kind}", f"user={test_user_routines.ROUTINES / 'unsymmetric.f90'}"])
    return found


def verdict(command: list[str], folder: Path) -> list[str]:
    """Runs a command: its findings, and a line if it did not end well."""
    environment = os.environ | {
        "OMP_NUM_THREADS": "2",
        "ASAN_OPTIONS": "detect_leaks=0:exitcode=99",  # a job that is done leaves its last state to the system
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "TSAN_OPTIONS": "exitcode=99:ignore_noninstrumented_modules=1",
    }
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, errors="replace", timeout=LIMIT)
    output = done.stdout + done.stderr
    found = FINDING.findall(output) if re.search("runtime error|Sanitizer", output) else []
    return found + ([f"exit code {done.returncode}: {output.strip().splitlines()[-1:]}"] if done.returncode != 0 else [])


def run_two_threads(library: Path, folder: Path, preload: Path) -> list[str]:
    """The findings of api_calls.c, which has two jobs in two threads, with the library of a build with ThreadSanitizer."""
    from verify.decks import make_decks
    from verify.library import test_library

    deck = folder / "two.inp"
    deck.write_text(make_decks.block_deck(2))
    deck.write_text(test_library.warm_deck(deck))
    subprocess.run(["gcc", "-std=c11", "-g", "-fsanitize=thread", f"-I{ROOT / 'src' / 'driver'}", str(ROOT / "verify" / "library" / "api_calls.c"), "-o", "api_calls",
                    str(library), f"-Wl,-rpath,{library.parent}", "-lpthread"], cwd=folder, check=True)  # fmt: skip
    return verdict(["env", f"LD_PRELOAD={preload}", "./api_calls", str(deck)], folder)


def run(program: Path, words: list[str], folder: Path, preload: Path | None) -> list[str]:
    """The findings of one job, and a line if it did not end well."""
    command = [str(program), "--progress=none", *words]
    return verdict(["env", f"LD_PRELOAD={preload}", *command] if preload else command, folder)


#: Tests that limit memory or stack cannot run: a program with sanitizers maps terabytes. One counts megabytes, one takes the environment
#: away in which leaks are passed over, those in a browser run out of time. The others look at how others build.
NOT_SANITIZED = ("not memory and not no_space and not strange_surroundings and not table_of_phases and not after_install "
                 "and not in_a_browser and not determinism and not lint and not site and not api and not fuzz and not kept_outside")  # fmt: skip


def run_suite(program: Path, words: list[str]) -> int:
    """Pytest with the programs of a build; 1 if a sanitizer found anything in any process."""
    build = program.parent.parent
    runtimes = [subprocess.run(["gcc", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
                for name in ("libasan.so", "libstdc++.so")]  # the second for modules of Python that throw  # fmt: skip
    with tempfile.TemporaryDirectory() as name:
        environment = os.environ | {
            "AMONTONS_BIN": str(program.parent), "AMONTONS_LIB": str(build / "lib"), "AMONTONS_UNITS": str(build / "unit"), "OMP_NUM_THREADS": "1",
            "ASAN_OPTIONS": f"detect_leaks=0:exitcode=99:alloc_dealloc_mismatch=0:log_path={name}/found",  # Python and gcc leak
            "UBSAN_OPTIONS": f"print_stacktrace=1:halt_on_error=1:exitcode=99:log_path={name}/found",
            "LD_PRELOAD": " ".join(runtimes),
        }  # fmt: skip
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", NOT_SANITIZED, *words]
        status = subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode
        texts = [path.read_text(errors="replace") for path in sorted(Path(name).iterdir())]
    found = [text for text in texts if "/ccx+" not in text]  # CalculiX runs beside, and reads past an array of its own
    for text in found:
        print("\n".join(FINDING.findall(text)[:12]))
    print(f"{len(found)} processes with findings; pytest ended with {status}")
    return 1 if found else 0


def main() -> int:
    """Runs all jobs; 1 if anything was found."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="built with BUILD=sanitize or BUILD=races")
    parser.add_argument("--preload", type=Path, help="gomp_order.so, for ThreadSanitizer")
    parser.add_argument("--suite", nargs=argparse.REMAINDER, help="words for pytest: run tests, not the jobs")
    options = parser.parse_args()
    if options.suite is not None:
        return run_suite(options.program.resolve(), options.suite)
    n_found = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        todo = jobs(folder)
        if options.preload:
            from verify.decks import make_decks

            (folder / "block.inp").write_text(make_decks.block_deck(6))
            first, _, _ = make_decks.block_deck(14).partition("Drag")  # the first step of a larger one
            (folder / "tree.inp").write_text(first[: first.rindex("*STEP")].replace("0.1, 1., , 0.1", "0.5, 1."))
            todo += [["block"], ["tree"]]
        for words in todo:
            found = run(options.program.resolve(), words, folder, options.preload and options.preload.resolve())
            print(f"{Path(words[-1] if words[0] == '--outdir' else words[0]).stem:20s} {'clean' if not found else 'FOUND'}", flush=True)
            print("".join(f"    {line.strip()}\n" for line in found[:40]), end="")
            n_found += bool(found)
        if options.preload:
            found = run_two_threads(options.program.resolve().parent.parent / "lib" / "libamontons.so", folder, options.preload.resolve())
            todo.append(["two jobs in two threads"])
            print(f"{todo[-1][0]:20s} {'clean' if not found else 'FOUND'}", *found[:40], sep="\n    ")
            n_found += bool(found)
    print(f"{len(todo) - n_found} jobs clean, {n_found} with findings")
    return 1 if n_found else 0


if __name__ == "__main__":
    sys.exit(main())
