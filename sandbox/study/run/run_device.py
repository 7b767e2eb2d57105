"""Devices of participants: they are opened for each trial, and trials are adapted to the size of
their surfaces.

A camera stays open from the first trial that needs it to the end of the session. A hand over a Leap
is measured before the first trial.
"""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, Literal, cast

from encoders.paalm import Paalm
from encoders.paalm.calibration import PAPER_FRAMES
from encoders.paalm.calibration_file import calibration_to_json
from models.errors import EncoderError, StudyError
from models.frames import LandmarkFrame
from models.surface import Surface
from sandbox.devices.device import Closeable, Device, LandmarkDevice, Place, Sees
from sandbox.devices.leap import DEFAULT_ADDRESS
from sandbox.devices.leap.leap import open_leap
from sandbox.devices.registry import DeviceSettings, kind_of, named_device
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.devices.webcam import webcam_choice
from sandbox.devices.webcam.webcam import WebcamDevice
from sandbox.devices.wrappers.degraded import DegradedDevice
from sandbox.study.design.conditions import PARTNER
from sandbox.study.design.session_plan import TrialStep
from sandbox.study.record.folder import Participant
from sandbox.study.run.forms import Forms, Poll
from sandbox.study.run.page_player import on_both_screens, page_device, settings_for_screen
from sandbox.study.run.runner import FitSettings, OpenDevices
from sandbox.study.run.simulated_study import simulated_devices, simulated_hand
from sandbox.study.run.study_page import StudyPage
from sandbox.trial.assembly import DeviceMaker, DeviceMakers, shared_makers, with_lift
from sandbox.trial.settings import Settings
from sandbox.words import words_in
from tasks.task import Task
from tasks.user import UserConfiguration

SLACK = 0.02
"""Largest relative difference in size between the design's surface and the device's surface."""
TICK = 0.05
"""Time (s) between two checks of inputs of the participant and the experimenter."""
TRIES = 2
"""At most so many frames of a Leap are read for each required frame, since up to half of them may
not show an open hand."""
AGAIN = "`{}` resumes the session at this step"
"""Remedy in the error of a Leap that sends no data."""


def person_devices(
    device: DeviceSettings,
    person: Participant,
    page: StudyPage | None = None,
    leap: str = DEFAULT_ADDRESS,
    second: DeviceSettings | None = None,
    camera: SessionCamera | None = None,
) -> OpenDevices:
    """Returns a function that opens the devices of a trial.

    Args:
        device: Device for touches: `mouse`, `web`, `tuio`, `evdev`, `evdev:NODE` or `simulated`.
        person: The participant. In trials whose design sets a Leap or a camera, the participant
            uses that instead of the device for touches.
        page: Page of device `web`; the page of the second hand belongs to it (`StudyPage.beside`).
        leap: Address of the Leap service.
        second: Device of a second hand; None if no trial needs one.
        camera: The session's camera; None if no trial needs one.
    """
    if device.name == "simulated":
        return simulated_devices(person)

    def opens(
        asked: DeviceSettings, trial: TrialStep, settings: Settings, hand: int
    ) -> DeviceMaker:
        name = asked.name
        if name == PARTNER:
            return simulated_hand(UserConfiguration(), settings, hand, trial.seed)

        def make(task: Task, surface: Surface) -> Device:
            opened: Device
            in_air = settings.hands[hand].in_air
            if in_air is not None and in_air.camera is not None:
                assert camera is not None
                return cast(Device, camera.of_trial())
            if in_air is not None:
                # This trial uses a Leap. It starts when the scene appears, not with a touch.
                return cast(Device, open_leap(leap))
            if page is not None and name == "web":
                opened = page_device(page.pages[hand], surface)
            else:
                place = Place(surface, person=settings.hands[hand].person)
                opened = cast(Device, asked.open(place))
            if settings.variation.degrades_touches:
                noise = trial.seed + hand * NEXT_PERSON
                return DegradedDevice(opened, settings.variation, surface, noise)
            return opened

        return make

    def of_trial(trial: TrialStep, settings: Settings) -> DeviceMakers:
        first = opens(device, trial, settings, 0)
        # With a mouse, keys of the window lift the hands whose devices have no lift control.
        keys = "mouse" in (device.name, second.name if second else "")
        if len(settings.hands) == 1:
            return with_lift((first,), keys)
        if settings.surface.shared:
            return with_lift(shared_makers(first, settings, Sees.TOUCHES), keys)
        if trial.values.get("second_device") == PARTNER:
            asked = DeviceSettings(PARTNER)
        elif before_cameras(settings) == (True, True):
            return shared_makers(first, settings, Sees.CAMERA)
        elif settings.in_air and not any(before_cameras(settings)):
            return shared_makers(first, settings, Sees.LEAP)
        elif second is not None or settings.hands[1].in_air is not None:
            asked = second or device
        else:
            raise StudyError(
                "the trial is for two hands, but only one device is given",
                where=settings.task,
                remedy="Add --second-device",
            )
        return with_lift((first, opens(asked, trial, settings, 1)), keys)

    return of_trial


