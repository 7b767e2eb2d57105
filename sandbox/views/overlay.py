"""Text over a picture: score and time, names of fingers, the caption, notices.

In films and windows, all texts are small translucent images (`Sticker`). They are cached, as most
stay the same from frame to frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from models.surface import Surface
from sandbox.session.messages import MOVE_APART, Snapshot
from sandbox.views import palette
from sandbox.views.cameras import Lens
from sandbox.views.palette import Colour
from tasks.score import Score, Status

REFERENCE_HEIGHT = 540
"""Height (px) of a picture to which the sizes below apply; they scale with the height."""
SMALLEST_SCALE = 0.85
"""Smallest scale at which text can be read."""
NARROW = 0.7
"""Text scales with the height of a picture, but with no more than this share of its width."""
MARGIN = 14
RING_CLEARANCE = 16
SMALL, NORMAL, LARGE = 13, 15, 24
"""Lengths (px) in a picture of the reference height: margin at the border, clearance around a
contact, and text sizes."""
BAR_GROUND: Colour = (0.27, 0.31, 0.34)
CODE_SHARE = 0.4
"""Side of a QR code, as a share of the picture's shorter side."""


@dataclass(frozen=True)
class Sticker:
    """An image to be laid over a picture.

    Attributes:
        image: RGBA.
        x: px from the picture's left edge to that of the image.
        y: px from the picture's top edge to that of the image.
    """

    image: Image.Image
    x: int
    y: int


@dataclass(frozen=True)
class OverlayTexts:
    """Texts in addition to the content of the snapshot.

    Attributes:
        caption: Player and task, at the bottom left. It has the colour of a warning, because it
            identifies the user of a film as simulated.
        help: Lines at the right, such as the keys of a window.
        banner: Large text in the middle at the top, such as `paused`.
        footer: Small lines at the bottom right, such as the time for a picture.
        link: Link shown as a QR code at the left; empty shows none.
        goal: The goal, in the panel; empty shows the hand's state there.
        hint: Instructions, line by line, above the notices.
    """

    caption: str = ""
    help: tuple[str, ...] = ()
    banner: str = ""
    footer: tuple[str, ...] = ()
    link: str = ""
    goal: str = ""
    hint: tuple[str, ...] = ()


