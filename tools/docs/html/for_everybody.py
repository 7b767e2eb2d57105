"""Makes the body of a page usable with a keyboard, with screen readers and on phones.

Sphinx does not make wide blocks reachable by keyboard, does not name tables, and does not allow
line breaks in long words of code.
"""

from __future__ import annotations

import re
from collections import Counter
from html import escape, unescape

PROSE = 60
"""Number of characters from which on the text of a cell counts as prose, which needs a wide
cell."""
LONG = 20
"""Number of characters of a word of code that fit into a cell on a phone."""

_TABLE = re.compile(r'<div class="table-wrapper')
_HEADING = re.compile(r"<h[1-6][^>]*>(.*?)</h[1-6]>", re.S)
_LEAD = re.compile(r"<p>((?:(?!</?p\b).)*):</p>\s*$", re.S)
_TAG = re.compile(r"<[^>]+>")
_CELL = re.compile(r"<td([^>]*)>(.*?)</td>", re.S)
_WORD = re.compile(r'(<span class="pre">)([^<]+)(</span>)')
_BREAK = re.compile(r"(?<=[/|=,:])(?=\w)")
_FINE_BREAK = re.compile(r"(?<=_)(?=\w)|(?<=[a-z])(?=[A-Z])")


def for_everybody(body: str) -> str:
    """Changes the body of a page as follows.

    - Wide blocks and tables are reachable by keyboard, and each table has its own name.
    - Cells of prose are marked.
    - Long words of code in cells may be broken between their parts, such as
      `hand_sandbox/BoxToGoal-v1` after the slash. Parts that are still long may be broken after `_`
      and before capital letters.

    Args:
        body: HTML as Sphinx writes it.
    """
    body = body.replace("<pre>", '<pre tabindex="0">')
    return _CELL.sub(_cell, _named(body))


def _named(body: str) -> str:
    """The body with a name for each table: the line above it that ends with a colon, or its
    heading."""
    before, *rest = _TABLE.split(body)
    names, heading = [], ""
    for part in [before, *rest][:-1]:
        heading = (_HEADING.findall(part) or [heading])[-1]
        lead = _LEAD.search(part)
        names.append(_plain(lead[1] if lead else heading))
    times, numbers = Counter(names), Counter[str]()
    for name, part in zip(names, rest, strict=True):
        numbers[name] += 1
        which = f", {numbers[name]} of {times[name]}" if times[name] > 1 else ""
        label = escape(f"Table: {name}{which}")
        before += f'<div tabindex="0" role="group" aria-label="{label}" class="table-wrapper{part}'
    return before


def _plain(html: str) -> str:
    return " ".join(unescape(_TAG.sub("", html)).replace("¶", "").split())


def _cell(cell: re.Match[str]) -> str:
    attributes, content = cell[1], cell[2]
    if "class=" not in attributes and len(unescape(_TAG.sub("", content))) >= PROSE:
        attributes += ' class="prose"'
    return f"<td{attributes}>{_WORD.sub(_word, content)}</td>"


def _word(word: re.Match[str]) -> str:
    text = word[2]
    if len(unescape(text)) <= LONG:
        return word[0]
    parts = [
        _FINE_BREAK.sub("<wbr>", part) if len(unescape(part)) > LONG else part
        for part in _BREAK.split(text)
    ]
    return word[1] + "<wbr>".join(parts) + word[3]
