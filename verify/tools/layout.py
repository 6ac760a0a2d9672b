"""Puts the white space of the Fortran files in order: fprettify, and the project's own rules that it does not know.

Continuation lines and comments keep their place, `//` and `.not.` have a blank before them, products in types too, a procedure may be
called `read`, two blank lines stand between procedures.
    layout.py FILE...           rewrites the files
    layout.py --check FILE...   prints the difference and exits 1 if there is one
"""

import contextlib
import difflib
import io
import multiprocessing
import re
import sys
from pathlib import Path

import fprettify

ROOT = Path(__file__).resolve().parents[2]
STRING_OR_COMMENT = re.compile(r"'[^']*'|\"[^\"]*\"|!.*")
CONCATENATION = re.compile(r"(?<=\S) *// *(?=\S)")
TIMES_ARRAY = re.compile(r"(?<=[\w)\]])\*\[")  # fprettify takes the blanks out of `2 * [1, 2]`
LEADING = re.compile(r"^( *)//(?=\S)")  # a continuation line that begins with `//`
NEGATION = re.compile(r",(?=\.not\.)")
NAMED_READ = re.compile(r"\b(subroutine|call) read \(")
TIGHT_PRODUCT = re.compile(r"[\w)]\*[\w(]")
END_OF_PROCEDURE = re.compile(r"  end (subroutine|function)\b")
fprettify.NO_ALIGN_RE = re.compile("")  # its mark for "leave the continuation lines of this statement alone": all of them


def run_fprettify(path: Path) -> str:
    """The file as fprettify would have it."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        fprettify.run(["fprettify", "--config-file", str(ROOT / ".fprettify.rc"), "--stdout", str(path)])
    return out.getvalue()


def space_operators(line: str) -> str:
    """`a//b` becomes `a // b` and `2*[` becomes `2 * [`, outside strings and comments."""
    kept: list[str] = []

    def hide(match: re.Match[str]) -> str:
        kept.append(match.group())
        return f"\0{len(kept) - 1}\0"

    line = CONCATENATION.sub(" // ", STRING_OR_COMMENT.sub(hide, line))
    line = NAMED_READ.sub(r"\1 read(", NEGATION.sub(", ", LEADING.sub(r"\1// ", line)))
    line = TIMES_ARRAY.sub(" * [", line).replace(", quiet = ", ", quiet=")
    return re.sub(r"\0(\d+)\0", lambda match: kept[int(match.group(1))], line)


def part_procedures(lines: list[str]) -> list[str]:
    """Two blank lines after each procedure of a module that another one follows; elsewhere never more than one."""
    result: list[str] = []
    for number, line in enumerate(lines):
        result.append(line)
        blank, follows = (lines + ["", ""])[number + 1 : number + 3]
        if END_OF_PROCEDURE.match(line) and not blank and follows.startswith("  "):
            result.append("")
    return result


def keep_place(old: list[str], new: list[str]) -> list[str]:
    """Comments, and products that fprettify takes for lengths of character, stay as they were. (It takes away blank lines.)"""
    before = [line for line in old if line.strip()]
    if len(before) != sum(1 for line in new if line.strip()):
        return new
    lines = iter(before)
    return [(was if is_kept(was := next(lines), line) else line) if line.strip() else line for line in new]


def is_kept(old: str, new: str) -> bool:
    """Whether fprettify's line differs only in what it does not know."""
    if old.lstrip().startswith("!<"):
        return True
    tight = STRING_OR_COMMENT.sub("", new)
    return "".join(old.split()) == "".join(new.split()) and bool(TIGHT_PRODUCT.search(tight)) and not TIGHT_PRODUCT.search(STRING_OR_COMMENT.sub("", old))


def lay_out(path: Path) -> str:
    """The file in the project's layout."""
    old = path.read_text().splitlines()
    lines = keep_place(old, [space_operators(line) for line in run_fprettify(path).splitlines()])
    return "\n".join(part_procedures(lines)) + "\n"


def main() -> int:
    """See the top of this file."""
    arguments = sys.argv[1:]
    is_check = "--check" in arguments
    n_different = 0
    paths = [Path(name) for name in arguments if name != "--check"]
    with multiprocessing.Pool() as pool:
        laid_out = pool.map(lay_out, paths)
    for path, new in zip(paths, laid_out, strict=True):
        old = path.read_text()
        if old == new:
            continue
        n_different += 1
        if is_check:
            sys.stdout.writelines(
                difflib.unified_diff(old.splitlines(True), new.splitlines(True), str(path), "make format", n=0)
            )
        else:
            path.write_text(new)
    return 1 if is_check and n_different else 0


if __name__ == "__main__":
    sys.exit(main())
