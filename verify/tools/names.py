"""Names and words of the repository: private words that the glossary has replaced, constants with two values, public names without a user.

`python3 -m verify.tools.lint` calls these checks.
"""

import re
from collections.abc import Iterator
from pathlib import Path

#: Retired words, and what stands in their place. A word counts wherever letters do not continue it: as_told and TEXT_ROOM count, too.
RETIRED_WORDS = {
    r"rooms?|house": "module, workspace, capacity",
    r"floors": "layers",
    r"told|tells?|telling": "report, say, list, print",
    r"ask|asks|asked|asking": "request, require",
    r"wants?": "need, expected",
    r"settles?|settled|settling": "contact subproblem; unchanged, converged",
    r"meetings?": "local equilibrium; touching bodies",
    r"courses?": "globalization, path",
    r"carry_\w+|carried_\w+|\w+_carried|carrying_bodies": "proximal step",
    r"travels?|travell(?:ed|ing)": "approach, sliding distance",
    r"sprung": "Woodbury interface",
    r"foresees?|foreseen|unforeseen|foresight": "predicted, linearized",
    r"stepper": "increment control",
    r"forensics": "active-set history",
    r"bonds?_\w+|\w+_bonds?": "MPC",
    r"lone|twins?": "uncoupled, unattached; duplicate",
    r"followers": "mid-side constraints",
    r"led|cornered": "prescribed",
    r"lawful|patience|astray": "residual at gap, limit, unsolved",
    r"brakes?": "damping force",
    r"listeners?|deaf|journal": "log sink, logger",
    r"nobody": "no one; or name the subject",
    r"chatters?|chattering": "active-set cycling, oscillation",
    r"(?:let|lets|letting) go": "release",
    r"(?:go|goes|going) on": "continue",
    r"(?:that|which|it) (?:is|are) none": "invalid; does not exist",
    r"(?-i:(?:MOST|LEAST|FEW|ENOUGH)_\w+)": "MAX_, MIN_, TOL_ and the quantity",
    r"way_type|choose_way|put_down|meet_law|link_type|hold_slave|press_slave|rub_by_user|rub_softly": "see the glossary",
    r"cover_type|cut_rates|row_rates|bear_elements|give_back|heed_signals|arm_drives|take_turn|mend_store": "see the glossary",
}
#: Where a retired word may stand: (end of the path, pattern of the line).
EXCEPTIONS = (
    (r"doc/developer/style\.md", r"The solver asks the elements|a number of threads that is none"),  # examples of what to avoid
    (r"CHANGELOG\.md", r"\(was `|replaces `"),  # renamings that callers have to follow
    (r"verify/tools/(?:names\.py|test_names\.py)", r""),
    (r"", r"lever arm|in the course of|of course"),
    (r"verify/library/test_library\.py", r"place_of_call"),
)
ENDINGS = {".f90", ".c", ".h", ".inc", ".py", ".md", ".js", ".css", ".toml", ".yml", ".in", ".1", ".fish", ".bash"}
FOLDERS = ("src", "doc", "verify", "python", "share", ".ci")
#: Pages that are generated, and the record of decisions, which keeps the words of its day.
HISTORY = ("doc/verification/", "doc/developer/decisions/")
#: Files whose public procedures programs of users call.
INTERFACES = {"library", "c_interface", "main"}

WORD = re.compile(rf"(?<![A-Za-z])(?=\w)(?:{'|'.join(rf'(?P<w{i}>{words})' for i, words in enumerate(RETIRED_WORDS))})(?![A-Za-z])", re.I)
PARAMETER = re.compile(r"^(?P<head>[^'\"]*\bparameter\b[^'\"]*?)::\s*(?P<list>.+)$", re.I)
NUMBER = re.compile(r"^[-+]?[\d.]+(?:e[-+]?\d+)?(?:_\w+)?$", re.I)
PUBLIC = re.compile(r"^public\s*(?:::)?\s*(?P<list>.+)$", re.I)


def check_words(root: Path) -> list[str]:
    """Lines of source, documents and tests with a retired word."""
    files = [path for folder in FOLDERS for path in sorted((root / folder).rglob("*")) if path.suffix in ENDINGS or path.parent.name in ("share", ".ci")]
    files += [root / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "Makefile")]
    troubles = []
    for path in files:
        name = path.relative_to(root).as_posix()
        if not path.is_file() or name.startswith(HISTORY):
            continue
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            if (found := WORD.search(line)) and not any(re.search(rf"{where}$", name) and re.search(what, line) for where, what in EXCEPTIONS):
                better = list(RETIRED_WORDS.values())[int(str(found.lastgroup)[1:])]
                troubles.append(f"{name}:{number}: the word `{found[0]}` is retired; standard terms: {better}")
    return troubles


