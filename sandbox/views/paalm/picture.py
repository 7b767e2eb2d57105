"""Pictures as in the paper: a line drawing of the device's data beside PAALM's hand and angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, ImageDraw, ImageFont

from encoders.paalm.calibration import measure, pointing
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.joint_angles import PaalmFrame, PaalmHand
from models.arithmetic import Array
from models.frames import FINGERS, HandFrame, TrackedHand
from models.hand import Hand
from models.kinematics import Kinematics
from models.person import Person
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.devices.device import Closeable
from sandbox.session.messages import HandView, Snapshot
from sandbox.views import palette
from sandbox.views.cameras import Lens
from sandbox.views.graphics import GLContext
from sandbox.views.palette import Colour
from sandbox.views.renderer import Renderer

GROUND: Colour = (0.125, 0.145, 0.165)
_FINE = 2
"""Factor of oversampling, because Pillow draws lines without smooth edges."""
_DIM = 0.5
"""Opacity of a finger that the device does not see."""
_NORMAL_LENGTH = 0.06
"""Length (m) of the arrow along the palm's normal."""
_SPHERES = (0.02, 0.08)
"""Smallest and largest drawn radius (m) of the palm's sphere; for a flat hand it is infinite."""
_VIEW_HEIGHT = 0.30
"""Height (m) of the visible part of the scene."""


@dataclass(frozen=True)
class FingerVector:
    """A finger as the device reports it.

    Attributes:
        base: (3,) m, base of the finger.
        tip: (3,) m, tip of the finger.
        seen: True if the device reports the finger now.
    """

    base: Array
    tip: Array
    seen: bool


@dataclass(frozen=True)
class HandPicture:
    """The drawn parts of a hand, in the device's frame.

    Attributes:
        side: `right` or `left`.
        palm: (3,) m, centre of the palm.
        normal: (3,) unit vector out of the palm.
        fingers: Fingers by label.
        sphere: Radius (m) of the palm's sphere; None if the fingers do not determine it.
        told: True if the device reported the radius; False if it is computed.
    """

    side: str
    palm: Array
    normal: Array
    fingers: dict[int, FingerVector]
    sphere: float | None
    told: bool


class HandMemory:
    """Collects the drawn parts of hands.

    A lost finger keeps its last position relative to the palm, and moves with it.
    """

    def __init__(self) -> None:
        self._last: dict[tuple[str, int], tuple[Array, Array]] = {}

    def update(self, frame: HandFrame, hands: Mapping[str, PaalmHand]) -> list[HandPicture]:
        """Returns the drawn parts of a frame's hands, from PAALM's result."""
        return [self._hand(frame, side, hand) for side, hand in hands.items()]

    def _hand(self, frame: HandFrame, side: str, hand: PaalmHand) -> HandPicture:
        own = _same(frame, hand)
        origin, turn = np.array(hand.palm.origin), hand.palm.rotation
        seen: set[int] = set()
        if own is not None and hand.seen:
            of = {id_: FINGERS.index(f) for f, id_ in hand.ids.items() if id_ is not None}
            for finger in own.fingers:
                if finger.id in of:
                    tip = np.array(finger.end)
                    base = tip - measure(finger) * np.array(pointing(finger))
                    label = of[finger.id]
                    self._last[side, label] = ((base - origin) @ turn, (tip - origin) @ turn)
                    seen.add(label)
        fingers = {
            f: FingerVector(origin + turn @ base, origin + turn @ tip, f in seen)
            for (s, f), (base, tip) in self._last.items()
            if s == side
        }
        normal = -np.array(hand.palm.dorsal)
        told = own.sphere_radius if own is not None else None
        radius = told or ball_radius(origin, normal, [v.tip for v in fingers.values()])
        return HandPicture(side, origin, normal, fingers, radius, told is not None)