def needs_second_device(values: Mapping[str, Any], settings: Settings) -> bool:
    """Returns True if a trial needs a second touch device.

    Args:
        values: Values of the trial, by the names of settings in designs.
        settings: Settings of the trial.
    """
    if len(settings.hands) == 1 or settings.surface.shared:
        return False
    return values.get("second_device") != PARTNER and settings.hands[1].in_air is None


def before_cameras(settings: Settings) -> tuple[bool, ...]:
    """For each hand, True if a camera sees it instead of a touch device or a Leap."""
    return tuple(h.in_air is not None and h.in_air.camera is not None for h in settings.hands)


def settings_fitter(
    name: str, page: StudyPage | None = None, second: str = "", camera: SessionCamera | None = None
) -> FitSettings:
    """Returns a function that adapts the settings of a trial to the touch devices.

    The function may wait for the page, and for the camera. It raises a StudyError if the design's
    surface and the device's surface differ in size, or if the surfaces of two hands differ in size.

    Args:
        name: Touch device of the first hand.
        page: Page of device `web`; the page of the second hand belongs to it (`StudyPage.beside`).
        second: Touch device of the second hand; empty if there is none.
        camera: The session's camera; None if no trial needs one.
    """

    def fit(trial: TrialStep, settings: Settings, poll: Poll) -> Settings:
        if camera is not None and any(before_cameras(settings)):
            if page is not None:
                page.wait("camera_open")
            camera.mirrored = webcam_choice(trial.values.get("webcam", "")).mirrored
            camera.wait_until_on(poll)
        fitted = fit_first(trial, settings, poll)
        if not needs_second_device(trial.values, settings):
            return fitted
        if page is not None and page.beside is not None and second == "web":
            page.beside.wait_until_open(poll)
            other = settings_for_screen(page.beside, settings, "surface" in trial.values)
            return on_both_screens(fitted, other)
        check_size(second, fitted, "the surface of the second hand has another size")
        return fitted

    def check_size(device: str, settings: Settings, what: str) -> None:
        native = named_device(device).surface() if device else None
        own = (native.width_in, native.height_in) if native else settings.surface.size_in
        pairs = zip(own, settings.surface.size_in, strict=True)
        if any(abs(a / b - 1.0) > SLACK for a, b in pairs):
            raise StudyError(
                what,
                where="surface",
                got=f"{own[0]:.2f} x {own[1]:.2f} in",
                expected="{:g} x {:g} in".format(*settings.surface.size_in),
                remedy="Write the size of the device into the design, or remove `surface`",
            )

    def fit_first(trial: TrialStep, settings: Settings, poll: Poll) -> Settings:
        designed = "surface" in trial.values
        if settings.hands[0].in_air is not None:
            return settings
        if page is not None and name == "web":
            page.wait_until_open(poll)
            return settings_for_screen(page, settings, designed)
        if (native := named_device(name).surface()) is not None:
            if designed:
                check_size(
                    name, settings, "the touch device has another size than the design's surface"
                )
            return settings.changed(size_in=(native.width_in, native.height_in))
        if kind_of(name).guessed_size:
            # The device reports no size. If the design has none either, the size is a guess, and
            # the recording marks it as not calibrated.
            return settings if designed else settings.changed(calibrated=False)
        return settings

    return fit


