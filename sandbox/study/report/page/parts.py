"""Parts of a page: sections with paragraphs, tables and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Table:
    """A table of texts.

    Attributes:
        caption: Caption of the table.
        head: Headings of the columns.
        rows: Texts of the cells; the first cell of each row is its heading.
        note: Note below the table.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    kind: str = field(default="table", init=False)


@dataclass(frozen=True)
class Picture:
    """A picture with a table of the same numbers.

    Attributes:
        svg: The picture.
        caption: Description of the picture.
        table: Table with the same numbers.
    """

    svg: str
    caption: str
    table: Table
    kind: str = field(default="picture", init=False)


@dataclass(frozen=True)
class Paragraph:
    """A paragraph.

    Attributes:
        text: Plain text.
        tone: Empty, `note` for a limitation of a result, or `lead` for the result itself.
    """

    text: str
    tone: str = ""
    kind: str = field(default="words", init=False)


Part = Table | Picture | Paragraph


@dataclass
class Section:
    """A section of the page.

    Attributes:
        id: Id of the anchor.
        title: Heading.
        parts: Parts in order.
    """

    id: str
    title: str
    parts: list[Part] = field(default_factory=list)

    def say(self, text: str, tone: str = "") -> None:
        """Adds a paragraph."""
        self.parts.append(Paragraph(text, tone))