def ball_radius(palm: Array, normal: Array, tips: list[Array]) -> float | None:
    """Returns the radius (m) of the sphere in the hand; None if fewer than three tips determine it.

    The sphere touches the palm at its centre, and its own centre is on the palm's normal. It passes
    through a fingertip p if its radius is r = |p - palm|^2 / (2 (p - palm) . normal). The result
    is the median over the fingertips.
    """
    radii = []
    for tip in tips:
        way = tip - palm
        along = float(way @ normal)
        if along > 1e-3:
            radii.append(float(way @ way) / (2.0 * along))
    if len(radii) < 3:
        return None
    return float(np.clip(np.median(radii), *_SPHERES))


def diagram(
    hands: list[HandPicture], size: tuple[int, int], azimuth: float, elevation: float
) -> Image.Image:
    """Returns the RGB line drawing, without perspective, from the direction of a camera.

    Args:
        hands: The hands to draw.
        size: Width and height, px.
        azimuth: Azimuth (deg) of the camera, as in MuJoCo.
        elevation: Elevation (deg) of the camera; below 0, it looks down.
    """
    width, height = size[0] * _FINE, size[1] * _FINE
    image = Image.new("RGB", (width, height), palette.bytes_of(GROUND)[:3])
    if hands:
        # Centre the picture below the palm, so that the sphere is in it.
        middle = np.mean([h.palm + 0.03 * h.normal for h in hands], axis=0)
        pen = _Pen(image, middle, azimuth, elevation, len(hands))
        for hand in hands:
            _sphere(pen, hand)
        for hand in hands:
            _vectors(pen, hand)
        pen.write()
    return image.resize(size, Image.Resampling.LANCZOS)


class _Pen:
    """Draws on an image; positions are in m in the device's frame."""

    def __init__(
        self, image: Image.Image, middle: Array, azimuth: float, elevation: float, hands: int
    ) -> None:
        a, e = np.deg2rad([azimuth, elevation])
        forward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([np.sin(a), -np.cos(a), 0.0])
        self._axes = np.stack([right, np.cross(right, forward)])
        self._middle, self._size = middle, np.array(image.size)
        high = _VIEW_HEIGHT if hands == 1 else 1.4 * _VIEW_HEIGHT
        self.scale = min(image.size[1] / high, image.size[0] / high)
        self.draw = ImageDraw.Draw(image)
        self.unit = image.size[1] / 540.0
        self.font = ImageFont.load_default(round(15 * self.unit))
        self._words: list[tuple[float, float, str, Colour]] = []

    def place(self, point: ArrayLike) -> tuple[float, float]:
        x, y = self._axes @ (np.asarray(point) - self._middle)
        w, h = self._size
        return float(w / 2 + x * self.scale), float(h * 0.52 - y * self.scale)

    def arrow(self, start: Array, end: Array, colour: Colour, thick: float) -> None:
        a, b = np.array(self.place(start)), np.array(self.place(end))
        ink = palette.bytes_of(colour)[:3]
        line = b - a
        length = float(np.linalg.norm(line))
        if length < 1.0:
            return
        along = line / length
        head = min(4.0 * thick * self.unit, 0.5 * length)
        across = np.array([-along[1], along[0]]) * 0.5 * head
        neck = b - head * along
        self.draw.line([tuple(a), tuple(neck)], fill=ink, width=max(1, round(thick * self.unit)))
        self.draw.polygon([tuple(b), tuple(neck + across), tuple(neck - across)], fill=ink)

    def dot(self, point: Array, colour: Colour, radius: float) -> None:
        x, y = self.place(point)
        r = radius * self.unit
        self.draw.ellipse((x - r, y - r, x + r, y + r), fill=palette.bytes_of(colour)[:3])

    def word(self, point: Array, text: str, colour: Colour) -> None:
        """Adds a word near a point, for `write`."""
        self._words.append((*self.place(point), text, colour))

    def write(self) -> None:
        """Writes all words over the drawing, without overlaps."""
        taken: list[tuple[float, float, float, float]] = []
        for x, y, text, colour in self._words:
            for away in (0, 1, -1, 2, -2, 3):
                place = (x, y + away * 17 * self.unit)
                box = self.draw.textbbox(place, text, font=self.font, anchor="mm")
                if not any(_overlap(box, other) for other in taken):
                    break
            taken.append(box)
            ink = palette.bytes_of(colour)[:3]
            self.draw.text(place, text, font=self.font, fill=ink, anchor="mm")