def split_list(text: str) -> list[str]:
    """The items of a list that is separated by commas outside of brackets and strings."""
    items, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter == "," and not depth:
            items.append("")
            continue
        else:
            depth += (letter in "([") - (letter in ")]")
        items[-1] += letter
    return [item.strip() for item in items]


def code_lines(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Statements with their strings, without comments; continuation lines are joined."""
    start, text = 0, ""
    for number, line in enumerate(lines, 1):
        part = re.sub(r"('[^']*'|\"[^\"]*\")|!.*", lambda match: match[1] or "", line).strip()
        if not part:
            continue
        start = start or number
        text += part.lstrip("&").removesuffix("&")
        if not part.endswith("&"):
            yield start, text.strip()
            start, text = 0, ""


def check_constants(sources: dict[str, list[str]]) -> list[str]:
    """Constants with one name in two modules: numbers, and anything in the head of a module. Procedures may share names of lists.

    `sources`: the lines of each file by its path.
    """
    first: dict[str, tuple[str, str]] = {}
    troubles = []
    for path, lines in sources.items():
        is_head = True
        for number, text in code_lines(lines):
            is_head = is_head and text.lower() != "contains"
            if not (found := PARAMETER.match(text)):
                continue
            for item in split_list(found["list"]):
                name, _, value = (part.strip() for part in item.partition("="))
                name = name.partition("(")[0].strip().upper()
                if len(name) == 1 or not (is_head or NUMBER.match(value)):
                    continue
                place, other = first.setdefault(name, (path, value))
                if place != path:
                    how = "with another value" if other != value else "too; use it from there"
                    troubles.append(f"{path}:{number}: the constant {name} stands in {place} {how}")
    return troubles


def check_public_names(sources: dict[str, list[str]]) -> list[str]:
    """Public names that no code of src uses: neither another module nor their own."""
    code = {path: "\n".join(re.sub(r"'[^']*'|\"[^\"]*\"", "''", text) for _, text in code_lines(lines)) for path, lines in sources.items()}
    users: dict[str, set[str]] = {}
    for path, text in code.items():
        for word in set(re.findall(r"\w+", text.lower())):
            users.setdefault(word, set()).add(path)
    troubles = []
    for path, text in code.items():
        if Path(path).stem in INTERFACES:
            continue
        names = {name.strip().lower() for line in text.splitlines() if (found := PUBLIC.match(line)) for name in found["list"].split(",")}
        for name in sorted(names):
            if not re.fullmatch(r"\w+", name) or users.get(name, set()) - {path}:
                continue
            declaration = rf"^(?:public\b|end\b|type\s*(?:,|::)|(?:[\w ]+\s)?(?:subroutine|function)\s+{name}\b|[^'\"]*parameter[^'\"]*::\s*{name}\s*=)"
            uses = [line for line in text.splitlines() if re.search(rf"\b{name}\b", line, re.I) and not re.match(declaration, line, re.I)]
            if not uses:
                troubles.append(f"{path}: nothing in src uses the public name {name}; tests alone do not count")
    return troubles


def check_glossary(sources: dict[str, list[str]], root: Path) -> list[str]:
    """The glossary's rows name modules and procedures of src that exist there."""
    page = "doc/developer/glossary.md"
    code = {Path(path).stem: "\n".join(lines) for path, lines in sources.items()}
    troubles = []
    for number, line in enumerate((root / page).read_text().splitlines(), 1):
        cells = line.split("|")
        if not line.startswith("| ") or len(cells) < 6:
            continue
        for module, procedures in re.findall(r"`(\w+)`: ((?:`\w+`(?:, )?)+)", cells[-3]):
            if module not in code:
                troubles.append(f"{page}:{number}: there is no module {module}")
                continue
            troubles += [f"{page}:{number}: {module} has no procedure {name}" for name in re.findall(r"\w+", procedures)
                         if not re.search(rf"^\s*(?:[\w() ]+\s)?(?:subroutine|function) {name}\b", code[module], re.M)]
    return troubles