def hand_measurer(
    forms: Forms,
    person: Participant,
    address: str,
    say: Callable[[str], object],
    wanted: int = PAPER_FRAMES,
    own: dict[str, str] | None = None,
    again: str = "the same command",
) -> Callable[[Poll], dict[str, Any]]:
    """Returns a function that measures the participant's hand over a Leap, as in PAALM (2013).

    The function repeats the measurement until the hand was held correctly. If the experimenter
    skips it, an average hand is used. It raises a DeviceError if the service sends no data.

    Args:
        forms: Shows the instruction to the participant.
        person: The participant.
        address: Address of the Leap service.
        say: Prints the result for the experimenter.
        wanted: Number of required frames with five fingers; 1000 in the paper, about ten seconds.
        own: The design's own words in the participant's language, by key.
        again: Command that resumes the session; the error names it if the service sends no data.
    """
    text = words_in(person.language, own)["measure_hand"]
    side = cast(Literal["right", "left"], person.hand)

    def measure(poll: Poll) -> dict[str, Any]:
        while True:
            forms.instruct(text, poll)
            device = open_leap(address)
            try:
                frames = islice(device.follow(poll, AGAIN.format(again)), TRIES * wanted)
                calibration = Paalm().calibrate(frames, side, wanted)[side]
            except EncoderError as error:
                say(f"measuring again: {error}")
                continue
            finally:
                device.close()
            lengths = ", ".join(f"{1000 * length:.0f}" for length in calibration.standard)
            say(
                f"measured the {side} hand: fingers of {lengths} mm, from {calibration.frames} "
                "frames"
            )
            return calibration_to_json(calibration)

    return measure


class SessionCamera(Closeable):
    """The camera of a session: one page in a browser, which is opened when a trial first needs it,
    and used for all further trials.

    So the participant allows the camera only once. The camera stays on until the session ends, and
    its page states this. Pictures between trials are discarded.

    Args:
        engine: Folder of the engine (`sandbox.devices.webcam.engine`).
        sides: Sides of the hands that trials follow.
        browse: True opens the page in this machine's browser; False only prints its link.
        say: Prints a line for the experimenter.

    Attributes:
        mirrored: True if the camera's picture is mirrored; read when the page is opened.
    """

    def __init__(
        self, engine: Path, sides: Sequence[str], browse: bool, say: Callable[[str], object]
    ) -> None:
        self.mirrored = False
        self._engine, self._sides, self._browse, self._say = engine, sides, browse, say
        self._device: WebcamDevice | None = None

    def wait_until_on(self, poll: Poll) -> None:
        """Waits until the page sends pictures, and prints the reason for a delay.

        Args:
            poll: See `Poll`; an exception from it ends the wait.

        Raises:
            DeviceError: The page cannot be served.
        """
        device = self._opened()
        # Earlier pictures do not show that the camera is still on.
        device.poll(0.0)
        told: Sequence[str] = ()
        while not device.wait(TICK):
            poll()
            if device.notices not in ((), told):
                told = device.notices
                self._say(", ".join(told))

    def of_trial(self) -> LandmarkDevice:
        """Returns the camera as the device of one trial; it stays on when the trial ends."""
        device = self._opened()
        device.poll(0.0)
        return _StaysOn(device)

    def close(self) -> None:
        """Switches the camera off."""
        if self._device is not None:
            self._device.close()

    def _opened(self) -> WebcamDevice:
        if self._device is None:
            self._device = WebcamDevice(self._engine, self._sides, self.mirrored)
            self._say(f"the camera's page, on this machine only: {self._device.address}")
            if self._browse:
                webbrowser.open(self._device.address)
        return self._device


class _StaysOn(LandmarkDevice):
    """A camera that stays on when a trial ends."""

    lift = True

    def __init__(self, camera: WebcamDevice) -> None:
        self._camera = camera

    @property
    def name(self) -> str:
        """Name of the camera."""
        return self._camera.name

    @property
    def address(self) -> str:
        """Address of the camera's page."""
        return self._camera.address

    @property
    def notices(self) -> Sequence[str]:
        """Notices of the camera."""
        return self._camera.notices

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """Landmarks of the pictures since the last call."""
        return () if self.finished else self._camera.poll(now)