def stickers(
    snapshot: Snapshot, lens: Lens, surface: Surface, drop: np.ndarray, words: OverlayTexts
) -> list[Sticker]:
    """Returns all texts of a picture.

    Args:
        snapshot: The drawn snapshot.
        lens: The camera of the picture.
        surface: The touch surface; a notice is added if its size is a guess.
        drop: (3,) m, shift from contacts to their drawn marks.
        words: Further texts.
    """
    width, height = lens.size
    scale = max(min(height, NARROW * width) / REFERENCE_HEIGHT, SMALLEST_SCALE)
    margin = round(MARGIN * scale)
    placed = _names(snapshot, lens, drop, scale)
    panel = _panel(*_status(snapshot, words.goal), scale)
    placed.append(Sticker(panel, margin, margin))
    bottom = height - margin
    notices = [snapshot.notice] if snapshot.notice else []
    if not surface.calibrated:
        notices.append("the size of the touch surface is a guess")
    told = [_label(n, palette.PANEL, palette.WARNING, NORMAL, scale) for n in notices]
    if words.caption:
        ink = palette.PANEL
        told.insert(0, _label(words.caption, palette.WARNING, ink, NORMAL, scale, solid=True))
    if words.footer:
        image = _lines(words.footer, scale)
        left = max(width - image.width - margin, 0)
        placed.append(Sticker(image, left, bottom - image.height))
        if any(2 * margin + line.width > left for line in told):
            # The space next to it is too narrow for text.
            bottom -= image.height + margin // 2
    if words.hint:
        told.append(_lines(words.hint, scale))
    for line in told:
        bottom -= line.height
        placed.append(Sticker(line, margin, bottom))
        bottom -= margin // 2
    if words.banner:
        image = _label(words.banner, palette.PANEL, palette.TEXT, LARGE, scale)
        left = max((width - image.width) // 2, panel.width + margin + margin // 2)
        placed.append(Sticker(image, left, margin))
    if words.help:
        image = _lines(words.help, scale)
        placed.append(Sticker(image, max(width - image.width - margin, 0), margin))
    if words.link:
        # At the left, away from the help and the hand.
        image = link_code(words.link, round(CODE_SHARE * min(height, width)))
        bottom -= image.height + margin // 2
        placed.append(Sticker(image, margin, bottom))
    return placed


@lru_cache(maxsize=2)
def link_code(link: str, side: int) -> Image.Image:
    """Returns a QR code of about `side` px, black on white, with a quiet zone; a module is a whole
    number of pixels."""
    import segno

    rows = np.array([list(row) for row in segno.make(link, error="m").matrix_iter(border=4)])
    image = Image.fromarray(np.where(rows > 0, 0, 255).astype(np.uint8)).convert("RGBA")
    factor = max(side // len(rows), 1)
    return image.resize((factor * len(rows), factor * len(rows)), Image.Resampling.NEAREST)


def paste(picture: Image.Image, placed: list[Sticker]) -> None:
    """Lays stickers over an RGB picture, in place."""
    for sticker in placed:
        picture.paste(sticker.image, (sticker.x, sticker.y), sticker.image)


def _status(snapshot: Snapshot, goal: str) -> tuple[str, str, str, float, Colour]:
    """Returns the panel's headline, sentence, goal or state of the hand, progress and colour."""
    score = snapshot.score
    headline, sentence, colour = _result(score, snapshot.time)
    hands = [
        f"hand {'solid' if hand.solid else 'ghost'}, {hand.phase}"
        if hand.phase
        else f"hand {'solid' if hand.solid else 'ghost'}"
        for hand in snapshot.hands
    ]
    return headline, sentence, goal or "; ".join(hands), score.progress, colour


def _result(score: Score, time: float) -> tuple[str, str, Colour]:
    if score.held:
        return f"{score.time:.1f} s  success", "goal reached and held", palette.HELD
    if score.status is Status.TIMEOUT:
        return f"{time:.1f} s  time is up", score.reason, palette.WARNING
    if score.status is not Status.RUNNING:
        return f"{time:.1f} s  ended", score.reason, palette.WARNING
    if score.final:
        return f"{time:.1f} s", "there: hold it", palette.REACHED
    return f"{time:.1f} s", score.reason, palette.GOAL


def _names(snapshot: Snapshot, lens: Lens, drop: np.ndarray, scale: float) -> list[Sticker]:
    """Returns a text for every contact: the finger's name, and the force of a grip in it.

    A finger inside an object has an instruction instead. A text is on the side that faces away from
    the other contacts, so that it does not cover a held object, which is between them.
    """
    placed: list[Sticker] = []
    contacts = [c for hand in snapshot.hands for c in hand.contacts]
    owners = [i for i, hand in enumerate(snapshot.hands) for _ in hand.contacts]
    if not contacts:
        return placed
    pixels, ahead = lens.project(np.concatenate([h.places for h in snapshot.hands]) + drop)
    shown = [i for i in range(len(contacts)) if ahead[i] and np.all(np.abs(pixels[i]) < 1e5)]
    if not shown:
        return placed
    middle = pixels[shown].mean(axis=0)
    for i in sorted(shown, key=lambda i: float(pixels[i, 1])):
        contact = contacts[i]
        colour = palette.finger_colour(contact.label, contact.state)
        name = palette.finger_name(contact.label, contact.state, contact.sure)
        hand, full = owners[i], snapshot.at_limit(owners[i], contact.label)
        if contact.label in snapshot.hands[hand].inside:
            name, colour, full = MOVE_APART, palette.WARNING, False
        elif full:
            name = f"{name}: full force"
        elif stored := snapshot.stored(hand, contact.label):
            name = f"{name} {stored:.0f} N"
        if full:
            # Dark on light at the limit, so that it is also visible without colours.
            image = _label(name, palette.TEXT, palette.PANEL, SMALL, scale, solid=True)
        else:
            image = _label(name, palette.PANEL, colour, SMALL, scale)
        away = pixels[i] - middle
        length = float(np.linalg.norm(away))
        away = away / length if length > 1.0 else np.array([0.0, 1.0])
        half = np.array([image.width / 2, image.height / 2])
        # Distance: half the text's extent in this direction, plus the ring.
        reach = RING_CLEARANCE * scale + float(np.abs(away) @ half)
        x, y = (round(v) for v in pixels[i] + away * reach - half)
        step = 1 if away[1] >= 0 else -1
        while clash := [s for s in placed if _overlap(s, image, x, y)]:
            if step > 0:
                y = max(s.y + s.image.height for s in clash) + 1
            else:
                y = min(s.y for s in clash) - image.height - 1
        placed.append(Sticker(image, x, y))
    return placed


def _overlap(other: Sticker, image: Image.Image, x: int, y: int) -> bool:
    return (
        x < other.x + other.image.width
        and other.x < x + image.width
        and y < other.y + other.image.height
        and other.y < y + image.height
    )


@lru_cache(maxsize=8)
def _font(size: int, scale: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    # Only whole sizes: letters of other sizes are spaced unevenly.
    return ImageFont.load_default(round(size * scale))


def _text_size(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont) -> tuple[int, int]:
    left, _, right, _ = font.getbbox(text)
    _, top, _, bottom = font.getbbox("Ágj")
    return int(np.ceil(right - min(left, 0))), int(np.ceil(bottom - min(top, 0)))


@lru_cache(maxsize=128)
def _label(
    text: str, ground: Colour, ink: Colour, size: int, scale: float, solid: bool = False
) -> Image.Image:
    """Returns a line of text on a rounded background."""
    font = _font(size, scale)
    width, height = _text_size(text, font)
    pad_x, pad_y = round(0.55 * size * scale), round(0.25 * size * scale)
    image = Image.new("RGBA", (width + 2 * pad_x, height + 2 * pad_y))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle(
        (0, 0, image.width - 1, image.height - 1),
        radius=round(0.45 * size * scale),
        fill=palette.bytes_of(ground, 1.0 if solid else 0.78),
    )
    draw.text((pad_x, pad_y), text, font=font, fill=palette.bytes_of(ink))
    return image


@lru_cache(maxsize=16)
def _lines(lines: tuple[str, ...], scale: float) -> Image.Image:
    """Returns lines of small text on one background; in two columns if all contain two spaces."""
    font = _font(SMALL, scale)
    split = [line.partition("  ") for line in lines]
    columns = len(lines) > 1 and all(gap for _, gap, _ in split)
    pad = round(10 * scale)
    keys = max(_text_size(key, font)[0] for key, _, _ in split) + pad if columns else 0
    sizes = [
        _text_size(said if columns else line, font)
        for line, (_, _, said) in zip(lines, split, strict=True)
    ]
    step = round(sizes[0][1] * 1.25)
    width = keys + max(w for w, _ in sizes) + 2 * pad
    image = Image.new("RGBA", (width, step * len(lines) + 2 * pad))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle(
        (0, 0, image.width - 1, image.height - 1),
        radius=pad,
        fill=palette.bytes_of(palette.PANEL, 0.78),
    )
    ink = palette.bytes_of(palette.TEXT)
    for i, (line, (key, _, said)) in enumerate(zip(lines, split, strict=True)):
        y = pad + i * step
        if columns:
            draw.text((pad, y), key, font=font, fill=palette.bytes_of(palette.GOAL))
        draw.text((pad + keys, y), said if columns else line, font=font, fill=ink)
    return image


@lru_cache(maxsize=4)
def _panel(
    headline: str, sentence: str, hand: str, progress: float, colour: Colour, scale: float
) -> Image.Image:
    """Returns the panel: time and result, progress bar, reason, and goal or state of the hand."""
    large, small = _font(LARGE, scale), _font(SMALL, scale)
    pad, gap = round(12 * scale), round(7 * scale)
    widths = [_text_size(headline, large)[0]] + [_text_size(t, small)[0] for t in (sentence, hand)]
    tall, short = _text_size(headline, large)[1], _text_size("x", small)[1]
    bar = max(round(6 * scale), 3)
    width = max(*widths, round(240 * scale)) + 2 * pad
    image = Image.new("RGBA", (width, 2 * pad + tall + bar + 2 * short + 3 * gap))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle(
        (0, 0, width - 1, image.height - 1),
        radius=pad,
        fill=palette.bytes_of(palette.PANEL, 0.78),
        outline=palette.bytes_of(colour) if colour != palette.GOAL else None,
        width=max(round(2 * scale), 1),
    )
    y = pad
    ink = palette.TEXT if colour == palette.GOAL else colour
    draw.text((pad, y), headline, font=large, fill=palette.bytes_of(ink))
    percent = f"{100 * progress:.0f} %"
    draw.text(
        (width - pad - _text_size(percent, small)[0], y + tall - short),
        percent,
        font=small,
        fill=palette.bytes_of(palette.FAINT),
    )
    y += tall + gap
    inner = width - 2 * pad
    draw.rectangle((pad, y, pad + inner, y + bar), fill=palette.bytes_of(BAR_GROUND))
    if progress > 0:
        draw.rectangle(
            (pad, y, pad + round(inner * min(progress, 1.0)), y + bar),
            fill=palette.bytes_of(colour),
        )
    y += bar + gap
    draw.text((pad, y), sentence, font=small, fill=palette.bytes_of(palette.TEXT))
    draw.text((pad, y + short + gap // 2), hand, font=small, fill=palette.bytes_of(palette.FAINT))
    return image
