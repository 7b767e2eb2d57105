"""The player's profile: use of its valid parts, and addition of new layouts."""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.text import Text

from models.errors import InputError
from sandbox.devices.registry import LIVE_LEAP, is_in_air
from sandbox.session.own_layouts import learned_layouts
from sandbox.session.session import Session
from sandbox.trial.profiles import (
    chosen_calibration,
    find_profile,
    load_profile,
    own_calibration_path,
    profile_path,
    save_profile,
    uses_touch_profile,
)
from sandbox.trial.trial_options import TrialOptions

Options = TypeVar("Options", bound=TrialOptions)


def with_measured_hand(options: Options, console: Console, ask: bool | None = None) -> Options:
    """Options with the calibration of the player's hand over a Leap.

    If a calibration is saved, it is used. Otherwise the program asks the player to hold the hand
    open, and measures it. Ctrl-C skips the measurement; an average hand is then assumed.

    Args:
        options: Options of `sandbox play`.
        console: Console for instructions.
        ask: True if the program may ask the player; None: True on a terminal.
    """
    if (
        options.device != LIVE_LEAP
        or options.profile == "none"
        or chosen_calibration(options) is not None
    ):
        return options
    # Imported here, since only players with a Leap need these modules.
    from encoders.paalm.calibration_file import read_calibration
    from sandbox.devices.leap import DEFAULT_ADDRESS
    from sandbox.devices.leap.guided_calibration import measure_and_save

    side = options.hand or "right"
    path = own_calibration_path()
    given = options.device_options
    calibrated = replace(options, device_options={**given, "calibration": path})
    if path.exists() and side in read_calibration(path):
        console.print(f"calibration of your {side} hand: {path}", soft_wrap=True)
        return calibrated
    if ask is None:
        ask = sys.stdin.isatty() and console.is_terminal
    if ask and measure_and_save(given.get("leap", DEFAULT_ADDRESS), side, path, console):
        return calibrated
    return options


def with_usable_profile(options: Options, console: Console) -> Options:
    """Options without the invalid parts of the profile. One line is printed about these parts.

    Raises:
        InputError: There is no such file, or it is a Leap calibration.
    """
    if not uses_touch_profile(options):
        return options
    name = str(options.profile)
    try:
        profile = find_profile(name)
    except InputError as error:
        if not profile_path(name).exists():
            raise
        usable = _with_person_alone(options, name)
        rest = "without the profile" if usable is None else "with only its hand, size and seat"
        _say(f"{error}. Play continues {rest}", console)
        return usable or replace(options, profile="none")
    learned = profile.layouts and options.labels == "population"
    if learned and options.hand not in (None, profile.person.hand):
        _say(
            f"the layouts of the profile are of the {profile.person.hand} hand, so they are not "
            f"used for the {options.hand} hand",
            console,
        )
    return options


def _with_person_alone(options: Options, name: str) -> Options | None:
    """Options with hand, size and seat of a profile; None if they cannot be read."""
    try:
        person = find_profile(name, with_layouts=False).person
    except InputError:
        return None
    known: dict[str, Any] = asdict(person)
    alone = replace(options, profile="none")
    return replace(alone, **{k: v for k, v in known.items() if getattr(options, k) is None})


def _say(text: str, console: Console) -> None:
    console.print(Text(text, style="yellow"), soft_wrap=True)


@dataclass
class Learner:
    """Adds layouts of five fingers from a player's trials to the profile, for later trials.

    Attributes:
        path: File of the profile.
        console: Console for messages.
    """

    path: Path
    console: Console

    @classmethod
    def of(cls, options: TrialOptions, console: Console) -> Learner:
        """The learner of the options' profile.

        Raises:
            InputError: With these options, no layouts can be learned.
        """
        if options.labels != "population":
            raise InputError(
                "layouts of five fingers are used only by --labels population",
                where="--learn",
                got=f"--labels {options.labels}",
                expected="--labels population",
            )
        if options.device == "mouse" or is_in_air(options.device):
            raise InputError(
                "layouts can only be learned from fingers on a touch surface",
                where="--learn",
                got=f"--device {options.device}",
                expected="tuio, evdev or web",
            )
        if options.profile in (None, "none"):
            raise InputError(
                "there is no profile to which layouts can be added",
                where="--learn",
                remedy="`sandbox hand measure` writes a profile",
            )
        learner = cls(profile_path(str(options.profile)), console)
        profile = load_profile(learner.path)
        if profile.simulated != (options.device == "simulated"):
            raise InputError(
                "a simulated person and a real person cannot share a profile",
                where="--learn",
                got=f"--device {options.device} and a profile of "
                + ("a simulated person" if profile.simulated else "a real person"),
                remedy="Choose another --profile",
            )
        return learner

    def after(self, session: Session) -> None:
        """Stores the layouts of the profile's hand that were found in a trial."""
        profile = load_profile(self.path)
        side = profile.person.hand
        layouts = learned_layouts(session).get(side)
        if layouts is None or session.first_rig.hand.name != side:
            return
        save_profile(replace(profile, layouts=layouts), self.path)
        self.console.print(
            f"{len(layouts)} layouts of five fingers are stored in {self.path}", soft_wrap=True
        )
