"""Writes `docs/design-file.md`, every key of a design file, from the fields that the program reads.

python -m tools.docs.design_fields
"""

from __future__ import annotations

from pathlib import Path

from sandbox.study.design.fields import FIELDS, Field
from tools.docs.markdown_table import markdown_table

PAGE = Path(__file__).resolve().parents[2] / "docs/design-file.md"
HEADINGS = {
    "": "The top of the file",
    "items": "Questions: `[[demographics]]` and `[[questionnaires.items]]`",
    "scales": "Scores: `[[questionnaires.scales]]`",
    "factors": "`[[factors]]`",
    "tasks": "`[[tasks]]`",
    "instructions": "`[[instructions]]`",
    "questionnaires": "`[[questionnaires]]`",
    "exclusions": "`[[exclusions]]`",
}
TOP = """# Every key of a design file

*Printed by `python -m tools.docs.design_fields` from the fields that designs may have.*
[studies.md](studies.md) explains studies. An entry without a default is required, unless the
column *meaning* says what happens without it.

`[settings]` and the levels of factors have `task`, `surface`, `device` and the other settings of a
trial: [studies.md](studies.md#the-design). `[words.nl]` has words of the page:
[page.md](page.md#words-of-a-study). Measures for `[[exclusions]]` and `[analysis]` are in
[measures.md](measures.md).
"""


def page() -> str:
    """The text of the page."""
    parts = [TOP]
    for table, fields in FIELDS.items():
        rows = [_row(field) for field in fields.values()]
        parts.append(f"## {HEADINGS.get(table, f'`[{table}]`')}\n")
        parts.append(markdown_table(["key", "is", "default", "from, to", "means"], rows) + "\n")
        for field in fields.values():
            if field.options:
                parts.append(f"`{field.name}` is one of these:\n")
                words = [[f"`{word}`", means] for word, means in field.options.items()]
                parts.append(markdown_table(["word", "means"], words) + "\n")
    return "\n".join(parts)


def _row(field: Field) -> list[str]:
    return [
        f"`{field.name}`",
        field.kind,
        _default(field),
        field.range + (f" {field.unit}" if field.unit else ""),
        field.means,
    ]


def _default(field: Field) -> str:
    value = field.default
    if value is None:
        return ""
    if value in ("", (), {}):
        return "none"
    if isinstance(value, tuple):
        return ", ".join(f"`{each}`" for each in value)
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
