"""What tests of pictures of a hand in the air share."""

from __future__ import annotations

from functools import cache
from typing import Literal

import numpy as np
from PIL import Image

from encoders.paalm import Paalm
from encoders.paalm.joint_angles import PaalmFrame
from models.frames import HandFrame
from sandbox.views.palette import FINGER_COLOURS
from tests.support.leap_hands import take


@cache
def seen(side: Literal["right", "left"] = "right") -> tuple[HandFrame, PaalmFrame]:
    """A frame with five fingers, and what a calibrated PAALM made of it."""
    frames = take(0, side=side).frames
    paalm = Paalm()
    paalm.calibrate(frames, side, 100)
    frame = next(f for f in frames if len(f.hands[0].fingers) == 5)
    return frame, paalm.step(frame)


def colours(picture: Image.Image) -> set[int]:
    """Labels whose finger's colour is in a picture."""
    pixels = np.asarray(picture, float) / 255
    return {
        label
        for label, colour in enumerate(FINGER_COLOURS)
        if (np.abs(pixels - colour).max(axis=2) < 0.03).sum() > 5
    }
