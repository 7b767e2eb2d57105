"""`sandbox play`: a task in a window, with the mouse or a tablet as fingers."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Literal

import tyro
from rich.console import Console

from models.errors import InputError
from sandbox.cli.common.latency import checked_limit
from sandbox.cli.common.lsl_options import LslOptions, streaming
from sandbox.cli.common.page_options import PageOptions
from sandbox.cli.common.parse import parse
from sandbox.cli.play.page import play_on_page
from sandbox.cli.run import RunOptions, perform
from sandbox.options.leap_devices import is_leap
from sandbox.options.own_hand import of_touches, with_own_hand
from sandbox.options.profiles import DEFAULT, default_path, find_profile
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.views.display import has_display
from tasks.registry import find_task


@dataclass(frozen=True)
class PlayOptions(LslOptions, PageOptions, SceneOptions):
    """Plays a task in a window with the mouse or a TUIO tablet, or on a page with your fingers.

    `sandbox play --tablet` prints a code: photograph it with a tablet, and play there. In the
    window, drag with the left button: one finger. Keys 1 to 5 put down a whole hand of so many
    fingers, and h shows all keys. r starts again, p pauses, s slows time down, q closes.
    """

    device: Annotated[str, tyro.conf.arg(metavar="DEVICE|FILE")] = "mouse"
    """mouse, web (a page in a browser), tuio, evdev (a touch screen of this machine), simulated,
    leap (a hand in the air, measured the first time), leap-simulated, or a file: a recording of
    ours or of a Leap, or a capture of TUIO packets."""

    view: Literal["auto", "window", "web", "film", "none"] = "auto"
    """Where it is seen. window: in a window, and on a page beside it, whose fingers play along with
    the mouse. web: on a page alone, which --device web and --tablet imply. film: in a film that is
    drawn meanwhile. none: nowhere. auto: a window, unless the fingers are on a page."""

    film: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Of --view film; TASK.webp unless said otherwise."""

    max_latency: Annotated[float | None, tyro.conf.arg(metavar="MS")] = None
    """Ends with 1 if p95 from a touch to its picture, in the window or on the page, was longer.
    What the display adds is in none of it."""

    def with_own_profile(self) -> PlayOptions:
        """The same, with this user's own profile where their own fingers touch."""
        other = self.profile is not None or self.device in ("mouse", "simulated")
        other = other or is_leap(self.device)
        if other or Path(self.device).exists() or not default_path().exists():
            return self
        return replace(self, profile=DEFAULT)


def main(argv: list[str]) -> int:
    """Runs `sandbox play ...`."""
    options = parse(PlayOptions, "sandbox play", argv)
    limit = checked_limit(options.max_latency)
    on_page = options.tablet or options.lan is not None or options.device == "web"
    if options.view == "auto":
        options = replace(options, view="web" if on_page else "window")
    if on_page and options.view == "window":
        # The window shows what the fingers on the page do; the mouse plays along.
        options = replace(options, device="mouse")
    elif on_page or (options.view == "web" and options.device == "mouse"):
        options = replace(options, device="web")
    console = Console()
    options = with_own_hand(options.with_own_profile(), console)
    if options.view in ("film", "none"):
        return _without_window(options)
    _check(options)
    if options.view == "web":
        with streaming(options.lsl, console):
            return play_on_page(options, options, console, limit)
    if not has_display():
        raise InputError(
            "no display to open a window on",
            remedy="`--view web` plays in a browser, `sandbox run` without any view; on a remote "
            "machine try `xvfb-run`",
        )
    if of_touches(options, is_leap(options.device)):
        console.print(f"profile: {find_profile(str(options.profile)).line}")
    from sandbox.cli.play.window import play_in_window

    with streaming(options.lsl, console):
        return play_in_window(options, options, limit, console)


def _check(options: PlayOptions) -> None:
    """Says what cannot be played before anybody is asked to open a page or look at a window."""
    find_task(plan(replace(options, record=None)).settings.task)
    if options.record is not None and not options.record.absolute().parent.is_dir():
        raise InputError(
            "no such folder",
            where="--record",
            got=str(options.record.parent),
            remedy="Make it, or record somewhere else",
        )


def _without_window(options: PlayOptions) -> int:
    """The same session as `sandbox run` plays: seen nowhere, or in a film."""
    if options.device in ("mouse", "web"):
        raise InputError(
            "fingers that see nothing touch nothing",
            where=f"--view {options.view}",
            got=options.device,
            expected="simulated, tuio or a file as --device",
        )
    if options.max_latency is not None:
        raise InputError(
            "latency is measured up to a picture",
            where="--max-latency",
            got=f"--view {options.view}",
            expected="--view window or --view web",
        )
    scene = {f.name: getattr(options, f.name) for f in fields(SceneOptions)}
    film = options.film or Path(f"{Path(options.task).stem}.webp")
    drawn = film if options.view == "film" else None
    return perform(RunOptions(**scene, film=drawn, lsl=options.lsl))
