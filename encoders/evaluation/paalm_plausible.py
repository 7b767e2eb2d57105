"""Plausibility of PAALM on recordings without a truth: what no real hand does, counted.

The first software reports no joints, so that angles on its recordings cannot be judged. But a hand
whose knuckles are bent backwards as far as they go, or whose fingers are claws, is wrong; so is a
pose whose fingertips are not where the device saw them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from encoders.paalm.average import average_calibration, calibrate_on_recording
from encoders.paalm.chain import FINGER_LIMITS
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.options import PaalmOptions
from encoders.paalm.paalm import Paalm
from models.errors import EncoderError
from models.frames import FINGERS, SIDES, HandFrame
from models.kinematics import Kinematics
from models.skeleton import ADULT

NEAR = 3.0
"""Degrees from the limit of a joint within which it is at its limit."""
CLAW = (-10.0, 45.0)
"""Degrees: a finger with at most this MCP flexion and over this PIP flexion is a claw."""


@dataclass(frozen=True)
class Plausibility:
    """Shares of the seen fingers of a recording, thumbs left out.

    Attributes:
        fingers: Number of seen fingers, over all frames.
        backward: Share whose knuckle is at its backward limit.
        claws: Share that are claws.
        at_limit: Share with another joint at a limit other than straight.
        tips: m, 95th percentile of the distance from the pose's fingertip, of an average hand, to
            where the device saw it.
        remark: Why an average hand stood in for the recorded one; empty if it did not.
    """

    fingers: int
    backward: float
    claws: float
    at_limit: float
    tips: float
    remark: str


def plausibility(
    frames: Sequence[HandFrame], options: PaalmOptions | None = None, live: bool = False
) -> Plausibility:
    """Judges PAALM on all hands of a recording.

    Args:
        frames: Its frames.
        options: Options of PAALM.
        live: True solves them as if they came from the device: nothing is known of later frames.

    Raises:
        EncoderError: No finger is seen in it.
    """
    paalm = Paalm(options)
    remark = ""
    if live:
        paalm.use({side: average_calibration([], side, options) for side in SIDES})
    else:
        remark = calibrate_on_recording(paalm, frames, "both")
    skeletons = {"right": ADULT, "left": ADULT.mirrored()}
    tips_of = {side: Kinematics(skeletons[side]) for side in SIDES}
    rows: list[tuple[float, ...]] = []
    off: list[float] = []
    for frame in frames:
        for side, hand in paalm.step(frame).hands.items():
            if not hand.seen:
                continue
            tips = tips_of[side].tips(hand_pose(hand.table, hand.palm, side))
            # Ids of fingers are unique within a hand only.
            own = next(h for h in frame.hands if h.id == hand.hand_id)
            seen = {f.id: f.end for f in own.fingers}
            for finger in range(1, len(FINGERS)):
                id_ = hand.ids[FINGERS[finger]]
                if id_ is not None:
                    rows.append(tuple(hand.table[finger].tolist()))
                    off.append(float(np.linalg.norm(tips[finger] - seen[id_])))
    if not rows:
        raise EncoderError("no finger is seen in this recording")
    flexion, spread, pip, dip = np.array(rows).T
    low, high = FINGER_LIMITS.flexion
    other = (
        (flexion > high - NEAR)
        | (spread < FINGER_LIMITS.spread[0] + NEAR)
        | (spread > FINGER_LIMITS.spread[1] - NEAR)
        | (pip > FINGER_LIMITS.pip[1] - NEAR)
        | (dip > FINGER_LIMITS.dip[1] - NEAR)
    )
    return Plausibility(
        len(rows),
        float((flexion < low + NEAR).mean()),
        float(((flexion <= CLAW[0]) & (pip > CLAW[1])).mean()),
        float(other.mean()),
        float(np.percentile(off, 95)),
        remark,
    )