def _sphere(pen: _Pen, hand: HandPicture) -> None:
    if hand.sphere is None:
        return
    middle = hand.palm + hand.sphere * hand.normal
    x, y = pen.place(middle)
    r = hand.sphere * pen.scale
    line, fill = palette.bytes_of(_dimmed(palette.OUTLINE, 0.7)), _dimmed(palette.OUTLINE, 0.16)
    pen.draw.ellipse(
        (x - r, y - r, x + r, y + r),
        fill=palette.bytes_of(fill)[:3],
        outline=line[:3],
        width=max(1, round(1.5 * pen.unit)),
    )
    # The circle perpendicular to the normal shows the orientation.
    across = np.linalg.svd(hand.normal[None])[2][1:]
    turns = np.linspace(0.0, 2.0 * np.pi, 49)
    ring = middle + hand.sphere * (
        np.cos(turns)[:, None] * across[0] + np.sin(turns)[:, None] * across[1]
    )
    pen.draw.line([pen.place(p) for p in ring], fill=line[:3], width=max(1, round(pen.unit)))


def _vectors(pen: _Pen, hand: HandPicture) -> None:
    for label, finger in sorted(hand.fingers.items()):
        colour = palette.finger_colour(label)
        shade = colour if finger.seen else _dimmed(colour, _DIM)
        pen.dot(finger.base, shade, 4.0)
        pen.arrow(finger.base, finger.tip, shade, 4.0)
        out = finger.tip - finger.base
        out = finger.tip + 0.016 * out / max(float(np.linalg.norm(out)), 1e-9)
        name = FINGERS[label] if finger.seen else f"({FINGERS[label]})"
        pen.word(out, name, shade)
    pen.dot(hand.palm, palette.TEXT, 5.0)
    pen.arrow(hand.palm, hand.palm + _NORMAL_LENGTH * hand.normal, palette.TEXT, 3.0)
    pen.word(hand.palm + 1.25 * _NORMAL_LENGTH * hand.normal, "palm normal", palette.TEXT)


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    """True if two boxes (left, top, right, bottom) overlap."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _dimmed(colour: Colour, share: float) -> Colour:
    r, g, b = (share * c + (1.0 - share) * k for c, k in zip(colour, GROUND, strict=True))
    return r, g, b


def _same(frame: HandFrame, hand: PaalmHand) -> TrackedHand | None:
    """Returns the hand of a frame with the id of a PAALM hand; None if there is none."""
    return next((h for h in frame.hands if h.id == hand.hand_id), None)


SIZE = (1100, 620)
"""Default size (px)."""
AZIMUTH, ELEVATION = 62.0, -38.0
"""Camera (deg) of both halves: from the person's side, turned towards the thumb, so that fingers do
not hide one another."""
DISTANCE, DISTANCE_OF_TWO = 0.42, 0.62
"""Distance (m) of the camera for one hand, and for two hands."""
_OVER_TABLE = (0.0, 0.0, -0.10)
"""Position (3,) of the device in the picture's scene, m: under the table top, as in a session."""
_TABLE_HEIGHT = 158
"""Height (px) of the table of angles in a picture that is 620 px high."""
_COLUMNS = ("flexion", "spread", "middle", "end")


