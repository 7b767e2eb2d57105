"""Renderer of snapshots to pictures, without a screen."""

from __future__ import annotations

from contextlib import ExitStack

import mujoco
import numpy as np
from PIL import Image

from models.errors import InputError
from models.scene import Scene
from models.surface import Surface
from sandbox.devices.device import Closeable
from sandbox.session.messages import Snapshot
from sandbox.views.cameras import Lens, film_camera
from sandbox.views.drawing import Drawing, Hidden
from sandbox.views.graphics import GLContext, offscreen_context, render_context
from sandbox.views.marks import draw_outline
from sandbox.views.overlay import OverlayTexts, paste, stickers

GHOST_OPACITY = 0.5
"""Opacity of a ghost hand, which cannot touch objects yet."""
SEE_THROUGH_OPACITY, SEE_THROUGH_GHOST = 0.6, 0.3
"""Opacity of a solid hand and of a ghost in views in which hands hide held objects."""

SHADOW_SIZE, SAMPLES = 1024, 4
"""Size (px) of the shadow map, and samples per pixel. Measured at 640x360 without a graphics card:
with 2048 px, a picture takes 1.2 times as long without a visible gain; without samples, 0.6 times
as long, but edges are jagged."""
SLICES, STACKS = 16, 8
"""Number of facets around and along a capsule. The outline of the thickest capsule is wrong by half
a pixel at most. With twice as many facets, a picture takes 1.5 times as long."""

ELEVATIONS = (-89.0, -12.0)
"""Range (deg) of the elevation of a camera, so that it stays above the table."""

SMALLEST, LARGEST = 16, 4096
"""Range (px) of a picture's sides."""


