"""A controller represented as a hand: its grip places the palm, and its trigger closes a pinch of
thumb, index and middle finger.

Controllers do not sense fingers. The points of the hand are therefore those of an average hand
between an open and a closed pinch, according to the trigger.
"""

from __future__ import annotations

from functools import cache
from math import cos, radians, sin

import numpy as np

from encoders.air.joint_fit import KNUCKLES, PALM, TIPS, JointFit, JointFitSettings, JointPoints
from encoders.paalm.hand_pose import PALM_CENTRE
from models.arithmetic import Array, small_product
from models.pose import POSE_SIZE
from models.rotations import quaternion_to_matrix
from models.skeleton import ADULT

_CENTRE = np.array([-0.038, 0.047, -0.055]) + PALM_CENTRE
"""Point (3,) m in the hand's frame, at which the tips meet."""
_AXIS = radians(52.0)
"""Direction (rad from x, in the palm's plane) from the thumb's tip to the fingertips. The resting
thumb of `models.skeleton` faces in this direction."""
_PITCH = 0.019
"""Distance (m) between the tips of index and middle finger."""
_OPEN, _CLOSED = 0.085, 0.010
"""Distance (m) between the centre of the thumb's tip and the middle between the fingertips."""
_BENT = JointFitSettings(free=25.0, steps=40)
"""Settings of the fit. Joints that the tips do not determine stay near the middle of their
ranges."""
_GRIP = {
    "right": np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]),
    "left": np.array([[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]),
}
"""Matrix from the frame of a right hand to the frame of a grip; the matrix of a left grip also
mirrors. WebXR's grip: x points out of the back of a right hand and into the back of a left hand, -z
towards the thumb of a closed hand. The fingers of an open hand then point along -y."""


def controller_points(side: str, trigger: float, position: Array, quaternion: Array) -> Array:
    """(20, 3) m, points of the hand around a controller, in the frame in which its grip is given.

    Args:
        side: `right` or `left`.
        trigger: 0 (open) to 1 (closed).
        position: (3,) m of the grip.
        quaternion: (4,) w, x, y, z of the grip.
    """
    opened, closed = _pinching(_OPEN), _pinching(_CLOSED)
    q = opened + trigger * (closed - opened)
    own = JointPoints(ADULT).points(q) - PALM_CENTRE
    turned = small_product(own, small_product(quaternion_to_matrix(quaternion), _GRIP[side]).T)
    return position + turned


@cache
def _pinching(gap: float) -> Array:
    """The pose (48,) of a hand that pinches with a gap (m) between thumb and fingers."""
    points = JointPoints(ADULT).points(np.zeros(POSE_SIZE))
    wanted = np.full(points.shape, np.nan)
    wanted[list(PALM)] = points[list(PALM)]
    # Ring and little finger stay at rest.
    for place in (*range(KNUCKLES[2], TIPS), TIPS + 3, TIPS + 4):
        wanted[place] = points[place]
    axis = np.array([cos(_AXIS), sin(_AXIS), 0.0])
    beside = 0.5 * _PITCH * np.array([sin(_AXIS), -cos(_AXIS), 0.0])
    wanted[TIPS] = _CENTRE - 0.5 * gap * axis
    wanted[TIPS + 1] = _CENTRE + 0.5 * gap * axis - beside
    wanted[TIPS + 2] = _CENTRE + 0.5 * gap * axis + beside
    fit = JointFit(ADULT, _BENT).fit(wanted)
    assert fit is not None
    return fit.pose
