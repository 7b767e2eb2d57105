"""Options of `sandbox study run`, and checks of their combinations."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from models.errors import InputError, StudyError, unknown_name
from sandbox.cli.common.command_line import picked
from sandbox.server.page_options import PageOptions
from sandbox.views.display import has_display

if TYPE_CHECKING:
    from sandbox.devices.registry import DeviceSettings
    from sandbox.study.design.design import Design

NOT_REPEATED = (
    "file",
    "participant",
    "session",
    "hand",
    "hand_size",
    "language",
    "resume",
    "force_upgrade",
)
"""Options that are not copied to the command that resumes a session."""


@dataclass(frozen=True)
class _Design:
    """The positional argument. It is a base class, so that it comes before all other options."""

    file: Annotated[Path, Parameter(metavar="DESIGN")]
    """Design file."""


@dataclass(frozen=True, kw_only=True)
class StudyRunOptions(PageOptions, _Design):
    """Runs a participant's session: consent, instructions, practice, trials, breaks and forms.

    `sandbox study run design.toml --participant new --tablet` prints a QR code. Scan it with the
    participant's tablet, which then shows the whole session. --device web does the same in a
    browser on this machine. Otherwise trials are in a window, and forms on a page in a browser.

    The terminal is for the experimenter: h and Enter show the keys. If forms are in the terminal,
    too, type a slash before a key.
    """

    participant: Annotated[str, Parameter(metavar="new|ID")] = ""
    """new, or the id of a participant who has begun. Without this option, the ids of unfinished
    participants are listed."""

    out: Annotated[Path, Parameter(metavar="DIR")] = Path("studies")
    """Folder of studies."""

    site: Annotated[str, Parameter(metavar="LETTER")] = "A"
    """Letter of the place of this computer. Each place numbers its own participants, and so has its
    own orders. Folders of several places are merged by copying."""

    mirror: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Folder on a second disk to which every record and recording is copied as it is written. If
    copying fails, the session continues, and the mirror catches up later."""

    pilot: bool = False
    """Rehearse: the data go to a separate folder and never mix with those of the study."""

    device: Annotated[str, Parameter(metavar="DEVICE")] = "mouse"
    """Source of touches. mouse: the mouse in the window. web: the page, also chosen by --tablet.
    tuio: a TUIO sender. evdev, evdev:NODE: a touch screen of this machine. simulated: a simulated
    user, in a pilot only."""

    second_device: Annotated[str | None, Parameter(metavar="DEVICE")] = None
    """Device of the second hand, in tasks for two hands. web: a second page, if the first hand has
    a page. tuio, evdev: as for --device. simulated: a simulated user. Not needed if both hands are
    on one surface (one_surface in the design) or over one Leap."""

    view: Literal["window", "none"] = "window"
    """none: trials without a window, for example if another program shows them. With --device web,
    trials are on the page in any case. Questions are still asked; `sandbox study simulate` runs a
    study without people."""

    forms: Literal["auto", "page", "terminal"] = "auto"
    """Place of consent, instructions, questions and breaks. auto: on the page, or in the terminal
    with --device simulated."""

    no_browser: bool = False
    """Do not open a browser for the page with forms; its link is printed in any case."""

    hand: Literal["right", "left"] = "right"
    """Hand of a new participant."""

    hand_size: float = 1.0
    """Length of a new participant's hand, relative to the hand on which the encoders were trained;
    `sandbox hand measure` measures it."""

    language: str = ""
    """Language of a new participant. Default: the first language of the design."""

    session: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of the session, for designs with several `sessions`. Default: the first unfinished
    session."""

    resume: bool = False
    """Continue an interrupted session without asking."""

    force_upgrade: Annotated[str, Parameter(metavar="REASON")] = ""
    """Continue although program, encoder or design have changed; the reason is recorded."""

    leap: Annotated[str, Parameter(metavar="URL")] = ""
    """WebSocket address of leapd or of the Ultraleap bridge, for trials with `device = "leap"`.
    Default: the usual address of the service."""

    lsl: bool = False
    """Send touches, poses and markers over Lab Streaming Layer (extra `lsl`)."""

    port: int = 3333
    """UDP port for TUIO."""

    bind: Annotated[str, Parameter(metavar="ADDRESS")] = "127.0.0.1"
    """Address for TUIO. 127.0.0.1: reachable from this machine only; 0.0.0.0: from the network."""

    @property
    def touches(self) -> str:
        """Name of the touch device; with --tablet or --lan, `web`."""
        return "web" if self.tablet or self.lan is not None else self.device

    @property
    def leap_address(self) -> str:
        """Address of the Leap service."""
        from sandbox.devices.leap import DEFAULT_ADDRESS

        return self.leap or DEFAULT_ADDRESS

    @property
    def has_page(self) -> bool:
        """True if the participant gets a page."""
        auto = self.forms == "auto" and self.device != "simulated"
        return self.touches == "web" or self.forms == "page" or auto


def again(options: StudyRunOptions, ppid: str) -> str:
    """Returns the command that resumes a participant's session."""
    words = ["sandbox", "study", "run", str(options.file), "--participant", ppid]
    for option in fields(options):
        value = getattr(options, option.name)
        if option.name in NOT_REPEATED or value == option.default:
            continue
        words.append("--" + option.name.replace("_", "-"))
        if value is not True:
            words.append(str(value))
    return shlex.join(words)


