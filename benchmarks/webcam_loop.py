"""Tasks done by a simulated hand before the real engine: `python -m benchmarks.webcam_loop`.

The simulated user sees the screen and moves the own hand; that hand is drawn with its skin as a
camera would see it, and each picture is shown to the camera's page in Chromium, whose engine finds
hands in it as it does for a person. What it finds drives the sandbox's hand. Simulated time stands
still while a picture is drawn and looked at, and every picture counts `--late` seconds after it was
taken, as on a machine of that speed. Nobody is real: the person, the hand in the picture and the
light are simulated or drawn; the engine is the one that people use. Needs Debian's chromium, OpenGL
and `sandbox webcam install`.

With `--perfect`, landmarks are where the joints truly are, without an engine: what fails
then is not its fault. With `--off PIXELS` beside it they wander about there, each by itself and so
far (standard deviation along each axis): how exact an engine would have to be.

    python -m benchmarks.webcam_loop [--tasks box-to-goal stack] [--seeds 20] [--webcam tilt=30,...]
"""

from __future__ import annotations

import argparse
import io
import os
import time
from collections import deque
from collections.abc import Callable, Sequence
from math import exp, sqrt
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from PIL import Image

from benchmarks.one_line import run
from benchmarks.picture_stream import PictureStream
from benchmarks.webcam_films import HandPainter
from encoders.paalm.angles import angles_of_joints
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.palm import Palm, vector_of
from encoders.webcam.camera import Camera
from models.arithmetic.arrays import Array
from models.frames import LandmarkFrame, SeenHand
from models.surface import Surface
from sandbox.devices.simulated.leap_user import SimulatedLeap
from sandbox.devices.webcam.installed import installed_engine
from sandbox.options.webcam_devices import webcam_choice
from sandbox.recording.recording import load_recording
from sandbox.session.device import LandmarkDevice
from sandbox.session.messages import Snapshot
from sandbox.trial.hand_input import HandInput
from sandbox.trial.headless import run_trial
from sandbox.trial.replay import replay
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import HandSettings, RunSettings
from tasks.task import Task
from tasks.user import UserConfiguration
from tests.encoders.webcam.seen_hands import SIZE, landmarks

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
    has_lift = True
    looks = True
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


def jpeg(picture: Image.Image) -> bytes:
    """A picture as JPEG."""
    data = io.BytesIO()
    picture.save(data, "JPEG", quality=92)
    return data.getvalue()


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
    record: Path | None = None,
) -> tuple[TrialResult, DrawnPerson]:
    """One trial's result, and its camera."""
    hands = (HandSettings(in_air=HandInput(camera=camera)),)
    settings = RunSettings(task=task, seed=seed, hands=hands)
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

    result = run_trial(settings, (make,), record=record)
    return result, made[-1]


def main() -> None:
    """Prints a line for every trial, and a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tasks", nargs="+", default=["box-to-goal", "stack"])
    parser.add_argument("--seeds", type=int, default=20, help="number of seeds")
    parser.add_argument("--first", type=int, default=0, help="the first of them")
    parser.add_argument("--webcam", default="", help="as of `sandbox play`")
    parser.add_argument("--rate", type=float, default=10.0, help="Hz of pictures")
    parser.add_argument("--late", type=float, default=0.1, help="s from a picture to its landmarks")
    parser.add_argument("--perfect", action="store_true", help="true landmarks, no engine")
    parser.add_argument("--patient", action="store_true", help="a user who bears with the engine")
    parser.add_argument(
        "--off",
        type=float,
        default=0.0,
        metavar="PIXELS",
        help="with --perfect: they wander so far",
    )
    parser.add_argument("--record", type=Path, help="folder of recordings, which are replayed")
    options = parser.parse_args()
    if options.off and not options.perfect:
        parser.error("--off is of --perfect landmarks")
    camera = webcam_choice(options.webcam).camera
    found = f"landmarks off by {options.off:g} pixels" if options.off else "perfect landmarks"
    print(
        f"SIMULATED user, DRAWN hand, {found if options.perfect else 'real engine'}; "
        f"{camera}; {options.rate:g} pictures a second, each {options.late:g} s late; "
        f"load {os.getloadavg()[0]:.1f}",
        flush=True,
    )
    if options.perfect:
        table(options, camera, lambda seed: perfect(camera, options.off, seed))
        return
    with HandPainter(camera) as painter, PictureStream(installed_engine()) as stream:
        table(
            options,
            camera,
            lambda _: lambda pose, at: stream.look(jpeg(painter.draw(pose)), at),
        )
        print(f"\na picture took the page {median(stream.milliseconds):.0f} ms (median)")


def table(options: argparse.Namespace, camera: Camera, look: Callable[[int], Look]) -> None:
    """Plays all trials, each with the look of its seed, and prints a line for each and a table."""
    rows = []
    for task in options.tasks:
        times = []
        for seed in range(options.first, options.first + options.seeds):
            began = time.perf_counter()
            record = options.record and options.record / f"{task}-{seed}.jsonl"
            result, device = play(
                task,
                seed,
                camera,
                look(seed),
                options.rate,
                options.late,
                options.patient,
                record,
            )
            times += [result.time_s] if result.success else []
            stretched = (time.perf_counter() - began) / max(result.time_s, 1e-9)
            same = "" if record is None else f", replay exact: {exact(record)}"
            print(
                f"{task} {seed}: {result.status}, {result.time_s:.1f} s, {device.pictures} "
                f"pictures, {device.empty} without a hand; "
                f"{beside(device)}; time stretched {stretched:.1f} times"
                f"{same}",
                flush=True,
            )
        took = f"{median(times):.1f} s" if times else "-"
        rows.append(f"| {task} | {len(times)} of {options.seeds} | {took} |")
    print("\n| task | held | median time |\n| --- | --- | --- |", *rows, sep="\n")


def beside(device: DrawnPerson) -> str:
    """How far the landmarks of a trial were from the joints."""
    if not device.beside:
        return "no landmarks"
    found = np.median(device.beside, axis=0)
    worst = int(found.argmax())
    return (
        f"landmarks {np.median(found):.1f} pixels from the joints, number {worst} "
        f"{found[worst]:.1f} (medians)"
    )


def exact(record: Path) -> bool:
    """True if a recording replays to the bit."""
    _, verdict = replay(load_recording(record))
    return bool(verdict.exact and verdict.complete)


if __name__ == "__main__":
    run(main)
