"""Opens the screen of a simulated user."""

from __future__ import annotations

from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.trial.device_makers import DeviceMaker
from sandbox.trial.settings import Settings
from sandbox.trial.surfaces import home


def simulated_maker(settings: Settings, hand: int) -> DeviceMaker:
    """A maker of a simulated user's screen.

    Args:
        settings: Settings of the run.
        hand: Index of the hand in `settings.hands`.
    """
    device = settings.device_of(hand)
    user = device.user
    assert user is not None
    return lambda task, surface: SimulatedDevice(
        task,
        user,
        surface,
        settings.seed,
        settings.pipeline.labels == "device",
        device.options.drop_outs,
        settings.hands[hand].person,
        hand,
        home(hand, settings, surface),
    )
