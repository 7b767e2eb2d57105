"""`sandbox play`: plays a task in a window or on a browser page, by mouse or touch."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console

from models.errors import InputError
from sandbox.cli.common.command_line import parse, picked
from sandbox.cli.common.lsl_options import LslOptions, streaming
from sandbox.cli.run import RunOptions, perform
from sandbox.devices.registry import LIVE_HEADSET as LIVE
from sandbox.devices.registry import is_in_air
from sandbox.play.own_profile import Learner, with_measured_hand, with_usable_profile
from sandbox.play.page_play import play_on_page
from sandbox.play.player_requests import checked_limit
from sandbox.server.page_options import PageOptions
from sandbox.trial.profiles import DEFAULT, default_path, find_profile, uses_touch_profile
from sandbox.trial.trial_options import (
    COMMON,
    OUTPUT,
    PERSON,
    TrialOptions,
    check_labels,
    check_names,
    trial_settings,
)
from sandbox.views.display import has_display
from tasks.registry import find_task


@dataclass(frozen=True, kw_only=True)
class PlayOptions(LslOptions, PageOptions, TrialOptions):
    """Plays a task in a window with the mouse or a tablet, or on a browser page by touch.

    `sandbox play --tablet` prints a QR code: scan it with a tablet and play by touch. In the
    window, drag with the left mouse button to move one finger. Keys 1 to 5 put down a hand with
    that many fingers, and h shows all keys: r restarts, p pauses, s slows time down, q quits.
    """

    device: Annotated[str, Parameter(group=COMMON, metavar="DEVICE")] = "mouse"
    """Source of the input. mouse: the mouse in the window. web: a page in a browser. tuio: a TUIO
    sender. evdev: a touch screen of this Linux machine. leap: a hand in the air over a Leap,
    measured the first time. webcam: a hand in front of a camera (docs/webcam.md). webxr: hands in a
    headset, which opens a page of this program (docs/headset.md). simulated, leap-simulated,
    webxr-simulated: a simulated user. FILE: a recording of this program or of a Leap, or a capture
    of TUIO packets. FILE.py:CLASS[:ARGUMENT], MODULE:CLASS[:ARGUMENT], or a name from an installed
    package: a device of your own (docs/write-a-device.md)."""

    view: Annotated[Literal["auto", "window", "web", "film", "none"], Parameter(group=COMMON)] = (
        "auto"
    )
    """Output. window: a window, and also a page, on which touches work like the mouse. web: only a
    page. film: a film. none: no output. auto: web if the input is on a page (--device web or webxr,
    --tablet, --lan), else window."""

    film: Annotated[Path | None, Parameter(group=OUTPUT, metavar="FILE")] = None
    """File for the film of --view film. Default: TASK.webp."""

    max_latency: Annotated[float | None, Parameter(group=OUTPUT, metavar="MS")] = None
    """Exit status 1 if the 95th percentile of the time from a touch to its picture, in the window
    or on the page, was longer than this. Delays of the display are not included."""

    learn: Annotated[bool, Parameter(group=PERSON)] = False
    """Store new layouts of your five fingers in the profile, and use them from the next trial on.
    Without --learn, playing never changes the profile."""

    def with_own_profile(self) -> PlayOptions:
        """Returns the options with this user's own profile, if a person touches the device."""
        other = self.profile is not None or self.device in ("mouse", "simulated")
        other = other or is_in_air(self.device)
        if other or Path(self.device).exists() or not default_path().exists():
            return self
        return replace(self, profile=DEFAULT)


def main(argv: list[str]) -> int:
    """Runs `sandbox play ...`."""
    options = parse(PlayOptions, "sandbox play", argv)
    check_names(options)
    check_labels(options)
    limit = checked_limit(options.max_latency)
    headset = options.device == LIVE
    on_page = options.tablet or options.lan is not None or options.device == "web" or headset
    if options.view == "auto":
        options = replace(options, view="web" if on_page else "window")
    if headset and options.view != "web":
        raise InputError(
            "a headset's own page shows the scene",
            where=f"--view {options.view}",
            remedy="Leave out --view; `sandbox replay FILE --view film` makes a film afterwards",
        )
    if on_page and options.view == "window":
        # The page that belongs to the window takes the touches, and the mouse works as well.
        options = replace(options, device="mouse")
    elif (on_page and not headset) or (options.view == "web" and options.device == "mouse"):
        options = replace(options, device="web")
    console = Console()
    options = with_measured_hand(options.with_own_profile(), console)
    options = with_usable_profile(options, console)
    if options.view in ("film", "none"):
        return _without_window(options)
    _check(options)
    learner = Learner.of(options, console) if options.learn else None
    if options.view == "web":
        with streaming(options.lsl, console):
            return play_on_page(options, options, console, limit, learner)
    if not has_display():
        raise InputError(
            "no display to open a window on",
            remedy="`--view web` plays in a browser, `sandbox run` without any view; on a remote "
            "machine try `xvfb-run`",
        )
    if uses_touch_profile(options):
        console.print(f"profile: {find_profile(str(options.profile)).line}")
    from sandbox.play.window_play import play_in_window

    with streaming(options.lsl, console):
        return play_in_window(options, options, limit, console, learner)


def _check(options: PlayOptions) -> None:
    """Checks task and --record before a page or window is opened."""
    find_task(trial_settings(replace(options, record=None)).task)
    if options.record is not None and not options.record.absolute().parent.is_dir():
        raise InputError(
            "no such folder",
            where="--record",
            got=str(options.record.parent),
            remedy="Create it, or choose another folder",
        )


def _without_window(options: PlayOptions) -> int:
    """Plays like `sandbox run`, with a film or without any output."""
    if options.device in ("mouse", "web"):
        raise InputError(
            "this device needs a window or a page",
            where=f"--view {options.view}",
            got=options.device,
            expected="simulated, tuio or a file as --device",
        )
    if options.learn:
        raise InputError(
            "layouts are learned only while a person plays on a window or page",
            where="--learn",
            got=f"--view {options.view}",
            expected="--view window or --view web",
        )
    if options.max_latency is not None:
        raise InputError(
            "this view shows no pictures, so the time from a touch to its picture is not known",
            where="--max-latency",
            got=f"--view {options.view}",
            expected="--view window or --view web",
        )
    film = options.film or Path(f"{Path(options.task).stem}.webp")
    drawn = film if options.view == "film" else None
    return perform(picked(RunOptions, options, film=drawn))
