"""A simulated user before a camera, whose landmarks are where the joints truly are.

No picture is drawn and no engine finds a hand: landmarks are perfect, or wander about the truth,
each by itself and so far (standard deviation along each axis).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from math import exp, sqrt
from typing import Any

import numpy as np

from encoders.air.camera import Camera
from encoders.paalm.angles import angles_of_joints
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.palm import Palm, vector_of
from models.arithmetic import Array
from models.frames import LandmarkFrame, SeenHand
from models.surface import Surface
from sandbox.devices.device import LandmarkDevice
from sandbox.devices.hand_input import HandInput
from sandbox.devices.simulated.in_air import SimulatedLeap
from sandbox.session.messages import Snapshot
from sandbox.trial.driver import play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import HandSettings, Settings
from tasks.task import Task
from tasks.user import UserConfiguration
from tests.encoders.air.seen_hands import SIZE, landmarks

Look = Callable[[Array, float], LandmarkFrame]

_WANDERS = 0.5
"""s after which a landmark's error has become another one, but for 37 % of it."""


class DrawnPerson(LandmarkDevice):
    """A camera before which a simulated user moves a drawn hand.

    The hand has the user's angles and the bones of the average hand.

    Args:
        user: The user, as a device that sees the screen.
        camera: What the camera sees.
        look: Gives what is seen of a pose (48,) in the world at a time, s.
        rate: Hz of the pictures.
        late: s from a picture to its landmarks.

    Attributes:
        pictures, empty: Numbers of pictures, and of those in which no hand was found.
        beside: (21,) pixels of every picture with a hand, from landmarks to where the joints are.
    """

    name = "drawn person"
    lift = True
    takes_snapshots = True
    finished = False

    def __init__(
        self,
        user: SimulatedLeap,
        camera: Camera,
        look: Look,
        rate: float,
        late: float,
    ) -> None:
        self._user, self._camera, self._look = user, camera, look
        self._period, self._late = 1.0 / rate, late
        self._next = 0.0
        self._under_way: deque[LandmarkFrame] = deque()
        self.pictures = self.empty = 0
        self.beside: list[Array] = []

    def show(self, snapshot: Snapshot) -> None:
        """Shows the screen to the user."""
        self._user.show(snapshot)

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """Landmarks of the pictures that are `late` seconds old by now."""
        # The user's hand moves on at every step, whether or not it is in a picture.
        pose = self._pose(now)
        if now >= self._next:
            self._next = max(self._next + self._period, now)
            frame = self._look(pose, now)
            self.pictures += 1
            self.empty += not frame.hands
            if frame.hands:
                true = self._camera.pixels(self._camera.seen(landmarks(pose)), SIZE)
                self.beside.append(np.linalg.norm(frame.hands[0].image - true, axis=1))
            self._under_way.append(frame)
        ready = []
        while self._under_way and self._under_way[0].taken + self._late <= now:
            ready.append(self._under_way.popleft())
        return ready

    def _pose(self, now: float) -> Array:
        origin, rotation, joints = self._user.own_hand(now)
        x, y, z = map(vector_of, rotation.T)
        return hand_pose(angles_of_joints(joints), Palm(vector_of(origin), x, y, z))

    def close(self) -> None:
        """Ends the device; the page goes on."""
        self.finished = True


class Wandering:
    """How far landmarks are beside the truth, which changes slowly.

    Args:
        off: pixels, standard deviation along each axis.
        seed: Seed of its random numbers.
    """

    def __init__(self, off: float, seed: int) -> None:
        self._off, self._rng = off, np.random.default_rng([seed, 21])
        self._now = self._draw()
        self._time = 0.0

    def at(self, time: float) -> Array:
        """(21, 2) pixels, at a later time, s."""
        kept = exp((self._time - time) / _WANDERS)
        self._now = kept * self._now + sqrt(1.0 - kept * kept) * self._draw()
        self._time = time
        return self._now

    def _draw(self) -> Array:
        return self._off * self._rng.standard_normal((21, 2))


def perfect(camera: Camera, off: float = 0.0, seed: int = 0) -> Look:
    """Landmarks where the joints are, or about there, in place of an engine."""
    wandering = Wandering(off, seed)

    def look(pose: Array, at: float) -> LandmarkFrame:
        points = camera.seen(landmarks(pose))
        image, space = camera.pixels(points, SIZE), points - points.mean(axis=0)
        image = image + wandering.at(at)
        hand = SeenHand(
            "right",
            1.0,
            tuple((x, y) for x, y in image.tolist()),
            tuple((x, y, z) for x, y, z in space.tolist()),
        )
        return LandmarkFrame(at, (hand,), SIZE, at, "perfect")

    return look


def play(
    task: str,
    seed: int,
    camera: Camera,
    look: Look,
    rate: float,
    late: float,
    patient: bool = False,
) -> tuple[TrialResult, DrawnPerson]:
    """One trial's result, and its camera."""
    hands = (HandSettings(in_air=HandInput(camera=camera)),)
    settings = Settings(task=task, seed=seed, hands=hands)
    made: list[DrawnPerson] = []

    def make(drawn: Task, surface: Surface) -> Any:
        user = SimulatedLeap(
            drawn,
            UserConfiguration(),
            seed,
            (0.0, 0.0, 0.0),
            patient=patient,
        )
        made.append(DrawnPerson(user, camera, look, rate, late))
        return made[-1]

    result = play_trial(settings, (make,))
    return result, made[-1]
