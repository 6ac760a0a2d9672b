"""The installed tree: programs of others find it by pkg-config and CMake, in C and in Fortran; man page and completions.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from verify.conftest import Run

HERE = Path(__file__).resolve().parent


def do(command: list[str | Path], folder: Path, **more: str) -> str:
    """Runs a command that has to end well."""
    done = subprocess.run([str(w) for w in command], cwd=folder, env=os.environ | more, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prefix(root: Path, program: Path, library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where `make install` has put everything."""
    folder = tmp_path_factory.mktemp("prefix")
    build = (root / os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    done = subprocess.run(["make", "place", f"PREFIX={folder}", f"B={build}", f"BIN={program.parent}", f"LIB={library.parent}"],
                          cwd=root, env=environment, capture_output=True, text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def flags(prefix: Path, *what: str) -> list[str]:
    """The output of pkg-config."""
    return do(["pkg-config", *what, "amontons"], prefix, PKG_CONFIG_PATH=str(prefix / "lib" / "pkgconfig")).split()


@pytest.mark.skipif(not shutil.which("pkg-config"), reason="there is no pkg-config")
def test_pkg_config(prefix: Path, root: Path, run: Run, tmp_path: Path) -> None:
    """A C and a Fortran program, built with nothing but its flags, run."""
    rpath = f"-Wl,-rpath,{prefix / 'lib'}"
    do(["gcc", "-std=c11", HERE / "coupled_jobs.c", "-o", "coupled", *flags(prefix, "--cflags", "--libs"), rpath, "-lm"], tmp_path)
    assert "both done: 1" in do([tmp_path / "coupled"], tmp_path)
    do(["gfortran", *flags(prefix, "--cflags"), HERE / "press_and_look.f90", "-o", "look", *flags(prefix, "--libs"), rpath], tmp_path)
    output = do([tmp_path / "look", root / "input" / "three_cubes.inp"], tmp_path)
    assert "friction over normal force:  0.300000" in output
    assert flags(prefix, "--modversion")[0] in run(["--version"]).stdout


@pytest.mark.skipif(not shutil.which("cmake"), reason="there is no CMake")
@pytest.mark.parametrize("version", ["", "0.1", "0.1.0"])
def test_cmake(prefix: Path, tmp_path: Path, version: str) -> None:
    """find_package finds it, with and without a version."""
    (tmp_path / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject(user C)\nfind_package(amontons {version} REQUIRED)\n"
        f"add_executable(coupled {HERE / 'coupled_jobs.c'})\ntarget_link_libraries(coupled amontons::amontons m)\n")  # fmt: skip
    do(["cmake", "-S", ".", "-B", "out", f"-DCMAKE_PREFIX_PATH={prefix}"], tmp_path)
    do(["cmake", "--build", "out"], tmp_path)
    assert "both done: 1" in do([tmp_path / "out" / "coupled"], tmp_path)


def test_user_routines_after_install(prefix: Path, tmp_path: Path) -> None:
    """The installed program, with nothing of the tree at hand, compiles a UMAT that includes 'ABA_PARAM.INC' and runs it; so does a
    program that is linked with the installed library."""
    page = (HERE.parent.parent / "doc" / "manual" / "user_routines.md").read_text()
    source = re.findall(r"```fortran\n(.*?)```", page, re.DOTALL)[0].replace("'aba_param.inc'", "'ABA_PARAM.INC'")
    (tmp_path / "mine.f90").write_text(source)
    (tmp_path / "mine.inp").write_text(re.findall(r"```abaqus-user\n(.*?)```", page, re.DOTALL)[0])
    where = str(Path(shutil.which("gfortran") or "").parent)
    do(["env", "-i", f"PATH={where}:/usr/bin:/bin", prefix / "bin" / "amontons", "mine", "user=mine.f90"], tmp_path)
    (tmp_path / "a.c").write_text('''#include <stdio.h>
#include <amontons.h>
int main(void) {
  amontons_options options = AMONTONS_OPTIONS;
  amontons_job *job;
  double sum = 0, values[8];
  options.deck = "mine.inp", options.user = "mine.f90";
  int status = amontons_open(&options, &job);
  if (!status) status = amontons_advance_to(job, 1.0);
  if (!status) status = amontons_get(job, "POINT SDV", "BAR", values, 8, NULL, NULL);
  if (status) return printf("%s\\n", amontons_message(job)), status;
  for (int i = 0; i < 8; i++) sum += values[i];
  amontons_close(job);
  return printf("%.9f\\n", sum / 8), 0;
}
''')
    do(["gcc", "-std=c11", "a.c", "-o", "a", f"-I{prefix / 'include'}", f"-L{prefix / 'lib'}", "-lamontons", f"-Wl,-rpath,{prefix / 'lib'}"], tmp_path)
    assert do([tmp_path / "a"], tmp_path) == f"{4 * 52.5 / 210000:.9f}\n"


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("cmake"), reason="there is no CMake")
@pytest.mark.parametrize("version", ["0.2", "1.0", "0.0.1"])
def test_cmake_refuses_other_versions(prefix: Path, tmp_path: Path, version: str) -> None:
    """Interfaces may change with the middle number."""
    (tmp_path / "CMakeLists.txt").write_text(f"cmake_minimum_required(VERSION 3.16)\nproject(user C)\nfind_package(amontons {version} REQUIRED)\n")
    done = subprocess.run(["cmake", "-S", ".", "-B", "out", f"-DCMAKE_PREFIX_PATH={prefix}"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "compatible with requested" in done.stderr.replace("\n", " ")


def options_of(run: Run) -> set[str]:
    """The options that --help lists."""
    return set(re.findall(r"^  (--[a-z-]+)", run(["--help"]).stdout, re.MULTILINE))


@pytest.mark.parametrize("place", ["share/man/man1/amontons.1", "share/bash-completion/completions/amontons",
                                   "share/zsh/site-functions/_amontons", "share/fish/vendor_completions.d/amontons.fish"])  # fmt: skip
def test_every_option_is_listed(prefix: Path, run: Run, place: str) -> None:
    """Man page and completions know every option of --help, and no other; nothing is left to fill in."""
    text = re.sub(r" -l ([a-z])", r" --\1", (prefix / place).read_text().replace("\\-", "-"))
    assert "@" not in re.sub(r"@\(", "", text)
    assert set(re.findall(r"(?<![-\w])--[a-z]+(?:-[a-z]+)*", text)) == options_of(run)


@pytest.mark.skipif(not shutil.which("man"), reason="there is no man")
def test_man_page_is_well_formed(prefix: Path) -> None:
    """groff has nothing to complain of."""
    done = subprocess.run(["man", "--warnings", "-l", str(prefix / "share/man/man1/amontons.1")], capture_output=True, text=True,
                          env=os.environ | {"MANPAGER": "cat", "MANWIDTH": "100", "LC_ALL": "C.UTF-8"}, check=False)  # fmt: skip
    if "No manual entry" in done.stderr or "minimized" in done.stdout:
        pytest.skip("manual pages are not installed on this system")
    assert done.returncode == 0
    assert "mandoc" in done.stderr or done.stderr.strip() == ""
    assert "EXIT STATUS" in done.stdout


@pytest.mark.skipif(not shutil.which("bash"), reason="there is no bash")
def test_bash_completes(prefix: Path, tmp_path: Path) -> None:
    """Options, their values, and decks."""
    (tmp_path / "plate.inp").write_text("")
    (tmp_path / "plate.dat").write_text("")
    script = f"source {prefix / 'share/bash-completion/completions/amontons'}\n" + """
try() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _amontons; echo "${COMPREPLY[*]}"; }
try amontons --res; try amontons --dialect = ca; try amontons --progress p; try amontons pl
"""
    assert do(["bash", "-c", script], tmp_path).splitlines() == ["--resume", "calculix", "plain", "plate.inp"]


@pytest.mark.skipif(not shutil.which("zsh"), reason="there is no zsh")
def test_zsh_completion_is_well_formed(prefix: Path, tmp_path: Path) -> None:
    """zsh can read it."""
    do(["zsh", "-n", prefix / "share/zsh/site-functions/_amontons"], tmp_path)


@pytest.mark.skipif(not shutil.which("fish"), reason="there is no fish")
def test_fish_completes(prefix: Path, tmp_path: Path) -> None:
    """Options, their values, and decks."""
    (tmp_path / "plate.inp").write_text("")
    (tmp_path / "plate.dat").write_text("")
    script = f"source {prefix / 'share/fish/vendor_completions.d/amontons.fish'}\n" + """
for words in "amontons --res" "amontons --dialect=ca" "amontons --progress p" "amontons pl"
  complete -C $words
end
"""
    found = [line.split("\t")[0] for line in do(["fish", "-N", "-c", script], tmp_path).splitlines()]
    assert found == ["--resume", "--dialect=calculix", "plain", "plate.inp"]


def test_python_package_and_examples(prefix: Path, tmp_path: Path) -> None:
    """The installed package finds the installed library by itself, the installed commands run an installed example."""
    numbered = [path.name for path in (prefix / "lib").glob("libamontons.so.*")]
    assert numbered == ["libamontons.so.4"]
    assert "libamontons.so.4" in do(["readelf", "-d", prefix / "lib" / "libamontons.so"], tmp_path)
    for name in ("three_cubes.inp", "three_cubes.mesh"):
        shutil.copy(prefix / "share" / "amontons" / "examples" / name, tmp_path)
    script = "import amontons; print(amontons.binding.find_library()); job = amontons.Job('three_cubes.inp'); job.run(); print(job)"
    clean = {"PYTHONPATH": str(prefix / "lib" / "python3" / "dist-packages"), "AMONTONS_LIBRARY": ""}
    where, job = do([sys.executable, "-c", script], tmp_path, **clean).splitlines()
    assert where == str(prefix / "lib" / "libamontons.so")
    assert "20 increments" in job
    do([prefix / "bin" / "amontons-ccx", "-i", "three_cubes"], tmp_path)
    do([prefix / "bin" / "amontons-report", "three_cubes.vtkhdf"], tmp_path, PATH=f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    assert (tmp_path / "three_cubes.html").stat().st_size > 10_000


def test_uninstall(root: Path, program: Path, library: Path, tmp_path: Path) -> None:
    """No file is left of what was installed, and what others put there stays."""
    build = (root / os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    clean = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    (tmp_path / "share").mkdir()
    (tmp_path / "share" / "other.txt").write_text("of another program")
    for target in ("place", "uninstall"):
        subprocess.run(["make", target, f"PREFIX={tmp_path}", f"B={build}", f"BIN={program.parent}", f"LIB={library.parent}"], cwd=root,
                       env=clean, capture_output=True, check=True)  # fmt: skip
        assert (tmp_path / "bin" / "amontons").exists() == (target == "place")
    assert [path.name for path in tmp_path.rglob("*") if not path.is_dir()] == ["other.txt"]


@pytest.mark.skipif(not (shutil.which("dpkg-shlibdeps") and shutil.which("dpkg")), reason="Debian's tools are not installed (dpkg-dev)")
@pytest.mark.slow
def test_debian_package(root: Path, program: Path, library: Path, tmp_path: Path) -> None:
    """Packed, installed into an empty root, run, removed: it names the libraries that it needs, and nothing of it is left."""
    build = (root / os.environ.get("AMONTONS_UNITS", "build/unit")).parent
    clean = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    subprocess.run(["make", "pack-deb", f"B={build}", f"BIN={program.parent}", f"LIB={library.parent}", f"DEB={tmp_path / 'deb'}",
                    f"DIST={tmp_path}", "PACKING=-z1"], cwd=root, env=clean, capture_output=True, check=True)  # fmt: skip
    (package,) = tmp_path.glob("amontons_*.deb")
    fields = do(["dpkg-deb", "--field", package], tmp_path)
    version = re.search(r"^Version: (.*)$", fields, re.MULTILINE)
    assert version
    depends = re.search(r"^Depends: (.*)$", fields, re.MULTILINE)
    assert depends
    for name in ("libc6", "libgfortran5", "libhdf5", "libopenblas", "libcholmod", "libumfpack", "libmetis"):
        assert name in depends[1], name
    empty = tmp_path / "root"
    (empty / "var" / "lib" / "dpkg" / "info").mkdir(parents=True)
    (empty / "var" / "lib" / "dpkg" / "updates").mkdir()
    (empty / "var" / "lib" / "dpkg" / "status").touch()
    dpkg = ["dpkg", f"--root={empty}", "--force-depends", "--force-not-root", "--force-script-chrootless", f"--log={tmp_path / 'log'}"]
    do([*dpkg, "--install", package], tmp_path)
    assert version[1] in do([empty / "usr" / "bin" / "amontons", "--version"], tmp_path)
    for name in ("bin/amontons-ccx", "bin/amontons-report", "lib/libamontons.so", "lib/python3/dist-packages/amontons/py.typed", "share/man/man1/amontons.1",
                 "share/amontons/examples/three_cubes.inp", "share/doc/amontons/copyright"):  # fmt: skip
        assert (empty / "usr" / name).exists(), name
    do([*dpkg, "--purge", "amontons"], tmp_path)
    assert [str(path.relative_to(empty)) for path in empty.rglob("*amontons*")] == []
