"""Landmarks of simulated hands before a camera, by our own forward model."""

from __future__ import annotations

import json
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np

from encoders.air.camera import Camera
from encoders.air.landmark_fit import OF_POINTS, HandPoints
from models.arithmetic import Array
from models.frames import LandmarkFrame, SeenHand
from models.pose import POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log
from models.skeleton import ADULT, Skeleton
from sandbox.devices.webcam.landmarks import header_record, message_of

SIZE = (640, 480)
PALM_TO_CAMERA = np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]])
"""Rotation in the camera's frame of a right hand that is held up, palm to the camera."""


def held_up(
    bend: float = 25.0, turn: tuple[float, float, float] = (0.0, 0.0, 0.0), away: float = 0.45
) -> Array:
    """(48,) pose in the camera's frame of a hand that is held up, `away` m from the lens.

    Args:
        bend: degrees of the middle joints, which the last ones follow by two thirds.
        turn: rad, rotation vector in the camera's frame.
        away: m.
    """
    q = np.zeros(POSE_SIZE)
    q[ROOT_POSITION] = 0.01, 0.05, away
    q[ROOT_ROTATION] = log(exp(np.array(turn)) @ PALM_TO_CAMERA)
    for knuckle in (2, 5, 8, 11):
        q[6 + 3 * knuckle] = radians(30.0 - 0.4 * bend)
        q[6 + 3 * (knuckle + 1)] = radians(45.0 - bend)
        q[6 + 3 * (knuckle + 2)] = radians(30.0 - 2.0 / 3.0 * bend)
    return q


def landmarks(q: Array, skeleton: Skeleton = ADULT) -> Array:
    """(21, 3) m landmarks of a pose (48,), in its frame; the thumb's IP is half way to its tip."""
    points = np.zeros((21, 3))
    points[list(OF_POINTS)] = HandPoints(skeleton).points(q)
    points[3] = 0.5 * (points[2] + points[4])
    return points


def seen(q: Array, camera: Camera, side: str = "right", skeleton: Skeleton = ADULT) -> SeenHand:
    """What a camera sees of a right hand in a pose (48,) of its frame; `side` is what it says.

    As the engine does, landmarks in space are given as if the hand were in the picture's middle.
    """
    points = landmarks(q, skeleton)
    image = camera.pixels(points, SIZE)
    x, y = camera.rays(image, SIZE).mean(axis=0)
    across = float(np.hypot(x, y))
    turn = np.arctan(across) / across * np.array([-y, x, 0.0])
    space = (points - points.mean(axis=0)) @ exp(turn)
    return SeenHand(
        side,
        0.95,
        tuple((float(x), float(y)) for x, y in image),
        tuple((float(x), float(y), float(z)) for x, y, z in space),
    )


def mirror(hand: SeenHand, side: str = "left") -> SeenHand:
    """The hand as a mirror shows it."""
    image = tuple((SIZE[0] - x, y) for x, y in hand.image)
    return SeenHand(side, hand.score, image, tuple((-x, y, z) for x, y, z in hand.world))


def film(poses: list[Array], camera: Camera, rate: float = 30.0) -> list[LandmarkFrame]:
    """A frame of every pose (48,) in the camera's frame."""
    return [
        LandmarkFrame(i / rate, (seen(q, camera),), SIZE, i / rate, "simulated")
        for i, q in enumerate(poses)
    ]


def film_file(path: Path, camera: Camera, both: bool = False) -> Path:
    """A file of a hand, or of both hands, that bends its fingers for 2 s."""
    poses = [held_up(30.0 + 20.0 * np.sin(i / 10), (0.1, 0.01 * i, 0.0)) for i in range(60)]
    frames = film(poses, camera)
    if both:
        frames = [replace(f, hands=(*f.hands, mirror(f.hands[0]))) for f in frames]
    lines = [header_record(camera), *map(message_of, frames)]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path
