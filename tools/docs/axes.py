"""Draws the axes of the world and of the touch surface: a picture of docs/write-a-task.md.

    python -m tools.docs.axes          # writes docs/pictures/axes.svg

The picture is plain SVG with its own background, so that it is readable on light and dark pages.
"""

from __future__ import annotations

import sys

from models.surface import Surface
from tools.docs.how_it_works import (
    FAINT,
    FILL,
    FONT,
    GROUND,
    HEAD,
    INK,
    LINE,
    PICTURE,
    arrow,
    text,
)

AXES = PICTURE.with_name("axes.svg")
SCALE = 1900.0
"""Scale (px per metre)."""
MIDDLE = (250.0, 205.0)
"""Position (px) of the middle of the table's top."""
REACH = 0.055
"""Length (m) of an axis."""
WIDTH, HEIGHT = 760, 400
SIDE = 590.0
"""Position (px) of the middle of the view from the side."""


def drawing() -> str:
    """The picture as SVG: a view from above, with both frames, and a view from the side."""
    surface = Surface().centred_at((0.0, 0.0, 0.0))
    (wide, high), (cx, cy) = surface.size * SCALE, MIDDLE
    left, top, reach = cx - wide / 2, cy - high / 2, REACH * SCALE
    mm = " x ".join(f"{1000 * side:.0f}" for side in surface.size)
    centred = "text-anchor='middle'"
    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' "
        f"width='{WIDTH}' height='{HEIGHT}' role='img' {FONT}>",
        "<title>Axes of the world and of the touch surface</title>",
        HEAD,
        f"<rect width='{WIDTH}' height='{HEIGHT}' rx='14' fill='{GROUND}'/>",
        text(cx, 34, "from above", 16, FAINT, centred),
        f"<rect x='{left:.1f}' y='{top:.1f}' width='{wide:.1f}' height='{high:.1f}' "
        f"fill='{FILL}' stroke='{INK}' rx='6'/>",
        arrow((cx, cy), (cx + reach, cy)),
        arrow((cx, cy), (cx, cy - reach)),
        f"<circle cx='{cx}' cy='{cy}' r='4' fill='{LINE}'/>",
        text(cx + reach + 14, cy + 5, "x", 17, LINE),
        text(cx, cy - reach - 8, "y", 17, LINE, centred),
        text(cx, cy + 24, "world (0, 0, 0)", 14, LINE, centred),
        *_corner(left, top),
        text(cx, top + high - 12, f"touch surface, ipad2: {mm} mm", 14, FAINT, centred),
        text(cx, HEIGHT - 22, "the person sits here", 15, INK, centred),
        *_from_the_side(),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _corner(left: float, top: float) -> list[str]:
    """The surface's own frame, in its top left corner."""
    x, y = left + 12, top + 12
    return [
        arrow((x, y), (x + 52, y)),
        arrow((x, y), (x, y + 52)),
        text(x + 64, y + 6, "x", 15, LINE),
        text(x, y + 72, "y", 15, LINE, "text-anchor='middle'"),
        text(x + 14, y + 30, "surface (0, 0)", 14, LINE),
    ]


def _from_the_side() -> list[str]:
    """Table, surface above it, and the axes, seen from the right."""
    x, table, reach = SIDE, 270.0, REACH * SCALE
    centred = "text-anchor='middle'"
    level = table - 30
    return [
        text(x, 34, "from the right", 16, FAINT, centred),
        f"<path d='M {x - 130} {table} H {x + 150}' stroke='{INK}' stroke-width='3'/>",
        text(x + 150, table + 22, "table's top", 14, FAINT, "text-anchor='end'"),
        f"<path d='M {x - 100} {level} H {x + 100}' stroke='{INK}' stroke-dasharray='6 4'/>",
        text(x + 10, level - 24, "touch surface,", 13, FAINT),
        text(x + 10, level - 8, "touch_height above", 13, FAINT),
        arrow((x, table), (x, table - reach)),
        arrow((x, table), (x + reach, table)),
        text(x, table - reach - 8, "z", 17, LINE, centred),
        text(x + reach + 14, table - 6, "y", 17, LINE),
        f"<circle cx='{x}' cy='{table}' r='4' fill='{LINE}'/>",
        text(x - 130, table + 22, "the person", 14, INK),
    ]


def main() -> int:
    """Writes the picture."""
    AXES.write_text(drawing(), encoding="utf-8")
    print(AXES)
    return 0


if __name__ == "__main__":
    sys.exit(main())