class Renderer(Closeable):
    """Draws snapshots of a scene into pictures.

    A renderer may be used only in one thread: the thread that makes it or, with a given context,
    the first thread that draws.

    Args:
        scene: The scene to draw, which is copied.
        surface: The touch surface.
        size: Width and height of the pictures, px.
        words: Texts on every picture.
        camera: The camera; None uses the camera of films, placed by the first snapshot.
        context: An OpenGL context of `offscreen_context` or of a window; None makes one. It is
            freed with the renderer.
        rings_on_table: Position of the contacts' marks; see `Drawing`.
        samples: Samples per pixel; with 0, edges are jagged and a picture takes about half the
            time.

    Raises:
        GraphicsError: This machine has no OpenGL.
        InputError: The size cannot be drawn.

    Attributes:
        lens: The camera of the last picture.
        shadows: True draws shadows; without shadows, a picture takes half the time.
        see_through: True also shows objects behind solid hands, for cameras above the hands.
    """

    def __init__(
        self,
        scene: Scene,
        surface: Surface,
        size: tuple[int, int] = (960, 540),
        words: OverlayTexts | None = None,
        camera: mujoco.MjvCamera | None = None,
        context: GLContext | None = None,
        rings_on_table: bool = True,
        samples: int = SAMPLES,
    ) -> None:
        self.size, self.words, self.camera = size, words or OverlayTexts(), camera
        self.shadows, self.see_through = True, False
        self.lens: Lens | None = None
        self._surface = surface
        self._kept: tuple[object, Image.Image] | None = None
        self._closing = ExitStack()
        with ExitStack() as opening:
            if context is not None:
                opening.callback(context.free)
            check_size(size)
            if context is None:
                context = offscreen_context(*size)
                opening.callback(context.free)
            gl = context
            self._gl = gl
            self._drawing = Drawing(scene, surface, rings_on_table)
            model = self._drawing.model
            model.vis.global_.offwidth, model.vis.global_.offheight = size
            model.vis.quality.shadowsize = SHADOW_SIZE
            model.vis.quality.offsamples = samples
            model.vis.quality.numslices, model.vis.quality.numstacks = SLICES, STACKS
            self._context = opening.enter_context(render_context(model, gl))
            self._closing = opening.pop_all()

    def frame(self, snapshot: Snapshot, stretched: tuple[int, int] | None = None) -> Image.Image:
        """Returns the picture of a snapshot, RGB.

        Args:
            snapshot: The snapshot to draw.
            stretched: Size (px) to which the drawing is stretched before texts are added.
        """
        picture = self.without_texts(snapshot)
        if stretched and stretched != self.size:
            picture = picture.resize(stretched, Image.Resampling.BILINEAR)
        self.lens = Lens.of(self._drawing.view, picture.size)
        paste(picture, stickers(snapshot, self.lens, self._surface, self._drawing.drop, self.words))
        return picture

    def without_texts(self, snapshot: Snapshot) -> Image.Image:
        """Returns the picture of a snapshot without texts, RGB."""
        if self.camera is None:
            self.camera = film_camera(snapshot, self._surface)
        # A picture higher than wide shows as much at the sides as a square, and more above and
        # below.
        self._drawing.narrowness = max(1.0, self.size[1] / self.size[0])
        with self._gl.as_current():
            return self._mixed(snapshot)

    def _mixed(self, snapshot: Snapshot) -> Image.Image:
        """Returns the drawing with translucent ghosts."""
        picture = self._draw(snapshot, None)
        solid = all(hand.solid for hand in snapshot.hands)
        if self.see_through:
            opacity = SEE_THROUGH_OPACITY if solid else SEE_THROUGH_GHOST
            return Image.blend(self._behind(snapshot, "hands"), picture, opacity)
        if not solid:
            return Image.blend(self._behind(snapshot, "ghosts"), picture, GHOST_OPACITY)
        return draw_outline(
            picture,
            Lens.of(self._drawing.view, picture.size),
            *self._drawing.held_back(snapshot),
        )

    def resize(self, size: tuple[int, int]) -> None:
        """Sets the size of the pictures, px."""
        check_size(size)
        if size != self.size:
            self.size, self._kept = size, None
            with self._gl.as_current():
                mujoco.mjr_resizeOffscreen(*size, self._context)

    def put_on_screen(self, picture: Image.Image) -> None:
        """Shows an RGB picture of the window's size in the window of this context."""
        flipped = picture.transpose(Image.Transpose.FLIP_TOP_BOTTOM)
        pixels = np.frombuffer(flipped.tobytes(), np.uint8).reshape(-1, 1)
        rect = mujoco.MjrRect(0, 0, *picture.size)
        with self._gl.as_current():
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_WINDOW.value, self._context)
            mujoco.mjr_drawPixels(pixels, None, rect, self._context)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)

    def turn(self, right: float, down: float) -> None:
        """Turns the camera as if the scene were dragged by `right` and `down`, both as shares of
        the picture's height."""
        if self.camera is not None and not self.camera.orthographic:
            self.camera.azimuth -= 180.0 * right
            self.camera.elevation = float(
                np.clip(self.camera.elevation - 180.0 * down, *ELEVATIONS)
            )
            self._kept = None

    def close(self) -> None:
        """Frees the OpenGL context; may be called twice."""
        self._closing.close()

    def _behind(self, snapshot: Snapshot, hidden: Hidden) -> Image.Image:
        """Returns the picture without hidden hands; it is cached until something in it moves.

        The cache saves time because usually nothing else moves while a hand is a ghost.
        """
        seen = (self.shadows, hidden, _background(snapshot))
        if self._kept is None or self._kept[0] != seen:
            self._kept = seen, self._draw(snapshot, hidden)
        return self._kept[1]

    def _draw(self, snapshot: Snapshot, hidden: Hidden | None) -> Image.Image:
        assert self.camera is not None
        drawing = self._drawing
        drawing.view.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self.shadows
        drawing.update(snapshot, self.camera, hidden)
        sky = drawing.sees_sky()
        drawing.view.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = sky
        drawing.view.flags[mujoco.mjtRndFlag.mjRND_HAZE] = sky
        width, height = self.size
        rect = mujoco.MjrRect(0, 0, width, height)
        pixels = np.empty((height, width, 3), np.uint8)
        mujoco.mjr_render(rect, drawing.view, self._context)
        mujoco.mjr_readPixels(pixels, None, rect, self._context)
        # OpenGL counts rows from the bottom.
        return Image.fromarray(pixels).transpose(Image.Transpose.FLIP_TOP_BOTTOM)


def _background(snapshot: Snapshot) -> object:
    """Returns a key that is equal for snapshots that differ only in their ghosts.

    Contacts are rounded to a millimetre, about a pixel, since those of a resting finger tremble.
    """
    contacts = [
        (*np.round(1000 * place).tolist(), c.label, c.state, c.label in hand.solid)
        for hand in snapshot.hands
        for c, place in zip(hand.contacts, hand.places, strict=True)
    ]
    solid = [h.target.tobytes() + h.tips.tobytes() if h.solid else b"" for h in snapshot.hands]
    objects = [
        (*np.round(1e4 * o.position).tolist(), *np.round(1e3 * o.rotation).ravel().tolist())
        for o in snapshot.objects.values()
    ]
    return contacts, solid, objects, snapshot.goals, snapshot.score.final, snapshot.score.held


def check_size(size: tuple[int, int], even: bool = False) -> None:
    """Checks that a picture of this size can be drawn.

    Raises:
        InputError: A side is not a whole number of pixels within the limits, or is odd although
            `even` is required.
    """
    whole = len(size) == 2 and all(isinstance(n, int) for n in size)
    if whole and all(SMALLEST <= n <= LARGEST for n in size):
        if not even or not any(n % 2 for n in size):
            return
        raise InputError(
            "an MP4 film needs an even width and height",
            where="size",
            got=size,
            expected="even numbers of pixels",
        )
    raise InputError(
        "a picture of this size cannot be drawn",
        where="size",
        got=size,
        expected=f"width and height, {SMALLEST} to {LARGEST} pixels",
    )