class PaalmPicture(Closeable):
    """Draws hand frames and PAALM's results. Use it only in the thread that makes it.

    Args:
        sides: Sides of the hands.
        size: Size of the whole picture, px.
        context: An OpenGL context; None makes one.
        caption: Source of the frames, shown at the bottom.

    Raises:
        GraphicsError: This machine has no OpenGL.
    """

    def __init__(
        self,
        sides: Sequence[str],
        size: tuple[int, int] = SIZE,
        context: GLContext | None = None,
        caption: str = "",
    ) -> None:
        self.sides, self.size, self.caption = tuple(sides), size, caption
        self._memory = HandMemory()
        self._skeletons = [Person(side).skeleton(ADULT) for side in self.sides]
        hands = tuple(
            Hand(side, skeleton) for side, skeleton in zip(self.sides, self._skeletons, strict=True)
        )
        self._scene = Scene(SceneSpec(hands))
        self._qpos = np.zeros(self._scene.model.nq)
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        self._camera.azimuth, self._camera.elevation = AZIMUTH, ELEVATION
        self._camera.distance = DISTANCE if len(self.sides) == 1 else DISTANCE_OF_TWO
        surface = Surface().centred_at((0.0, 0.0, 0.0))
        self._renderer = _Plain(
            self._scene, surface, self._half(), camera=self._camera, context=context
        )

    def update(self, frame: HandFrame, result: PaalmFrame) -> list[HandPicture]:
        """Processes a frame without drawing it, to store the positions of its fingers."""
        known = {s: result.hands[s] for s in self.sides if s in result.hands}
        return self._memory.update(frame, known)

    def draw(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """Returns the RGB picture of a frame."""
        known = {s: result.hands[s] for s in self.sides if s in result.hands}
        pictures = self.update(frame, result)
        whole = Image.new("RGB", self.size, palette.bytes_of(GROUND)[:3])
        half = self._half()
        whole.paste(diagram(pictures, half, AZIMUTH, ELEVATION), (0, 0))
        if known:
            whole.paste(self._hand(frame.time, known), (self.size[0] - half[0], 0))
        self._write(whole, known, pictures)
        return whole

    def resize(self, size: tuple[int, int]) -> None:
        """Sets the size of the pictures, px."""
        self.size = size
        self._renderer.resize(self._half())

    def put_on_screen(self, picture: Image.Image) -> None:
        """Shows a picture in the window of this context."""
        self._renderer.put_on_screen(picture)

    def turn(self, right: float, down: float) -> None:
        """Turns the camera of the right half as if the scene were dragged by `right` and `down`,
        both as shares of the picture's height."""
        self._renderer.turn(right, down)

    def close(self) -> None:
        """Frees the OpenGL context; may be called twice."""
        self._renderer.close()

    def _half(self) -> tuple[int, int]:
        scale = self.size[1] / SIZE[1]
        return self.size[0] // 2, self.size[1] - round(_TABLE_HEIGHT * scale)

    def _hand(self, time: float, known: dict[str, PaalmHand]) -> Image.Image:
        views, palms = [], []
        for index, side in enumerate(self.sides):
            hand = known.get(side)
            if hand is None:
                pose = np.zeros(48)
                pose[2] = -1.0  # under the table, out of sight
            else:
                pose = hand_pose(hand.table, hand.palm, side, _OVER_TABLE)
                palms.append(np.add(hand.palm.origin, _OVER_TABLE))
            slot = self._scene.qpos_slice(index)
            self._qpos[slot] = self._scene.pose_to_qpos(index, pose)
            tips = Kinematics(self._skeletons[index]).tips(pose)
            seen = hand is not None and hand.seen
            solid = frozenset(range(len(FINGERS))) if seen else frozenset[int]()
            views.append(HandView(pose, tips, solid, "down", ()))
        self._camera.lookat[:] = np.mean(palms, axis=0)
        snapshot = Snapshot(time, 0, self._qpos.copy()).with_hands(*views)
        picture, lens = self._renderer.plain(snapshot)
        pen = ImageDraw.Draw(picture)
        for side, view in zip(self.sides, views, strict=True):
            if side in known:
                _names(pen, lens, view.tips, known[side], self.size[1] / SIZE[1])
        return picture

    def _write(
        self, whole: Image.Image, known: dict[str, PaalmHand], pictures: list[HandPicture]
    ) -> None:
        """Writes titles, the table of angles (degrees) and the radius of the sphere."""
        scale = self.size[1] / SIZE[1]
        pen = ImageDraw.Draw(whole)
        small, normal = (ImageFont.load_default(round(s * scale)) for s in (13, 15))
        text, faint = (palette.bytes_of(c)[:3] for c in (palette.TEXT, palette.FAINT))
        half, margin = self._half(), round(14 * scale)
        pen.text((margin, margin), "data of the device", font=normal, fill=text)
        title = "hand computed by PAALM"
        place = (self.size[0] - half[0] + margin, margin)
        left, top, right, bottom = pen.textbbox(place, title, font=normal)
        pad = round(5 * scale)
        box = (left - pad, top - pad, right + pad, bottom + pad)
        pen.rounded_rectangle(box, pad, fill=palette.bytes_of(GROUND)[:3])
        pen.text(place, title, font=normal, fill=text)
        for i, seen in enumerate(pictures):
            source = "" if seen.told else ", computed"
            radius = "none" if seen.sphere is None else f"{1000 * seen.sphere:.0f} mm{source}"
            pen.text(
                (margin, margin + round((22 + 18 * i) * scale)),
                f"{seen.side} palm sphere: {radius}",
                font=small,
                fill=faint,
            )
        wide = self.size[0] // max(1, len(known))
        for i, (side, hand) in enumerate(known.items()):
            self._angles(pen, side, hand, i * wide + margin, half[1], small, scale)
        if self.caption:
            warn = palette.bytes_of(palette.WARNING)[:3]
            place = (self.size[0] - margin, self.size[1] - margin)
            pen.text(place, self.caption, font=small, fill=warn, anchor="rs")

    def _angles(
        self,
        pen: ImageDraw.ImageDraw,
        side: str,
        hand: PaalmHand,
        x: int,
        y: int,
        font: ImageFont.FreeTypeFont | ImageFont.ImageFont,
        scale: float,
    ) -> None:
        faint = palette.bytes_of(palette.FAINT)[:3]
        step, wide = round(21 * scale), round(78 * scale)
        y += round(10 * scale)
        pen.text((x, y), f"{side}, degrees", font=font, fill=faint)
        heads = (*_COLUMNS, "length ratio")
        for c, head in enumerate(heads, start=1):
            pen.text((x + (c + 1) * wide, y), head, font=font, fill=faint, anchor="ra")
        for row, finger in enumerate(FINGERS):
            y += step
            held = finger in hand.held
            colour = palette.bytes_of(palette.finger_colour(row))[:3]
            ink = faint if held else palette.bytes_of(palette.TEXT)[:3]
            pen.text((x, y), finger, font=font, fill=faint if held else colour)
            cells = [f"{round(v)}" for v in hand.table[row].tolist()]
            if row == 0:
                cells[3] = "-"  # the skeleton's thumb has two bones
            cells.append("held" if held else f"{hand.ratios[finger]:.2f}")
            for c, cell in enumerate(cells, start=1):
                pen.text((x + (c + 1) * wide, y), cell, font=font, fill=ink, anchor="ra")


class _Plain(Renderer):
    """A renderer without text."""

    def plain(self, snapshot: Snapshot) -> tuple[Image.Image, Lens]:
        """Returns the picture and its camera."""
        with self._gl.as_current():
            picture = self._mixed(snapshot)
        return picture, Lens.of(self._drawing.view, picture.size)


def _names(
    pen: ImageDraw.ImageDraw, lens: Lens, tips: Array, hand: PaalmHand, scale: float
) -> None:
    """Draws dots on reported fingertips and rings on lost ones, in the fingers' colours."""
    places, ahead = lens.project(tips)
    r = 5.0 * scale
    for label, ((x, y), there) in enumerate(zip(places.tolist(), ahead.tolist(), strict=True)):
        colour = palette.bytes_of(palette.finger_colour(label))[:3]
        box = (x - r, y - r, x + r, y + r)
        if there and FINGERS[label] in hand.held:
            pen.ellipse(box, outline=colour, width=max(1, round(2 * scale)))
        elif there:
            pen.ellipse(box, fill=colour)
