"""Makes the documentation site light: no white space between tags, no end tags and comments that HTML does without, no styles, fonts and
maps of scripts that no page needs, no search in other languages, no anchors that no link leads to.

    python -m verify.tools.site_weight build/site

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from urllib.parse import unquote

KEPT = re.compile(r"(<pre\b.*?</pre>|<script\b.*?</script>|<style\b.*?</style>)", re.DOTALL)
#: for debuggers of scripts; browsers take fonts as .woff2; languages other than English; icons that no page shows
NEEDLESS = ("*.map", "*.ttf", "lunr/**/*.js", "fa-brands-*", "fa-regular-*", "fa-v4compatibility*")
ICONS = re.compile(r'<link href="[^"]*/(?:brands|regular|v4-font-face|v4-shims)\.min\.css" rel="stylesheet">')  #: the styles of these icons
OPTIONAL = re.compile(r"<!--.*?-->|</(?:li|td|th|tr|thead|tbody)>", re.DOTALL)  #: comments; the HTML standard lets lists and tables go without these end tags
ANCHOR = re.compile(r'<span class="anchor" id="([^"]*)"></span>\n?')
TARGET = re.compile(r"""href=["'][^"'#]*#([^"']+)["']""")
STYLE = re.compile(r'href="[^"]*?([\w.-]+\.css)"')


def slim(page: str) -> str:
    """The page with one blank or line break in place of several, but in preformatted text and scripts."""
    parts = KEPT.split(page)
    return "".join(part if i % 2 else re.sub(r"\s*\n\s*", "\n", re.sub(r"[ \t]+", " ", ICONS.sub("", OPTIONAL.sub("", part)))) for i, part in enumerate(parts))


def lighten(site: Path) -> None:
    """All pages of a site. A link of a page to its own places needs no name of the page, a place without links no anchor."""
    styles = set()
    targets = set()
    for page in site.rglob("*.html"):
        text = slim(page.read_text())
        styles |= set(STYLE.findall(text))
        targets |= {unquote(target) for target in TARGET.findall(text)}
        page.write_text(re.sub(rf"""href=(["'])\.\./{page.parent.name}/{re.escape(page.name)}#""", r"href=\1#", text))
    for page in (site / "api").rglob("*.html"):
        page.write_text(ANCHOR.sub(lambda anchor: anchor[0] if unquote(anchor[1]) in targets else "", page.read_text()))
    for style in (site / "api").rglob("*.css"):
        if style.name not in styles:
            style.unlink()
    for pattern in NEEDLESS:
        for file in site.rglob(pattern):
            file.unlink()


if __name__ == "__main__":
    lighten(Path(sys.argv[1]))
