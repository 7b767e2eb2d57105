"""A demonstration: the simulated user plays the trial that a person is about to play.

It is played in a separate process at low priority, so that it does not slow down the person's
trial. When it is finished, the page gets its frames. There is no demonstration if the simulated
user cannot play the task, or does not succeed.

    python -m sandbox.play.demonstration    # settings on stdin, frames on stdout
"""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np

from sandbox.devices.registry import DeviceSettings
from sandbox.devices.simulated import SimulatedOptions
from sandbox.server.page_frames import BodyKinematics, pack, state_of
from sandbox.server.protocol import DEMONSTRATION_KIND, PROTOCOL
from sandbox.session.messages import ObjectView, Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import View, open_trial
from sandbox.trial.settings import Settings, decoded, encoded
from tasks.user import UserConfiguration

PERIOD = 0.05
"""Simulated time (s) between two frames of a demonstration."""
MOST_FRAMES = 90
"""Largest number of frames for a page. Of a longer demonstration, only every nth frame is sent."""
STIRRED, TURNED = 0.002, 0.05
"""Smallest displacement (m), and smallest change of an entry of the rotation matrix, with which an
object counts as moved."""
NICE = 15
"""Priority of the process, as for the command `nice`."""

_HEADER = struct.Struct("<BBHI")


def demonstrated(settings: Settings, scene: int) -> bytes:
    """The message with frames of the simulated user's play, from its first touch to its success.

    Touches that moved no object are left out, since they would show a mistake.

    The layout is little-endian: PROTOCOL, KIND and the number of frames (uint8, uint8, uint16),
    the number of the scene (uint32), then for every frame its length (uint32) and its bytes.

    Args:
        settings: Settings of the person's trial; its devices are not opened.
        scene: Number of the scene that the frames are for.

    Returns:
        The message; empty without a success.
    """
    film: list[_Film] = []

    def make_views(session: Session) -> list[View]:
        film.append(_Film(scene, BodyKinematics(session.scene)))
        return [film[0].show]

    # The first touch has no common aiming error.
    user = UserConfiguration(kind="demonstrating", aim_error=0.0)
    device = DeviceSettings(options=SimulatedOptions(user))
    second = device if settings.second_device else None
    own = replace(settings, device=device, second_device=second)
    # The fingers that the user has put down are shown. The paper's own pipeline keeps its labels.
    if own.pipeline.labels == "population":
        own = own.changed(labels="device")
    with open_trial(own, make_views=make_views) as trial:
        trial.run(stop=lambda: trial.session.scorer.score.held)
        if not trial.session.scorer.score.held:
            return b""
    frames = film[0].frames
    chosen = frames[:: -(-len(frames) // MOST_FRAMES)]
    head = _HEADER.pack(PROTOCOL, DEMONSTRATION_KIND, len(chosen), scene)
    return head + b"".join(struct.pack("<I", len(frame)) + frame for frame in chosen)


class _Film:
    """Collects the frames of a trial, from the first touch that moves an object.

    Args:
        scene: Number of the scene that the frames are for.
        poses: Poses of the scene's bodies.
    """

    def __init__(self, scene: int, poses: BodyKinematics) -> None:
        self.frames: list[bytes] = []
        self._scene, self._poses = scene, poses
        self._due = 0.0
        self._touched = False
        self._objects: Mapping[str, ObjectView] = {}

    def show(self, snapshot: Snapshot) -> None:
        """Adds a frame if the next frame is due."""
        touches = any(hand.contacts for hand in snapshot.hands)
        if touches and not self._touched and not _moved(self._objects, snapshot.objects):
            self.frames, self._objects, self._due = [], snapshot.objects, snapshot.time
        self._touched = touches
        if not (touches or self.frames) or snapshot.time < self._due:
            return
        self._due = snapshot.time + PERIOD
        poses = self._poses(snapshot.qpos)
        self.frames.append(
            bytes(pack(self._scene, 0, snapshot.time, poses, state_of(snapshot, "")))
        )


def _moved(before: Mapping[str, ObjectView], now: Mapping[str, ObjectView]) -> bool:
    """True if an object is at another place than before; False without earlier objects."""
    return any(
        np.abs(now[name].position - view.position).max() > STIRRED
        or np.abs(now[name].rotation - view.rotation).max() > TURNED
        for name, view in before.items()
    )


class Demonstrator:
    """Plays demonstrations, one at a time. A new demonstration ends the previous demonstration.

    Args:
        show: Called from another thread with the number of the scene and the message of a finished
            demonstration.
    """

    def __init__(self, show: Callable[[int, bytes], None]) -> None:
        self._show = show
        self._process: subprocess.Popen[bytes] | None = None
        self._waits: threading.Thread | None = None

    @property
    def playing(self) -> bool:
        """True until the last requested demonstration is shown, or has failed."""
        return self._waits is not None and self._waits.is_alive()

    def begin(self, settings: Settings, scene: int) -> None:
        """Begins to play a demonstration for a scene, and returns at once."""
        self.stop()
        process = subprocess.Popen(
            [sys.executable, "-m", "sandbox.play.demonstration"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        self._process = process
        given = json.dumps({"settings": encoded(settings), "scene": scene}).encode()

        def wait() -> None:
            message, _ = process.communicate(given)
            if process.returncode == 0 and message:
                self._show(scene, message)

        self._waits = threading.Thread(target=wait, name="demonstration", daemon=True)
        self._waits.start()

    def stop(self) -> None:
        """Ends the demonstration that is playing now."""
        if self._process is not None:
            self._process.kill()
            self._process = None


def main() -> None:
    """Plays the demonstration of the settings on stdin, and writes its message to stdout."""
    with suppress(AttributeError, OSError):  # Windows has no such priority.
        os.nice(NICE)
    given = json.load(sys.stdin.buffer)
    # Only the message may go to stdout; all other output goes to stderr.
    out, sys.stdout = sys.stdout, sys.stderr
    out.buffer.write(demonstrated(decoded(given["settings"]), given["scene"]))
    out.buffer.flush()


if __name__ == "__main__":
    main()
