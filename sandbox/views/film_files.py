"""Writers of film files, with bounded memory.

WebP and GIF are written by Pillow, which needs all frames at the end. Until then the frames are
stored on the disk in reels, files of some frames each, from which Pillow reads one frame at a time.
MP4 is streamed to ffmpeg, from the optional package imageio-ffmpeg.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Protocol

from PIL import Image

from models.errors import InputError
from sandbox.views.display import FilmError

REEL_BYTES = 96_000_000
"""Frames are stored in a reel when they fill this number of bytes in memory: 9 s of film at 640x360
and 15 frames per second."""
REEL_COMPRESSION = "tiff_lzw"
"""Compression of reels: lossless, 7 ms and 90 kB per frame at 640x360. Pillow reads TIFF one page
at a time."""
MAX_FRAMES = 9000
"""Largest number of frames of a WebP or GIF: 10 minutes at 15 per second. It bounds the number of
reels, which are all open at the end."""
MAX_GIF_FRAMES = 600
"""Largest number of frames of a GIF, since Pillow needs all in memory. Longer films are thinned out
evenly."""
WEBP_QUALITY = 75
GIF_COLOURS = 128


class FilmFile(Protocol):
    """A film that grows frame by frame."""

    def add(self, frame: Image.Image) -> bool:
        """Appends an RGB frame; False if the film is full."""
        ...

    def close(self) -> None:
        """Completes the file; if there are no frames, no file is written."""
        ...

    def discard(self) -> None:
        """Removes all files; may be called at any time."""
        ...


def open_film(path: Path, size: tuple[int, int], fps: float) -> FilmFile:
    """Opens a film file; the suffix of the path chooses the format.

    Raises:
        InputError: The format is unknown, its package is missing, or no file can be written in the
            folder.
    """
    kind = path.suffix.lower()
    if kind not in (".webp", ".gif", ".mp4"):
        raise InputError(
            "a film cannot be written in this format",
            where=str(path),
            got=kind,
            expected=".webp, .gif or .mp4",
        )
    part = path.with_name(f".{path.name}.part")
    try:
        part.touch()
    except OSError as error:
        raise InputError(
            "a film cannot be written here",
            where=str(path),
            got=error,
            remedy="Name another folder",
        ) from error
    part.unlink()
    if kind == ".mp4":
        return _Mp4(path, part, size, fps)
    return _Animation(path, part, kind, fps)


class _Animation:
    """An animated WebP or GIF."""

    def __init__(self, path: Path, part: Path, kind: str, fps: float) -> None:
        self._path, self._part, self._kind, self._fps = path, part, kind, fps
        self._folder = TemporaryDirectory(prefix="hand-sandbox-film-")
        self._waiting: list[Image.Image] = []
        self._reels: list[Path] = []
        self._count = 0

    def add(self, frame: Image.Image) -> bool:
        if self._count >= MAX_FRAMES:
            return False
        self._waiting.append(frame)
        self._count += 1
        if 3 * frame.width * frame.height * len(self._waiting) >= REEL_BYTES:
            self._store()
        return True

    def close(self) -> None:
        if self._count:
            images: list[Image.Image] = [Image.open(reel) for reel in self._reels]
            images += self._waiting
            try:
                if self._kind == ".gif":
                    self._write_gif(images)
                else:
                    self._write_webp(images)
            finally:
                for image in images:
                    image.close()
            os.replace(self._part, self._path)
        self.discard()

    def discard(self) -> None:
        self._waiting.clear()
        self._folder.cleanup()
        self._part.unlink(missing_ok=True)

    def _store(self) -> None:
        reel = Path(self._folder.name) / f"{len(self._reels)}.tiff"
        first, *rest = self._waiting
        first.save(reel, "TIFF", save_all=True, append_images=rest, compression=REEL_COMPRESSION)
        self._reels.append(reel)
        self._waiting.clear()

    def _write_webp(self, images: list[Image.Image]) -> None:
        images[0].save(
            self._part,
            "WEBP",
            save_all=True,
            append_images=images[1:],
            duration=durations(self._count, self._fps, 1),
            quality=WEBP_QUALITY,
            # Few key frames, as a film is played from its beginning. `method` 0 is the fastest.
            kmin=29,
            kmax=30,
            method=0,
            loop=0,
        )

    def _write_gif(self, images: list[Image.Image]) -> None:
        frames = _frames(images)
        stride = math.ceil(len(frames) / MAX_GIF_FRAMES)
        palette = _common_palette(frames)
        pictures = _quantized(frames[::stride], palette)
        first = next(pictures)
        first.save(
            self._part,
            "GIF",
            save_all=True,
            append_images=pictures,
            duration=durations(len(frames), self._fps, 10, stride),
            loop=0,
        )


class _Mp4:
    """An MP4 film, H.264 by ffmpeg."""

    def __init__(self, path: Path, part: Path, size: tuple[int, int], fps: float) -> None:
        if find_spec("imageio_ffmpeg") is None:
            raise InputError(
                "an MP4 film needs the package imageio-ffmpeg",
                where=str(path),
                remedy="pip install 'hand-sandbox[film]', or choose .webp or .gif",
            )
        import imageio_ffmpeg

        # ffmpeg derives the format from the suffix, so the partial file needs it.
        self._path, self._part = path, part.with_name(part.name + ".mp4")
        self._count = 0
        self._pipe = imageio_ffmpeg.write_frames(
            str(self._part),
            size,
            fps=fps,
            codec="libx264",
            quality=None,
            macro_block_size=2,
            ffmpeg_log_level="error",
            output_params=["-preset", "veryfast", "-crf", "20", "-movflags", "+faststart"],
        )
        self._pipe.send(None)

    def add(self, frame: Image.Image) -> bool:
        self._pipe.send(frame.tobytes())
        self._count += 1
        return True

    def close(self) -> None:
        self._pipe.close()
        if self._count:
            written = self._written()
            if written != self._count:
                self.discard()
                raise FilmError(
                    "ffmpeg did not write the whole film",
                    where=str(self._path),
                    got=f"{written} of {self._count} pictures",
                    remedy="Free space on the disk, or choose another folder",
                )
            os.replace(self._part, self._path)
        self.discard()

    def _written(self) -> int:
        """Counts the pictures in the file, since ffmpeg does not report a full disk."""
        import imageio_ffmpeg

        try:
            count, _ = imageio_ffmpeg.count_frames_and_secs(str(self._part))
        except (RuntimeError, OSError):
            return 0
        return int(count)

    def discard(self) -> None:
        self._pipe.close()
        self._part.unlink(missing_ok=True)


def durations(frames: int, fps: float, unit: int, stride: int = 1) -> list[int]:
    """Returns the durations of all frames (ms), rounded so that their sum does not drift.

    Args:
        frames: Number of frames of the film.
        fps: Frames per second of the film.
        unit: Unit of durations in the format, ms.
        stride: The file has one in this number of frames, and shows it for the time of all of them.
    """
    starts = [*range(0, frames, stride), frames]
    ends = [round(i * 1000.0 / fps / unit) * unit for i in starts]
    return [b - a for a, b in pairwise(ends)]


def _quantized(
    frames: list[tuple[Image.Image, int]], palette: Image.Image
) -> Iterator[Image.Image]:
    for image, i in frames:
        image.seek(i)
        yield image.quantize(palette=palette, dither=Image.Dither.NONE)


def _frames(images: list[Image.Image]) -> list[tuple[Image.Image, int]]:
    """Returns every frame as a file's image and the number of the frame in it."""
    return [(image, i) for image in images for i in range(getattr(image, "n_frames", 1))]


def _common_palette(frames: list[tuple[Image.Image, int]]) -> Image.Image:
    """Returns a common palette, from the first, a middle and the last frame.

    With a palette for each frame, colours would flicker.
    """
    width, height = frames[0][0].size
    sheet = Image.new("RGB", (width, 3 * height))
    for row, (image, i) in enumerate((frames[0], frames[len(frames) // 2], frames[-1])):
        image.seek(i)
        sheet.paste(image, (0, row * height))
    return sheet.quantize(GIF_COLOURS, method=Image.Quantize.MEDIANCUT)
