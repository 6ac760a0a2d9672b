"""Proves the layers of src against the use lines, and the limits of doc/developer/style.md against the source.

    python3 -m verify.tools.lint          prints what is wrong, one line each, and exits 1 if there is something
    python3 -m verify.tools.lint --write  first generates src/depends.mk from the use lines

The layers are the folders of src, bottom-up in the order of the table in src/README.md. A module uses modules of its own folder
(without a cycle) and of folders that stand above its own in the table.
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from verify.tools.names import check_constants, check_glossary, check_public_names, check_words
from verify.tools.wrap import check_widths

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"

MAX_PROCEDURE_LINES = 90
MAX_ARGUMENTS = 9
MAX_NESTING = 4
MAX_FILE_LINES = 900
MAX_STEERING_CONTROLS = 50  #: constants of the nonlinear solver, beside the slots of the card CONTROLS and those of linear solvers
STEERING = re.compile(r"type :: (?:newton|globalization|subproblem|line_search|contact|cycling|increment)_controls_type\n(.*?)end type", re.DOTALL)
MODULES_THAT_STOP = {"main"}
MODULES_THAT_PRINT = {"main", "logger"}
MODULES_THAT_SET_UP = {"model_setup", "user_routine_setup", "submodel_results"}
FOLDERS_THAT_SET_UP = {"model", "expansion", "input"}

PREFIX = r"(?:(?:pure|impure|elemental|recursive|non_recursive|module|(?:integer|real|logical|character|type|class)\s*\([^)]*\)|integer|real|logical)\s+)*"
PROCEDURE = re.compile(rf"^{PREFIX}(?P<kind>subroutine|function)\s+(?P<name>\w+)\s*(?:\((?P<arguments>[^)]*)\))?", re.I)
END_PROCEDURE = re.compile(r"^end\s+(?:subroutine|function)\b", re.I)
OPENS = re.compile(
    r"^(?:\w+\s*:\s*)?(?:if\s*\(.*\)\s*then|do\b|select\s+(?:case|type|rank)|associate\b|block\s*$|critical\b"
    r"|(?:where|forall)\s*\(.*\)\s*$)", re.I)
CLOSES = re.compile(r"^end\s+(?:if|do|select|associate|block|critical|where|forall)\b", re.I)
TYPE = re.compile(r"^type\s*(?:,|::|\s\w)", re.I)
STOP = re.compile(r"(?:^|\)\s*)(?:error\s+)?stop(?:\s|$|\()", re.I)
PRINT = re.compile(r"^print\b|\bwrite\s*\(\s*(?:\*|6|output_unit|error_unit)\s*,", re.I)
USE = re.compile(r"^use\s+amontons_(\w+)", re.I)
THEORY_HEADING = re.compile(r"^#+ .*\[([^\]]+)\]$")
MODEL_CHANGED = re.compile(r"^type\s*\(\s*model_type\s*\).*\bintent\s*\(\s*(?:in\s*)?out\s*\)", re.I)
MODEL_ASSIGNED = re.compile(r"(?:^|\)\s*)(?:\w+%)*model%[\w%():,+*\- ]*=(?![=>])", re.I)
MODULES_WITHOUT_PROGRAM = {
    "version": "holds one constant",
    "main": "is the program: verify/command_line runs it",
}
SEARCH_PATH = re.compile(r"\bsys\.path\b")
LAYER_ROW = re.compile(r"^\| `(\w+)` \|([^|]*)\|")
TYPE_NAME = re.compile(r"^type\s*(?:,[^:]*)?(?:::)?\s*(\w+)$", re.I)
NOT_A_VARIABLE = re.compile(r"^(?:use|public|private|procedure|generic|import|type|interface|end)\b", re.I)


@dataclass
class Statement:
    """One statement, continuation lines joined, comments and the text of strings taken out."""

    line: int
    text: str


@dataclass
class Procedure:
    """A procedure that the reader of the file is inside of."""

    name: str
    line: int
    nesting: int = 0
    deepest: int = 0


@dataclass
class Module:
    """What one file of src says about itself."""

    name: str
    lines: list[str]
    folder: str = ""
    uses: list[str] = field(default_factory=list)
    types: list[str] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)

    @property
    def path(self) -> str:
        """The file, from the top of the repository."""
        return "/".join(["src", *([self.folder] if self.folder else []), f"{self.name}.f90"])

    def complain(self, line: int, text: str) -> None:
        """Adds one trouble at a line (counted from 1)."""
        self.troubles.append(f"{self.path}:{line}: {text}")


def strip_text(line: str) -> str:
    """The line without its comment and without what stands in its strings."""
    line = re.sub(r"'[^']*'|\"[^\"]*\"|!.*", lambda match: "" if match.group()[0] == "!" else "''", line)
    return line.strip()


def statements(lines: list[str]) -> Iterator[Statement]:
    """The statements of a file in order."""
    start, text = 0, ""
    for number, line in enumerate(lines, 1):
        part = strip_text(line)
        if not part:
            continue
        start = start or number
        text += part.lstrip("&").removesuffix("&")
        if not part.endswith("&"):
            yield Statement(start, text.strip())
            start, text = 0, ""


def check_lines(module: Module) -> None:
    """Length of the file, its first two lines. (The length of the lines is fortitude's.)"""
    if len(module.lines) > MAX_FILE_LINES:
        module.complain(len(module.lines), f"the file has {len(module.lines)} lines, allowed are {MAX_FILE_LINES}")
    if not module.lines or not module.lines[0].startswith("!> "):
        module.complain(1, "the first line is not `!> One sentence what this module is.`")
    if "SPDX-License-Identifier: GPL-3.0-or-later" not in "".join(module.lines[:3]):
        module.complain(2, "the licence line is missing")


def check_procedure_head(module: Module, statement: Statement, match: re.Match[str]) -> None:
    """Docstring and number of arguments."""
    above = module.lines[statement.line - 2].strip() if statement.line > 1 else ""
    if not above.startswith("!"):
        module.complain(statement.line, f"{match['name']} has no docstring")
    arguments = [name for name in (match["arguments"] or "").split(",") if name.strip()]
    if len(arguments) > MAX_ARGUMENTS:
        module.complain(statement.line, f"{match['name']} has {len(arguments)} arguments, allowed are {MAX_ARGUMENTS}")


def check_procedure_end(module: Module, procedure: Procedure, last_line: int) -> None:
    """Length and nesting."""
    n_lines = last_line - procedure.line + 1
    if n_lines > MAX_PROCEDURE_LINES:
        module.complain(procedure.line, f"{procedure.name} has {n_lines} lines, allowed are {MAX_PROCEDURE_LINES}")
    if procedure.deepest > MAX_NESTING:
        module.complain(procedure.line, f"{procedure.name} nests {procedure.deepest} deep, allowed are {MAX_NESTING}")


def check_statement(module: Module, statement: Statement) -> None:
    """What no module may say, whatever surrounds it."""
    if STOP.search(statement.text) and module.name not in MODULES_THAT_STOP:
        module.complain(statement.line, "stop: only main.f90 stops")
    if PRINT.search(statement.text) and module.name not in MODULES_THAT_PRINT:
        module.complain(statement.line, "this writes to the screen: only the logger does")
    if re.match(r"use\b", statement.text, re.I) and not re.search(r",\s*only\s*:", statement.text, re.I):
        module.complain(statement.line, "use without only")
    if re.search(r"(?:^|,\s*)save\b", statement.text, re.I):
        module.complain(statement.line, "save: no procedure keeps a hidden state")
    if module.folder not in FOLDERS_THAT_SET_UP and module.name not in MODULES_THAT_SET_UP:
        check_frozen(module, statement)


def check_frozen(module: Module, statement: Statement) -> None:
    """No code changes the model after its set-up."""
    if MODEL_CHANGED.search(statement.text) or MODEL_ASSIGNED.search(statement.text):
        module.complain(statement.line, "this can change the model, which is frozen after its set-up")


def check_declaration(module: Module, statement: Statement) -> None:
    """No variables in the head of a module."""
    attributes, separator, names = statement.text.partition("::")
    if separator and not NOT_A_VARIABLE.match(statement.text) and "parameter" not in attributes.lower():
        module.complain(statement.line, f"module variable: {names.strip()}")


def read_statements(module: Module) -> None:
    """Walks through the file once: heads, bodies and ends of modules, types, interfaces and procedures."""
    stack: list[Procedure] = []
    outside = {"type": 0, "interface": 0}
    is_head = False
    for statement in statements(module.lines):
        text = statement.text
        lower = text.lower()
        check_statement(module, statement)
        if use := USE.match(text):
            module.uses.append(use[1].lower())
        if re.match(r"(?:abstract\s+)?interface\b", lower):
            outside["interface"] += 1
        elif re.match(r"end\s+interface\b", lower):
            outside["interface"] -= 1
        if outside["interface"]:
            continue
        if match := re.match(r"(?:module|program)\s+(\w+)$", lower):
            is_head = match[0].startswith("module")
            if is_head and match[1] != f"amontons_{module.name}":
                module.complain(statement.line, f"the module is {match[1]}, the file needs amontons_{module.name}")
        elif TYPE.match(text) and not re.match(r"type\s*\(", lower):
            outside["type"] += 1
            if name := TYPE_NAME.match(lower):
                module.types.append(name[1])
        elif re.match(r"end\s+type\b", lower):
            outside["type"] -= 1
        elif lower == "contains" and not outside["type"]:
            is_head = False
        elif is_head and not outside["type"]:
            check_declaration(module, statement)
        walk_procedures(module, statement, stack)


def walk_procedures(module: Module, statement: Statement, stack: list[Procedure]) -> None:
    """Keeps the stack of open procedures and the depth of the blocks in the innermost one."""
    if END_PROCEDURE.match(statement.text):
        if stack:
            check_procedure_end(module, stack.pop(), statement.line)
    elif match := PROCEDURE.match(statement.text):
        check_procedure_head(module, statement, match)
        stack.append(Procedure(match["name"], statement.line))
    elif stack and CLOSES.match(statement.text):
        stack[-1].nesting -= 1
    elif stack and OPENS.match(statement.text):
        stack[-1].nesting += 1
        stack[-1].deepest = max(stack[-1].deepest, stack[-1].nesting)


def read_module(path: Path) -> Module:
    """One file of src with all that is wrong in it."""
    folder = path.parent.name if path.parent.parent == SOURCE else ""
    module = Module(path.stem, path.read_text().splitlines(), folder)
    check_lines(module)
    read_statements(module)
    module.uses = list(dict.fromkeys(name for name in module.uses if name != module.name))
    return module


def read_modules(source: Path = SOURCE) -> list[Module]:
    """All modules below src."""
    return [read_module(path) for path in sorted(source.rglob("*.f90"))]


def read_layers(source: Path = SOURCE) -> dict[str, str]:
    """The folders of src bottom-up, each with its sentence: the table in src/README.md."""
    page = source / "README.md"
    rows = [LAYER_ROW.match(line) for line in page.read_text().splitlines()] if page.exists() else []
    return {row[1]: row[2].strip() for row in rows if row}


def in_order(modules: dict[str, Module], layers: list[str]) -> tuple[list[str], list[str]]:
    """The names of the modules so that each follows those that it uses, folder by folder; and what is wrong with the layers."""
    rank = {folder: number for number, folder in enumerate(layers)}
    order: list[str] = []
    troubles: list[str] = []
    open_names: list[str] = []

    def place(name: str) -> None:
        if name in order:
            return
        if name in open_names:
            troubles.append(f"{modules[name].path}: a cycle of modules: {' -> '.join([*open_names[open_names.index(name):], name])}")
            return
        open_names.append(name)
        for used in modules[name].uses:
            if used not in modules:
                troubles.append(f"{modules[name].path}: there is no module {used} in src")
            elif rank.get(modules[used].folder, 0) > rank.get(modules[name].folder, 0):
                troubles.append(f"{modules[name].path}: uses {used} of the higher folder {modules[used].folder}")
            elif modules[used].folder == modules[name].folder:
                place(used)
        open_names.pop()
        order.append(name)

    for name in sorted(modules, key=lambda name: (rank.get(modules[name].folder, 0), name)):
        place(name)
    return order, troubles


def depends_text(modules: dict[str, Module], order: list[str]) -> str:
    """What stands in src/depends.mk."""
    number = {name: index for index, name in enumerate(order)}
    lines = ["# Generated from the use lines by `make depends`: each module with the modules that it uses, bottom-up. Do not edit."]
    folder = None
    for name in order:
        if modules[name].folder != folder:
            folder = modules[name].folder
            lines += ["", f"# {folder}"]
        uses = sorted(modules[name].uses, key=lambda used: number.get(used, -1))
        lines.append(f"uses_{name} = {' '.join(uses)}".rstrip())
    return "\n".join(lines) + "\n"


def check_layers(modules: list[Module], layers: list[str]) -> list[str]:
    """Folders and table agree, each name of a module or a type stands once, nothing is used upward."""
    folders = {module.folder for module in modules}
    troubles = [f"src/README.md: there is no folder {folder} in src" for folder in layers if folder not in folders]
    troubles += [f"src/README.md: the folder {folder} is missing" for folder in sorted(folders) if layers and folder not in layers]
    for what, pairs in (("module", [(module.name, module) for module in modules]),
                        ("type", [(name, module) for module in modules for name in module.types])):
        first: dict[str, Module] = {}
        for name, module in pairs:
            if first.setdefault(name, module) is not module:
                troubles.append(f"{module.path}: the {what} {name} stands in {first[name].path}, too")
    return troubles + in_order({module.name: module for module in modules}, layers)[1]


def check_documents(names: set[str], root: Path) -> list[str]:
    """Modules that a heading of the theory names in brackets exist."""
    troubles = []
    for page in sorted((root / "doc" / "theory").glob("*.md")):
        for number, line in enumerate(page.read_text().splitlines(), 1):
            if heading := THEORY_HEADING.match(line):
                named = [word.partition(":")[0].strip() for word in heading[1].split(",")]
                troubles += [f"{page.relative_to(root)}:{number}: there is no module {name}" for name in named if name not in names]
    return troubles


def check_search_paths(root: Path) -> list[str]:
    """No Python file or page changes where Python searches: all imports start at `verify` or `amontons`."""
    files = sorted(path for folder in ("verify", "python", "doc") for ending in ("*.py", "*.md") for path in (root / folder).rglob(ending))
    return [f"{path.relative_to(root)}:{number}: the search path of Python is changed; import from the package verify"
            for path in files for number, line in enumerate(path.read_text().splitlines(), 1) if SEARCH_PATH.search(line)]  # fmt: skip


def check_unit_programs(modules: list[Module], root: Path) -> list[str]:
    """Each module has a program verify/unit/<folder>/test_<module>.f90, or a reason to have none that is not stale."""
    programs = root / "verify" / "unit"
    found = {path.relative_to(programs).as_posix() for path in programs.glob("*/test_*.f90")}
    wanted = {f"{module.folder}/test_{module.name}.f90": module for module in modules}
    names = {module.name for module in modules}
    troubles = [f"{module.path}: has no unit program verify/unit/{program}" for program, module in wanted.items()
                if program not in found and module.name not in MODULES_WITHOUT_PROGRAM]
    troubles += [f"verify/tools/lint.py: {name} needs no reason to have no unit program" for name in MODULES_WITHOUT_PROGRAM
                 if name not in names or any(wanted[program].name == name for program in found & set(wanted))]
    return troubles


def check_controls(text: str) -> list[str]:
    """The controls that steer Newton's method, contact and increments are few: a rule more needs a rule less."""
    n = sum(len(re.findall(r"^ +(?:integer|real\(DP\)) :: \w+ =", fields, re.MULTILINE)) for fields in STEERING.findall(text))
    return [f"src/model/controls.f90: {n} constants steer the nonlinear solver, allowed are {MAX_STEERING_CONTROLS}"] if n > MAX_STEERING_CONTROLS else []


def main() -> int:
    """See the top of this file."""
    listed = read_modules()
    layers = list(read_layers())
    modules = {module.name: module for module in listed}
    text = depends_text(modules, in_order(modules, layers)[0])
    path = SOURCE / "depends.mk"
    if "--write" in sys.argv:
        path.write_text(text)
    troubles = check_layers(listed, layers) + check_documents(set(modules), ROOT) + check_search_paths(ROOT)
    troubles += check_unit_programs(listed, ROOT) + check_widths(ROOT) + check_words(ROOT)
    troubles += check_controls((SOURCE / "model" / "controls.f90").read_text())
    sources = {module.path: module.lines for module in listed}
    troubles += check_constants(sources) + check_public_names(sources) + check_glossary(sources, ROOT)
    if path.read_text() != text:
        troubles.append("src/depends.mk: stale; `make depends` generates it")
    troubles += [trouble for module in listed for trouble in module.troubles]
    print("\n".join(troubles or [f"lint: {len(listed)} modules, nothing wrong."]))
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
