"""Draws how touches move the simulated hand: the README's picture.

    python -m tools.docs.how_it_works          # writes docs/pictures/how-it-works.svg

The picture is plain SVG with its own background, so that it is readable on light and dark pages.
"""

from __future__ import annotations

import argparse
import sys
from html import escape
from pathlib import Path

PICTURE = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "how-it-works.svg"

STEPS = (
    ("1", "Contacts", ("touches, followed through", "drop-outs and new ids")),
    ("2", "Labels", ("which finger is which:", "a belief over all namings")),
    ("3", "Pose", ("quadratics give the whole", "hand: 48 degrees of freedom")),
    ("4", "Correction", ("every fingertip is moved", "to its touch")),
    ("5", "Arrival", ("a ghost until it is down", "and clear of things")),
    ("6", "Physics", ("servos with limited force", "follow, in MuJoCo")),
)
"""Number, name and two lines of each step, in the order of the data."""

ENDS = (
    ("IN", "tablet, TUIO, touch screen, mouse,", "a recording, the simulated user"),
    ("OUT", "what you see, the score,", "a recording that replays to the bit"),
)
"""Texts for the input of the first step and for the output of the last step."""

WIDTH, HEIGHT = 960, 336
BOX = (270, 84)
"""Width and height (px) of a step's box."""
ROWS = (86, 214)
"""Upper edges (px) of the two rows of boxes."""
GAP = 40
"""Distance (px) between boxes."""
INK, GROUND, FILL, LINE, FAINT = "#17212b", "#f7f9fb", "#ffffff", "#1f6fb5", "#51606e"
HEAD = (
    "<defs><marker id='h' viewBox='0 0 10 10' refX='9' refY='5' markerWidth='7' "
    f"markerHeight='7' orient='auto'><path d='M 0 0 L 10 5 L 0 10 z' fill='{LINE}'/></marker>"
    "</defs>"
)
"""Definition of the head of an arrow."""
FONT = "font-family='DejaVu Sans, Verdana, sans-serif'"


def text(x: float, y: float, words: str, size: int, colour: str = INK, more: str = "") -> str:
    """A line of text; `more` holds further attributes."""
    return f"<text x='{x}' y='{y}' font-size='{size}' fill='{colour}' {more}>{escape(words)}</text>"


def arrow(*points: tuple[float, float]) -> str:
    """A line through points (px) with a head at its end."""
    path = " L ".join(f"{x} {y}" for x, y in points)
    return (
        f"<path d='M {path}' fill='none' stroke='{LINE}' stroke-width='2.5' marker-end='url(#h)'/>"
    )


def drawing() -> str:
    """The picture as SVG."""
    wide, high = BOX
    left = (WIDTH - 3 * wide - 2 * GAP) / 2
    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' "
        f"width='{WIDTH}' height='{HEIGHT}' role='img' {FONT}>",
        "<title>How touches move the simulated hand, in six steps</title>",
        HEAD,
        f"<rect width='{WIDTH}' height='{HEIGHT}' rx='14' fill='{GROUND}'/>",
    ]
    for index, (number, name, lines) in enumerate(STEPS):
        row, column = divmod(index, 3)
        x, y = left + column * (wide + GAP), ROWS[row]
        parts.append(
            f"<rect x='{x}' y='{y}' width='{wide}' height='{high}' rx='10' fill='{FILL}' "
            f"stroke='{LINE}' stroke-width='1.5'/>"
        )
        parts.append(f"<circle cx='{x + 26}' cy='{y + 27}' r='14' fill='{LINE}'/>")
        centred = "text-anchor='middle' font-weight='bold'"
        parts.append(text(x + 26, y + 32, number, 15, "#ffffff", centred))
        parts.append(text(x + 50, y + 33, name, 18, INK, "font-weight='bold'"))
        parts += [text(x + 50, y + 55 + 18 * i, line, 14, FAINT) for i, line in enumerate(lines)]
        if column < 2:
            parts.append(arrow((x + wide + 4, y + high / 2), (x + wide + GAP - 4, y + high / 2)))
    turn = (ROWS[0] + high + ROWS[1]) / 2
    last, first = left + 2.5 * wide + 2 * GAP, left + wide / 2
    parts.append(
        arrow((last, ROWS[0] + high + 4), (last, turn), (first, turn), (first, ROWS[1] - 4))
    )
    parts.append(arrow((first, 54), (first, ROWS[0] - 4)))
    begin, end = (" ".join(lines) for _, *lines in ENDS)
    parts.append(text(left, 40, begin, 14))
    parts.append(text(left + 3 * wide + 2 * GAP, 318, end, 14, INK, "text-anchor='end'"))
    return "\n".join([*parts, "</svg>"]) + "\n"


def main() -> int:
    """Writes the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=PICTURE, help="file of the picture")
    options = parser.parse_args()
    options.out.write_text(drawing(), encoding="utf-8")
    print(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
