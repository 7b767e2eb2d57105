"""Options of `sandbox study run`, and which of them fit together: said before anybody is asked."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from models.errors import InputError, StudyError
from sandbox.views.display import has_display

if TYPE_CHECKING:
    from sandbox.cli.common.page_options import PageOptions
    from sandbox.options.touch_devices import TouchOptions
    from sandbox.study.design.design import Design

SAID_ANEW = (
    "file",
    "participant",
    "session",
    "hand",
    "hand_size",
    "language",
    "resume",
    "force_upgrade",
)
"""Options that are said anew, or never again, when a session goes on."""


@dataclass(frozen=True)
class RunOptions:
    """Runs a participant's session: consent, instructions, practice, trials, breaks and forms.

    `sandbox study run design.toml --participant new --tablet` prints a code: photograph it with the
    participant's tablet; all of the session is on its page. `--device web` is the same in a browser
    of this machine. Otherwise trials are in a window, and forms on a page beside it.

    The terminal is the experimenter's: h and Enter shows the keys. Where forms are in the terminal,
    too, a key begins with a slash while one is open.
    """

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DESIGN")]
    """The design."""

    participant: Annotated[str, tyro.conf.arg(metavar="new|ID")] = ""
    """new, or the id of somebody who has begun; without it, those are listed."""

    out: Annotated[Path, tyro.conf.arg(metavar="DIR")] = Path("studies")
    """Where studies are kept."""

    pilot: tyro.conf.FlagCreatePairsOff[bool] = False
    """A rehearsal: its data go to a folder of their own and never mix with real ones."""

    device: Annotated[str, tyro.conf.arg(metavar="{web,mouse,tuio,evdev,simulated}")] = "mouse"
    """Where touches come from. web: the page, which --tablet implies. evdev, evdev:NODE: a touch
    screen of this machine. simulated: in a pilot only."""

    second_device: Annotated[str | None, tyro.conf.arg(metavar="{mouse,tuio,evdev,simulated}")] = (
        None
    )
    """Where the second hand's touches come from, in trials of tasks for two hands. tuio, evdev: as
    for --device. simulated: a simulated user moves it. Not needed where both hands are on one
    surface (one_surface in the design) or over one Leap."""

    view: Literal["window", "none"] = "window"
    """none: trials without a window, as where another program shows them. With --device web they
    are on the page."""

    forms: Literal["auto", "page", "terminal"] = "auto"
    """Where consent, instructions, questions and breaks are. auto: on the page, save with
    --device simulated."""

    tablet: tyro.conf.FlagCreatePairsOff[bool] = False
    """The page on a tablet in the same network."""

    lan: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None
    """Serves the page on this address instead."""

    page_port: int = 0
    """TCP port of the page; 0 takes a free one. On a port of your choice the link stays the same,
    and a tablet finds back by itself when the program is started anew."""

    tls_cert: Annotated[str | None, tyro.conf.arg(metavar="FILE")] = None
    """Certificate for https, with --tls-key."""

    tls_key: Annotated[str | None, tyro.conf.arg(metavar="FILE")] = None
    """Key of the certificate."""

    no_browser: tyro.conf.FlagCreatePairsOff[bool] = False
    """Opens no browser for forms beside a window; the link is printed either way."""

    hand: Literal["right", "left"] = "right"
    """Which hand a new participant uses."""

    hand_size: float = 1.0
    """Length of a new participant's hand against the trained one; `sandbox calibrate` measures."""

    language: str = ""
    """Of a new participant; the design's first unless told otherwise."""

    session: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Of somebody who comes several times: the first that is not finished, unless told otherwise;
    how often people come is `sessions` in the design."""

    resume: tyro.conf.FlagCreatePairsOff[bool] = False
    """Goes on with an interrupted session without asking."""

    force_upgrade: Annotated[str, tyro.conf.arg(metavar="REASON")] = ""
    """Goes on although program, encoder or design have changed; it is logged."""

    leap: Annotated[str, tyro.conf.arg(metavar="URL")] = ""
    """Where trials with `device = "leap"` find leapd or the Ultraleap bridge, if not where it
    usually is."""

    lsl: tyro.conf.FlagCreatePairsOff[bool] = False
    """Sends touches, poses and markers over Lab Streaming Layer (extra `lsl`)."""

    port: int = 3333
    """UDP port for TUIO."""

    bind: Annotated[str, tyro.conf.arg(metavar="ADDRESS")] = "127.0.0.1"
    """Address for TUIO; 0.0.0.0 is reached from the network."""

    @property
    def touches(self) -> str:
        """The device: a page in the network is one."""
        return "web" if self.tablet or self.lan is not None else self.device

    @property
    def leap_address(self) -> str:
        """Address of the Leap service."""
        from sandbox.devices.leap.leap import DEFAULT_ADDRESS

        return self.leap or DEFAULT_ADDRESS

    @property
    def has_page(self) -> bool:
        """True if the participant gets a page."""
        auto = self.forms == "auto" and self.device != "simulated"
        return self.touches == "web" or self.forms == "page" or auto


def again(options: RunOptions, ppid: str) -> str:
    """The command that goes on with somebody."""
    words = ["sandbox", "study", "run", str(options.file), "--participant", ppid]
    for field in fields(options):
        value = getattr(options, field.name)
        if field.name in SAID_ANEW or value == field.default:
            continue
        words.append("--" + field.name.replace("_", "-"))
        if value is not True:
            words.append(str(value))
    return shlex.join(words)


def check_options(options: RunOptions) -> None:
    """Checks that options fit together, before anything is written."""
    from sandbox.devices.registry import built_in
    from sandbox.options.touch_devices import guessed_surface, live_maker

    entry = built_in(options.device)
    if entry is None or entry.in_air:
        raise InputError(
            "no such device for a study",
            where="--device",
            got=options.device,
            expected="web, mouse, tuio, evdev, evdev:NODE or simulated",
        )
    if options.device == "simulated" and not options.pilot:
        raise StudyError(
            "a simulated user is nobody's data",
            where="--device simulated",
            remedy="Add --pilot, or use `sandbox study simulate`",
        )
    if options.touches == "web":
        if options.device not in ("web", "mouse"):
            raise InputError(
                "touches come from the page or from elsewhere, not both",
                where="--tablet, --lan",
                got=f"--device {options.device}",
                remedy="Leave one of them out",
            )
        if options.forms == "terminal":
            raise InputError(
                "with trials on the page, forms are there, too",
                where="--forms terminal",
                remedy="Leave it out",
            )
        return
    if options.view == "window" and not has_display():
        raise InputError(
            "no display to open a window on",
            remedy="--device web runs trials on a page, --view none without a view",
        )
    if options.view == "none" and options.device == "mouse":
        raise InputError(
            "the mouse needs a window",
            where="--device mouse",
            remedy="Use --device web or --device tuio",
        )
    maker = (
        live_maker(touch_options(options)) if options.device not in ("mouse", "simulated") else None
    )
    if maker is not None:
        # What is wrong with a device is told now, and not after the forms.
        maker(guessed_surface()).close()


def check_leap(options: RunOptions, design: Design) -> None:
    """Checks the Leap, too, if the design has trials over it."""
    from sandbox.options.leap_devices import open_leap
    from sandbox.study.design.conditions import combinations, values_of
    from sandbox.study.design.plan import in_the_air

    wanted = any(in_the_air(values_of(design, levels)) for levels in combinations(design))
    if wanted and options.device != "simulated":
        open_leap(options.leap_address).close()


def check_second(options: RunOptions, design: Design) -> None:
    """What is wrong with the second hand's device is told now, too, where the design has trials
    for two hands.

    Raises:
        InputError: It is missing, of no trial, or cannot be used beside the first hand's.
    """
    from sandbox.options.touch_devices import guessed_surface, is_evdev, live_maker
    from sandbox.study.design.conditions import PARTNER, combinations, run_settings, values_of
    from sandbox.study.run.run_device import needs_second_device

    given = [values_of(design, levels) for levels in combinations(design)]
    wanted = any(needs_second_device(values, run_settings(values, 0)) for values in given)
    name = options.second_device
    if name is None:
        if wanted and options.device != "simulated":
            raise InputError(
                "the design has trials for two hands, and there is a device for one",
                where="--second-device",
                expected="mouse, tuio, evdev, evdev:NODE or simulated",
                remedy="Or write one_surface = true or second_device = 'simulated' "
                "under [settings] of the design",
            )
        return
    if not wanted:
        raise InputError(
            "no trial of the design needs a second device",
            where="--second-device",
            got=name,
            remedy="Leave it out",
        )
    if name not in ("mouse", "tuio", PARTNER) and not is_evdev(name):
        raise InputError(
            "this device cannot be a second hand's in a study",
            where="--second-device",
            got=name,
            expected="mouse, tuio, evdev, evdev:NODE or simulated",
        )
    if name == options.device and name not in ("tuio", PARTNER):
        raise InputError(
            "one device cannot be both hands'",
            where="--second-device",
            got=name,
            remedy="Name another one, such as evdev:NODE",
        )
    if name == "mouse" and (options.touches == "web" or options.view == "none"):
        raise InputError(
            "the mouse needs a window",
            where="--second-device mouse",
            remedy="Use tuio, evdev or simulated",
        )
    asked = second_touch_options(options)
    maker = live_maker(asked) if asked and name not in ("mouse", PARTNER) else None
    if maker is not None:
        maker(guessed_surface()).close()


def check_page(options: RunOptions) -> None:
    """Serves the page for a moment: a wrong address or certificate costs no participant."""
    if options.has_page:
        from sandbox.cli.common.page_options import open_page

        open_page(where_served(options)).close()


def where_served(options: RunOptions) -> PageOptions:
    """Where the participant's page is."""
    from sandbox.cli.common.page_options import PageOptions

    return PageOptions(
        options.tablet, options.lan, options.page_port, options.tls_cert, options.tls_key
    )


def touch_options(options: RunOptions) -> TouchOptions:
    """Where touches come from."""
    from sandbox.options.touch_devices import TouchOptions

    return TouchOptions(device=options.touches, bind=options.bind, port=options.port)


def second_touch_options(options: RunOptions) -> TouchOptions | None:
    """Where the second hand's touches come from; a second TUIO device listens one port higher."""
    from sandbox.options.touch_devices import TouchOptions

    if options.second_device is None:
        return None
    port = options.port + 1 if options.port and options.device == "tuio" else options.port
    return TouchOptions(device=options.second_device, bind=options.bind, port=port)
