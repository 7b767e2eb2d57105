"""Films and pictures of a session, drawn in their own thread without a screen."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from pathlib import Path

from PIL import Image

from models.errors import HandSandboxError, InputError
from models.scene import Scene
from models.surface import Surface
from sandbox.devices.device import Closeable
from sandbox.session.messages import Snapshot
from sandbox.views.display import FilmError
from sandbox.views.film_files import FilmFile, open_film
from sandbox.views.graphics import GLContext, offscreen_context
from sandbox.views.overlay import OverlayTexts
from sandbox.views.renderer import Renderer, check_size

ANIMATION_SIZE, ANIMATION_FPS = (640, 360), 15.0
VIDEO_SIZE, VIDEO_FPS = (960, 540), 30.0
"""Default size (px) and frames per second of WebP and GIF, and of MP4."""
PICTURE_SIZE = (1280, 720)
"""Default size (px) of single pictures."""
PICTURE_KINDS = (".png", ".jpg", ".jpeg", ".webp")
MAX_FPS = 60.0

WAITING = 4096
"""Largest number of snapshots that wait to be drawn: minutes of film, a few kB per snapshot. If the
queue is full, the session waits for the film."""

_Job = Callable[[Renderer], None]


class FilmView(Closeable):
    """Films a session in simulated time, and takes pictures of it.

    The film is complete only after `close`. Errors of the drawing thread are raised by `close`, so
    that they do not end the trial.

    Args:
        path: Path that ends in .webp, .gif or .mp4 (with the package imageio-ffmpeg).
        scene: The scene to draw, which is copied.
        surface: The touch surface.
        fps: Frames per second of simulated time; None: 15, or 30 for MP4.
        size: px; None: 640x360, or 960x540 for MP4.
        caption: Text that names player and task; it must name a simulated user as such.

    Raises:
        GraphicsError: This machine has no OpenGL.
        InputError: The path, the size or the rate cannot be used.

    Attributes:
        frames: Number of frames so far.
        dropped: Number of frames dropped because the film file was full.
    """

    def __init__(
        self,
        path: Path | str,
        scene: Scene,
        surface: Surface,
        fps: float | None = None,
        size: tuple[int, int] | None = None,
        caption: str = "",
    ) -> None:
        self.path = Path(path)
        video = self.path.suffix.lower() == ".mp4"
        self.fps = fps if fps is not None else VIDEO_FPS if video else ANIMATION_FPS
        self.size = size if size is not None else VIDEO_SIZE if video else ANIMATION_SIZE
        check_size(self.size, even=video)
        if not 1.0 <= self.fps <= MAX_FPS:
            raise InputError(
                "a film at this rate cannot be made",
                where="fps",
                got=self.fps,
                expected=f"1 to {MAX_FPS:g} frames per second",
            )
        self.frames = self.dropped = 0
        self._scene, self._surface, self._words = scene, surface, OverlayTexts(caption)
        self._begun: float | None = None
        self._last = 0.0
        self._error: BaseException | None = None
        self._closed = False
        self._jobs: queue.Queue[_Job | None] = queue.Queue(WAITING)
        self._ready = threading.Event()
        context = offscreen_context(*self.size)
        try:
            self._file = open_film(self.path, self.size, self.fps)
        except BaseException:
            context.free()
            raise
        self._thread = threading.Thread(
            target=self._work, args=(context, self._file), name="film", daemon=True
        )
        self._thread.start()
        self._ready.wait()
        if self._error is not None:
            self.close()

    def show(self, snapshot: Snapshot) -> None:
        """Adds a snapshot to the film; snapshots between two frames are skipped."""
        if self._closed or self._error is not None:
            return
        if self._begun is None or snapshot.time < self._last:
            # A new trial begins: its film continues at the end of the previous one.
            self._begun = snapshot.time - self.frames / self.fps
        self._last = snapshot.time
        # Tolerate half a microsecond, since times are sums of steps.
        due = int((snapshot.time - self._begun) * self.fps + 5e-7 * self.fps) + 1
        missing = due - self.frames
        if missing <= 0:
            return
        self.frames = due
        self._jobs.put(lambda renderer: self._film(renderer, snapshot, missing))

    def picture(
        self, snapshot: Snapshot, path: Path | str, size: tuple[int, int] | None = None
    ) -> None:
        """Writes a picture of a snapshot, as PNG, JPEG or WebP by the path's ending.

        Args:
            snapshot: The snapshot to draw.
            path: Path of the picture.
            size: px; None: 1280x720.

        Raises:
            InputError: The size or the path cannot be used.
            FilmError: The film was closed, or the drawing thread has failed.
        """
        target = _picture_path(path)
        answer: queue.Queue[Image.Image | BaseException] = queue.Queue()

        def draw(renderer: Renderer) -> None:
            try:
                renderer.resize(size or PICTURE_SIZE)
                answer.put(renderer.frame(snapshot))
            except Exception as error:
                answer.put(error)

        if self._closed or self._error is not None:
            raise FilmError(
                "no picture can be drawn: the film is closed or has failed", where=str(target)
            )
        self._jobs.put(draw)
        while True:
            try:
                result = answer.get(timeout=0.2)
                break
            except queue.Empty:
                if self._error is not None:
                    raise FilmError(
                        "no picture could be drawn: the drawing thread has failed",
                        where=str(target),
                        got=self._error,
                    ) from self._error
        if isinstance(result, BaseException):
            raise result
        _write_picture(result, target)

    def close(self) -> None:
        """Draws the waiting snapshots and completes the film; may be called twice.

        Raises:
            FilmError: The film could not be drawn or written; no file is left.
        """
        if self._closed:
            return
        self._closed = True
        self._jobs.put(None)
        self._thread.join()
        if isinstance(self._error, HandSandboxError):
            raise self._error
        if self._error is not None:
            raise FilmError(
                "the film could not be written", where=str(self.path), got=self._error
            ) from self._error

    def _film(self, renderer: Renderer, snapshot: Snapshot, times: int) -> None:
        renderer.resize(self.size)
        frame = renderer.frame(snapshot)
        for _ in range(times):
            if not self._file.add(frame):
                self.dropped += 1

    def _work(self, context: GLContext, file: FilmFile) -> None:
        """Draws until closed; the body of the drawing thread."""
        ended = False
        try:
            with Renderer(
                self._scene, self._surface, self.size, self._words, context=context
            ) as renderer:
                self._ready.set()
                while (job := self._jobs.get()) is not None:
                    job(renderer)
            ended = True
            file.close()
        except BaseException as error:
            self._error = error
            self._ready.set()
            self._discard(file)
            # Empty the queue, as the session may wait for space in it.
            while not ended:
                ended = self._jobs.get() is None

    def _discard(self, file: FilmFile) -> None:
        try:
            file.discard()
        except Exception as error:
            assert self._error is not None
            self._error.add_note(f"and the unfinished film could not be removed: {error}")


def _picture_path(path: Path | str) -> Path:
    target = Path(path)
    if target.suffix.lower() not in PICTURE_KINDS:
        raise InputError(
            "a picture cannot be written in this format",
            where=str(target),
            got=target.suffix,
            expected=", ".join(PICTURE_KINDS),
        )
    return target


def _write_picture(picture: Image.Image, target: Path) -> None:
    try:
        picture.save(target)
    except OSError as error:
        raise InputError(
            "a picture cannot be written here",
            where=str(target),
            got=error,
            remedy="Name another folder",
        ) from error