def check_options(options: StudyRunOptions) -> None:
    """Checks that the options can be combined, before anything is written.

    Raises:
        InputError: Options cannot be combined, or a device cannot be opened.
        StudyError: A simulated user would be a real participant.
    """
    from sandbox.devices.device import Place
    from sandbox.devices.files.touch_files import guessed_surface
    from sandbox.devices.registry import DEVICES, built_in

    entry = built_in(options.device)
    if entry is None or entry.kind.in_air:
        names = [name for name, known in DEVICES.items() if not known.kind.in_air]
        raise unknown_name("no such device for a study", options.device, names, where="--device")
    if options.device == "simulated" and not options.pilot:
        raise StudyError(
            "a simulated user cannot be a participant",
            where="--device simulated",
            remedy="Add --pilot, or use `sandbox study simulate`",
        )
    if options.touches == "web":
        if options.device not in ("web", "mouse"):
            raise InputError(
                "touches come from the page or from another device, but not from both",
                where="--tablet, --lan",
                got=f"--device {options.device}",
                remedy="Leave out one of these options",
            )
        if options.forms == "terminal":
            raise InputError(
                "with trials on the page, forms are on the page, too",
                where="--forms terminal",
                remedy="Leave out --forms",
            )
        return
    if options.view == "window" and not has_display():
        raise InputError(
            "no display to open a window on",
            remedy="Use --device web for trials on a page, or --view none for no view",
        )
    if options.view == "none" and options.device == "mouse":
        raise InputError(
            "the mouse needs a window",
            where="--device mouse",
            remedy="Use --device web or --device tuio",
        )
    if options.device not in ("mouse", "simulated"):
        # The device is opened once, so that its errors are reported now and not after the forms.
        touch_device(options).open(Place(guessed_surface())).close()


def check_leap(options: StudyRunOptions, design: Design) -> None:
    """Checks that the Leap can be opened, if the design has trials over a Leap."""
    from sandbox.devices.leap.leap import open_leap
    from sandbox.study.design.conditions import every_values
    from sandbox.study.design.session_plan import over_a_leap

    if options.device != "simulated" and any(map(over_a_leap, every_values(design))):
        open_leap(options.leap_address).close()


def check_camera(options: StudyRunOptions, design: Design) -> Path | None:
    """Finds the engine that finds hands in pictures; None if the design needs no camera.

    Raises:
        InputError: The engine is not installed, or a simulated participant would need a camera.
    """
    from sandbox.devices.webcam.engine import installed_engine
    from sandbox.study.design.conditions import uses_camera

    if not uses_camera(design):
        return None
    if options.device == "simulated":
        raise InputError(
            "a simulated user has no camera",
            where="--device simulated",
            expected='a design without device = "webcam"',
        )
    return installed_engine()


def check_second_device(options: StudyRunOptions, design: Design) -> None:
    """Checks the device of the second hand.

    Raises:
        InputError: The device is missing, is not needed, or cannot be used with the first device.
    """
    from sandbox.devices.device import Place
    from sandbox.devices.files.touch_files import guessed_surface
    from sandbox.devices.registry import named_device
    from sandbox.study.design.conditions import PARTNER, every_values, run_settings
    from sandbox.study.run.run_device import needs_second_device

    wanted = any(needs_second_device(v, run_settings(v, 0)) for v in every_values(design))
    name = options.second_device
    if name is None:
        if wanted and options.device != "simulated":
            raise InputError(
                "the design has trials for two hands, but there is a device for only one of them",
                where="--second-device",
                expected="web, mouse, tuio, evdev, evdev:NODE or simulated",
                remedy="Add --second-device, or write one_surface = true or "
                "second_device = 'simulated' under [settings] of the design",
            )
        return
    if not wanted:
        raise InputError(
            "no trial of the design needs a second device",
            where="--second-device",
            got=name,
            remedy="Leave out --second-device",
        )
    if name == "web":
        if options.touches != "web":
            raise InputError(
                "the second hand can use a page only if the first hand uses a page",
                where="--second-device web",
                got=f"--device {options.device}",
                remedy="Use --tablet or --device web for the first hand",
            )
        return
    kind = named_device(name, "--second-device").entry.kind
    if name not in ("mouse", PARTNER) and (kind.in_scene or kind.in_air or not kind.live):
        raise InputError(
            "this device cannot be the second device of a study",
            where="--second-device",
            got=name,
            expected="a live device of touches, the mouse or simulated",
        )
    if name == options.device and name not in ("tuio", PARTNER):
        raise InputError(
            "one device cannot be used for both hands",
            where="--second-device",
            got=name,
            remedy="Name another device, such as evdev:NODE",
        )
    if name == "mouse" and (options.touches == "web" or options.view == "none"):
        raise InputError(
            "the mouse needs a window",
            where="--second-device mouse",
            remedy="Use web, tuio, evdev or simulated",
        )
    asked = second_touch_device(options)
    if asked and name not in ("mouse", PARTNER):
        asked.open(Place(guessed_surface())).close()


def check_page(options: StudyRunOptions) -> None:
    """Checks address and certificate of the page by serving it for a moment."""
    if options.has_page:
        from sandbox.play.pages import open_page

        open_page(options).close()


def touch_device(options: StudyRunOptions) -> DeviceSettings:
    """The touch device of the first hand.

    Raises:
        InputError: An option of another device is given.
    """
    return _touch_device(options, options.touches)


def second_touch_device(options: StudyRunOptions) -> DeviceSettings | None:
    """The touch device of the second hand; None without one.

    If both hands use TUIO, the port of the second device is one higher.
    """
    if options.second_device is None:
        return None
    port = options.port + 1 if options.port and options.device == "tuio" else options.port
    return _touch_device(options, options.second_device, port=port)


def _touch_device(options: StudyRunOptions, name: str, **changes: Any) -> DeviceSettings:
    from sandbox.cli.common.touch_options import TouchOptions

    return picked(TouchOptions, options, device=name, **changes).settings
