"""SIMULATED pictures of a camera over a tablet: landmarks of a simulated person's hand, projected.

No picture is rendered and no landmark engine runs. The landmarks are those of our hand model, with
errors that are correlated in time. The simulation tests the conversion. It does not measure how
well an engine finds hands; `benchmarks.camera_touches` at commit db485e42 measured that with films
of the drawn hand.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan, exp, hypot, sqrt

import numpy as np

from encoders.air.camera import Camera
from encoders.air.landmark_fit import OF_POINTS, HandPoints
from encoders.captures.paired.simulated_pair import PairedSession
from models.arithmetic import Array
from models.frames import LANDMARKS, LandmarkFrame, SeenHand
from models.rotations import exp as turned

SIZE = (640, 480)


@dataclass(frozen=True)
class OverheadConfiguration:
    """The camera and its errors.

    Attributes:
        camera: The camera, in a world whose origin is the middle of the surface.
        rate: Picture rate (Hz).
        bias: Standard deviation (px) of a landmark's constant error.
        noise: Standard deviation (px) of a landmark's varying error.
        lasts: Time constant (s) of the varying error.
        latency: Delay (s) from exposure to the picture's time stamp; it cannot be measured.
        works: Constant part (s) of the time that the page takes to find the hand.
        jitter: Mean (s) of the random, exponentially distributed part of that time.
        zero: Time (s) that the page's clock shows when the host's clock shows 0.
    """

    camera: Camera = field(
        default_factory=lambda: Camera(60.0, (0.0, -0.24, 0.48), 67.0, pan=180.0)
    )
    rate: float = 12.5
    bias: float = 1.5
    noise: float = 2.0
    lasts: float = 0.3
    latency: float = 0.04
    works: float = 0.09
    jitter: float = 0.008
    zero: float = 250.0


FROZEN_OVERHEAD = OverheadConfiguration()


@dataclass(frozen=True)
class OverheadPictures:
    """Messages of the camera's page.

    Attributes:
        frames: Landmarks, with two times on the page's clock: `taken` when the browser received
            the picture, `time` when the hand was found.
        arrived: (n,) s, arrival times on the host's clock.
        corners: (4, 2) px, the surface's corners: top left, top right, bottom right, bottom left.
        configuration: The camera.
    """

    frames: tuple[LandmarkFrame, ...]
    arrived: Array
    corners: Array
    configuration: OverheadConfiguration


def simulate_overhead(
    session: PairedSession,
    seed: int,
    configuration: OverheadConfiguration = FROZEN_OVERHEAD,
) -> OverheadPictures:
    """Pictures of a simulated person's whole session.

    Args:
        session: The person's touches and motion.
        seed: Seed of the errors.
        configuration: The camera.
    """
    c = configuration
    rng = np.random.default_rng([seed, 0xCA3E])
    end = float(session.motion[0][-1])
    times = np.arange(0.0, end, 1.0 / c.rate)
    surface = session.surface.centred_at((0.0, 0.0, 0.0))
    hand = HandPoints(session.skeleton)
    keep = exp(-1.0 / c.rate / c.lasts)
    bias = rng.normal(0.0, c.bias, (LANDMARKS, 2))
    error = rng.normal(0.0, c.noise, (LANDMARKS, 2))
    frames, arrived, left = [], [], session.side == "left"
    for time, q in zip(times.tolist(), session.poses_at(times), strict=True):
        points = np.zeros((LANDMARKS, 3))
        points[list(OF_POINTS)] = hand.points(q)
        points[3] = 0.5 * (points[2] + points[4])
        world = points + surface.corner
        if left:
            # The session stores a left hand as a right hand, mirrored about the surface's middle.
            world = world * [-1.0, 1.0, 1.0]
        seen = c.camera.seen(world)
        error = keep * error + sqrt(1.0 - keep * keep) * rng.normal(0.0, c.noise, error.shape)
        image = c.camera.pixels(seen, SIZE) + bias + error
        works = c.works + float(rng.exponential(c.jitter))
        taken = time + c.latency
        frames.append(
            LandmarkFrame(
                round(c.zero + taken + works, 5),
                (_seen(session.side, image, seen, c.camera),),
                SIZE,
                round(c.zero + taken, 5),
                "simulated camera",
            )
        )
        arrived.append(taken + works + float(rng.exponential(0.001)))
    w, h = surface.size.tolist()
    corners = surface.to_world(np.array([[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]]))
    return OverheadPictures(
        tuple(frames), np.array(arrived), c.camera.pixels(c.camera.seen(corners), SIZE), c
    )


def _seen(side: str, image: Array, points: Array, camera: Camera) -> SeenHand:
    """The hand as an engine reports it. The landmarks in space are rotated as if the hand were in
    the middle of the picture."""
    x, y = camera.rays(image, SIZE).mean(axis=0).tolist()
    across = max(hypot(x, y), 1e-9)
    axis = atan(across) / across * np.array([-y, x, 0.0])
    space = (points - points.mean(axis=0)) @ turned(axis)
    pixels = tuple((x, y) for x, y in image.round(2).tolist())
    metres = tuple((x, y, z) for x, y, z in space.round(5).tolist())
    return SeenHand(side, 0.95, pixels, metres)
