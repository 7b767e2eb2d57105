"""The paper's line drawings beside the hand that PAALM reconstructs, with its angles."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.paalm import PaalmFrame, PaalmHand
from models.arithmetic import Array
from models.frames import FINGERS, HandFrame
from models.hand import Hand
from models.kinematics import Kinematics
from models.person import Person
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.devices.device import Closeable
from sandbox.session.messages import HandView, Snapshot
from sandbox.views import palette
from sandbox.views.graphics import GLContext
from sandbox.views.lens import Lens
from sandbox.views.paalm.diagram import GROUND, HandMemory, HandPicture, diagram
from sandbox.views.renderer import Renderer

SIZE = (1100, 620)
"""px, default size."""
AZIMUTH, ELEVATION = 62.0, -38.0
"""deg, camera of both halves: from the person's side, turned to the thumb, so that fingers do not
hide one another."""
DISTANCE, DISTANCE_OF_TWO = 0.42, 0.62
"""m, distance of the camera for one hand, and for two."""
_OVER_TABLE = (0.0, 0.0, -0.10)
"""(3,) m, position of the device in the picture's scene: under the table's top, as in the
sandbox."""
_TABLE_HEIGHT = 158
"""px, height of the table of angles in a picture of 620 px."""
_COLUMNS = ("flexion", "spread", "middle", "end")


class PaalmPicture(Closeable):
    """Draws hand frames and PAALM's results; belongs to the thread that makes it.

    Args:
        sides: Sides of the hands.
        size: px of the whole picture.
        context: An OpenGL context; None makes one.
        caption: Source of the frames, at the bottom.

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
        """Processes a frame that is not drawn, to keep the places of its fingers."""
        known = {s: result.hands[s] for s in self.sides if s in result.hands}
        return self._memory.update(frame, known)

    def draw(self, frame: HandFrame, result: PaalmFrame) -> Image.Image:
        """The RGB picture of a frame."""
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
        """Turns the camera of the hand, by shares of the picture's height."""
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
        """Writes titles, angles in degrees, and the radius of the sphere."""
        scale = self.size[1] / SIZE[1]
        pen = ImageDraw.Draw(whole)
        small, normal = (ImageFont.load_default(round(s * scale)) for s in (13, 15))
        text, faint = (palette.bytes_of(c)[:3] for c in (palette.TEXT, palette.FAINT))
        half, margin = self._half(), round(14 * scale)
        pen.text((margin, margin), "what the device says", font=normal, fill=text)
        title = "the hand that PAALM makes"
        place = (self.size[0] - half[0] + margin, margin)
        left, top, right, bottom = pen.textbbox(place, title, font=normal)
        pad = round(5 * scale)
        box = (left - pad, top - pad, right + pad, bottom + pad)
        pen.rounded_rectangle(box, pad, fill=palette.bytes_of(GROUND)[:3])
        pen.text(place, title, font=normal, fill=text)
        for i, seen in enumerate(pictures):
            told = "" if seen.told else ", worked out"
            radius = "none" if seen.sphere is None else f"{1000 * seen.sphere:.0f} mm{told}"
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
        """The picture and its camera."""
        with self._gl.as_current():
            picture = self._mixed(snapshot)
        return picture, Lens.of(self._drawing.view, picture.size)


def _names(
    pen: ImageDraw.ImageDraw, lens: Lens, tips: Array, hand: PaalmHand, scale: float
) -> None:
    """Draws a dot in its finger's colour on every seen fingertip, a ring on every held one."""
    places, ahead = lens.project(tips)
    r = 5.0 * scale
    for label, ((x, y), there) in enumerate(zip(places.tolist(), ahead.tolist(), strict=True)):
        colour = palette.bytes_of(palette.finger_colour(label))[:3]
        box = (x - r, y - r, x + r, y + r)
        if there and FINGERS[label] in hand.held:
            pen.ellipse(box, outline=colour, width=max(1, round(2 * scale)))
        elif there:
            pen.ellipse(box, fill=colour)
