"""A demonstration: the simulated user plays a person's own trial.

It is played in a process of its own at low priority, so that the trial is not slowed down, and the
page gets it as frames when it is finished. A task that the simulated user cannot play, or does not
finish, has none.

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

from sandbox.server.page_frames import BodyKinematics, pack, state_of
from sandbox.server.protocol import DEMONSTRATION_KIND, PROTOCOL
from sandbox.session.messages import ObjectView, Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import View, open_trial
from sandbox.trial.settings import Settings, decoded, encoded

PERIOD = 0.05
"""Simulated time (s) between two frames of a demonstration."""
MOST_FRAMES = 90
"""Largest number of frames for a page; from longer demonstrations, only every nth frame is sent."""
STIRRED, TURNED = 0.002, 0.05
"""Displacement (m), and change of an entry of the rotation matrix, by which an object has moved."""
NICE = 15
"""Priority of the process, as of `nice`."""

_HEADER = struct.Struct("<BBHI")


def demonstrated(settings: Settings, scene: int) -> bytes:
    """The message with frames of the simulated user's play, from its first touch to its success.

    Attempts that moved no object, such as a chord beside its keys, are left out, since they show a
    person a mistake.

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

    own = replace(settings, device=Settings().device, second_device=None)
    with open_trial(own, make_views=make_views) as trial:
        trial.run(stop=lambda: trial.session.scorer.score.held)
        if not trial.session.scorer.score.held:
            return b""
    frames = film[0].frames
    chosen = frames[:: -(-len(frames) // MOST_FRAMES)]
    head = _HEADER.pack(PROTOCOL, DEMONSTRATION_KIND, len(chosen), scene)
    return head + b"".join(struct.pack("<I", len(frame)) + frame for frame in chosen)


class _Film:
    """Frames of a trial from the first touch that moved an object.

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
        """Takes a frame, if one is due."""
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
    """True if an object lies elsewhere than before; False without objects before."""
    return any(
        np.abs(now[name].position - view.position).max() > STIRRED
        or np.abs(now[name].rotation - view.rotation).max() > TURNED
        for name, view in before.items()
    )


class Demonstrator:
    """Plays demonstrations, one at a time; a newer demonstration ends the previous one.

    Args:
        show: Called with the message of a demonstration that is finished, from another thread.
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
        """Ends the demonstration that is being played."""
        if self._process is not None:
            self._process.kill()
            self._process = None


def main() -> None:
    """Plays the demonstration of the settings on stdin, and writes its message to stdout."""
    with suppress(AttributeError, OSError):  # Windows has no such priority.
        os.nice(NICE)
    given = json.load(sys.stdin.buffer)
    # All other output goes elsewhere.
    out, sys.stdout = sys.stdout, sys.stderr
    out.buffer.write(demonstrated(decoded(given["settings"]), given["scene"]))
    out.buffer.flush()


if __name__ == "__main__":
    main()
