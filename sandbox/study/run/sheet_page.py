"""The sheets of a participant's sessions as one HTML file to print, without scripts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape

from sandbox.study.design.design import Item
from sandbox.study.run.answers import question
from sandbox.study.run.sheet import SessionSheet, SheetPart

STYLE = """
body { margin: 2rem auto; max-width: 44rem; padding: 0 1rem; font: 11pt/1.45 system-ui, sans-serif;
  color: #1c2430; background: #fff; }
h1 { font-size: 1.3rem; }
h2 { font-size: 1rem; margin: 1.4rem 0 0.3rem; border-top: 1px solid #c8ced6; padding-top: 0.6rem; }
section { break-inside: avoid; }
p { margin: 0.3rem 0; white-space: pre-line; }
ul { margin: 0.3rem 0; padding-inline-start: 1.4rem; }
li { margin: 0.5rem 0; }
.read { border-inline-start: 3px solid #1f5fa8; padding-inline-start: 0.8rem; }
small { color: #55606e; }
@media print { body { margin: 0; max-width: none; } h1 + section h2 { border-top: 0; } }
"""


def sheet_page(sheets: Sequence[SessionSheet]) -> str:
    """Returns the HTML text of sheets, in the order of the sessions."""
    first = sheets[0]
    body = "\n".join(line for sheet in sheets for line in _sheet(sheet))
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(first.title)}</title>\n<style>{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )


def _sheet(sheet: SessionSheet) -> Iterator[str]:
    yield f"<h1>{escape(sheet.title)}</h1>"
    for number, part in enumerate(sheet.parts, 1):
        yield f"<section>\n<h2>{number}. {escape(part.heading)}</h2>"
        yield from _read(sheet, part)
        yield "</section>"


def _read(sheet: SessionSheet, part: SheetPart) -> Iterator[str]:
    """What the participant reads, in their language."""
    items = part.form.items if part.form else ()
    if not part.texts and not items:
        return
    yield f'<div class="read" lang="{escape(sheet.language)}" dir="auto">'
    yield from (f'<p dir="auto">{escape(text.strip())}</p>' for text in part.texts)
    if items:
        yield "<ul>"
        yield from _items(sheet, items)
        yield "</ul>"
    yield "</div>"


def _items(sheet: SessionSheet, items: Iterable[Item]) -> Iterator[str]:
    for item in items:
        optional = f" <small>{escape(sheet.words['optional'])}</small>" if item.optional else ""
        yield f'<li dir="auto">{escape(question(item, sheet.language))}{optional}</li>'
