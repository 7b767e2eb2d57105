"""Films the first minutes with the program: the commands of the README and their output.

    pip install -e ".[site]"
    python -m tools.docs.first_minutes             # writes docs/pictures/first-minutes.webp

Every scene is a real run in a fresh clone with its own environment, in a terminal or in a window on
an X server in memory. Long runs are shown faster, and each scene shows its real duration. The
tablet's page and a study's forms are pictures made by `tools.docs.page_picture` and
`tools.docs.study_pictures`. Needs Debian's xvfb and OpenGL, and a package index. All touches are
those of the simulated user.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageDraw, ImageFont, ImageGrab

from tests.support.screen import screen
from tools.docs import terminal

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "docs" / "pictures" / "first-minutes.webp"
EVERY_MS = 250
"""Time (ms) for which a frame is shown."""
MOST_FRAMES = 22
"""Largest number of frames in a scene."""
LAST_MS = 1800
"""Time (ms) for which the last frame of a scene is shown."""
BAR = 38
"""Height (px) of the line below the picture."""
TESTS_RUN = re.compile(r"items\]\s+[.s]{20}")
"""Output of the tests after the first of them. Then they are stopped, since all take minutes."""
PLAY_SECONDS = 14.0
"""Duration (s) of a command that waits for a person."""
LONGEST_SECONDS = 900.0
"""Longest duration (s) of any other command."""
QUALITY = 60
"""Quality of WebP, 0 to 100."""

Timed = tuple[float, Image.Image]
"""Time (s) since the beginning, and the picture at that time."""


@dataclass(frozen=True)
class Scene:
    """Pictures with a line below them.

    Attributes:
        title: Title of the scene.
        pictures: The pictures, in order.
    """

    title: str
    pictures: Sequence[Timed]

    def frames(self) -> Iterator[tuple[Image.Image, int]]:
        """Frames of the film, each with the time (ms) for which it is shown."""
        count = min(len(self.pictures), MOST_FRAMES)
        chosen = [
            self.pictures[i * (len(self.pictures) - 1) // max(count - 1, 1)] for i in range(count)
        ]
        took = self.pictures[-1][0] - self.pictures[0][0]
        line = f"{self.title}  ·  {took:.0f} s" if took else self.title
        for i, (_, picture) in enumerate(chosen):
            last = i == len(chosen) - 1
            yield _framed(picture, line), LAST_MS if last else EVERY_MS


def readme_commands() -> list[str]:
    """The README's two commands."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"```bash\n(.*?)```", text, re.DOTALL)
    assert block is not None
    return block[1].strip().splitlines()


def scenes(folder: Path) -> Iterator[Scene]:
    """All scenes. Each is run when the iteration reaches it.

    Args:
        folder: An empty folder for the clone.
    """
    clone = folder / "hand-sandbox"
    subprocess.run(["git", "clone", "-q", str(ROOT), str(clone)], check=True)
    demo, tests = readme_commands()
    with screen() as shown, _looked_at(shown.name) as seen:
        yield _typed("Install it and see it", demo, clone, shown=demo)
        yield Scene("... in a window, if there is a screen", seen())
    yield _typed("All tests: the first of them", tests, clone, shown=tests, enough=TESTS_RUN)
    yield _typed("Play on a tablet", "sandbox play box-to-goal --tablet", clone, PLAY_SECONDS)
    yield _kept("... the page, with the simulated user's fingers", "page.webp")
    seeds = "sandbox regress --tasks box-to-goal wrench-turn --seeds 0:4"
    yield _typed("Test in CI that no task became harder", seeds, clone)
    yield _kept("Study people: a form and a trial on the tablet", "study.webp")
    run = "sandbox run box-to-goal --seed 3 --record run.jsonl"
    yield _typed("Move a rig", f"{run} && sandbox export run.jsonl --to hand.glb", clone)
    yield _typed("Train agents", "python examples/random_agent.py", clone)
    with screen() as shown, _looked_at(shown.name) as seen:
        own = "sandbox play examples/push_the_mug.py --device simulated"
        yield _typed("Write your own task", own, clone, 2 * PLAY_SECONDS)
        yield Scene("... a mug, in the window", seen())


def _typed(
    title: str,
    command: str,
    clone: Path,
    longest: float = LONGEST_SECONDS,
    shown: str = "",
    enough: re.Pattern[str] | None = None,
) -> Scene:
    """A command in the terminal, in the clone's environment."""
    path = f"{clone / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    # pip is quiet, since its messages depend on the configuration of this machine.
    variables = {"PATH": path, "PIP_QUIET": "2"}
    run = terminal.film(command, clone, shown, longest, enough, environment=variables)
    if run.status:
        run.moments[-1].picture.save(OUT.with_suffix(".failed.png"))
        raise SystemExit(f"{command}: exit status {run.status}")
    return Scene(title, [(moment.seconds, moment.picture) for moment in run.moments])


def _kept(title: str, name: str) -> Scene:
    """A picture of the documentation."""
    with Image.open(OUT.parent / name) as picture:
        return Scene(title, [(0.0, picture.convert("RGB"))])


@contextmanager
def _looked_at(display: str) -> Iterator[Callable[[], list[Timed]]]:
    """Takes pictures of an X screen; yields a function that returns the pictures so far."""
    pictures: list[Timed] = []
    over = threading.Event()

    def look() -> None:
        began = time.monotonic()
        while not over.wait(EVERY_MS / 1000):
            picture = ImageGrab.grab(xdisplay=display).convert("RGB")
            # An empty screen is black.
            if picture.getbbox() is not None:
                pictures.append((time.monotonic() - began, picture.crop(picture.getbbox())))

    watcher = threading.Thread(target=look, daemon=True)
    watcher.start()
    try:
        yield lambda: list(pictures)
    finally:
        over.set()
        watcher.join()


def _framed(picture: Image.Image, line: str) -> Image.Image:
    """The picture in the middle, as large as fits, and the line below it."""
    width, height = terminal.size()
    frame = Image.new("RGB", (width, height + BAR), terminal.BACKGROUND)
    shown = picture.copy()
    shown.thumbnail((width, height))
    frame.paste(shown, ((width - shown.width) // 2, (height - shown.height) // 2))
    pen = ImageDraw.Draw(frame)
    pen.rectangle((0, height, width, height + BAR), fill="#f4f1ea")
    pen.text((14, height + 9), line, font=ImageFont.load_default(18), fill="#22252b")
    return frame


def main() -> int:
    """Films all scenes."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=OUT, help="film")
    out = parser.parse_args().out
    frames: list[tuple[Image.Image, int]] = []
    with TemporaryDirectory() as folder:
        for scene in scenes(Path(folder)):
            frames += scene.frames()
            print(f"{scene.title}: {len(scene.pictures)} pictures", flush=True)
    pictures, times = [f for f, _ in frames], [ms for _, ms in frames]
    pictures[0].save(
        out,
        save_all=True,
        append_images=pictures[1:],
        duration=times,
        loop=0,
        quality=QUALITY,
        # Letters stay sharp, and frames do not leave traces in later frames.
        allow_mixed=True,
    )
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
