"""A recording as a device. It returns each frame at the step at which the frame took effect."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from models.errors import RecordingError
from models.scene import CONTROL_PERIOD
from sandbox.devices.device import Device
from sandbox.recording.recording import Recording
from sandbox.trial.settings import recorded_settings


class RecordedDevice(Device):
    """Plays one hand of a recording.

    Args:
        recording: A recording from `load_recording`.
        hand: Index of the hand whose frames are played.
    """

    name: str
    lift = True
    plays_file = True
    damage: RecordingError | None

    def __init__(self, recording: Recording, hand: int = 0) -> None:
        self.name = str(recording.path)
        self.damage = (
            RecordingError(recording.damage, where=self.name) if recording.damage else None
        )
        self._timestep = recorded_settings(recording.header, "physics").physics.timestep
        self._inputs = recording.inputs.get(hand, [])
        self._switches = [e for e in recording.events if e.what == "contact"]
        self._next = self._next_switch = 0
        self._now = 0.0
        last = max(recording.hashes, default=0)
        period = round(CONTROL_PERIOD / self._timestep)
        # The last control period begins one period before the end.
        self._last = recording.end["step"] - period if recording.end else last

    def poll(self, now: float) -> Sequence[Any]:
        """Touch frames or hand frames that took effect since the last call, up to now."""
        self._now = now
        step = round(now / self._timestep)
        frames = []
        while self._next < len(self._inputs) and self._inputs[self._next].step <= step:
            frames.append(self._inputs[self._next].frame)
            self._next += 1
        return frames

    def mode_requests(self, now: float) -> Sequence[str]:
        """Contact modes that were requested since the last call, up to now."""
        step = round(now / self._timestep)
        modes = []
        while (
            self._next_switch < len(self._switches)
            and self._switches[self._next_switch].step <= step
        ):
            modes.append(str(self._switches[self._next_switch].details.get("mode")))
            self._next_switch += 1
        return modes

    @property
    def finished(self) -> bool:
        """True once the recorded trial is over, or the device is closed."""
        return self._closed or round(self._now / self._timestep) >= self._last

    def close(self) -> None:
        """Ends playback."""
        super().close()
        self._next, self._next_switch = len(self._inputs), len(self._switches)
