"""The second subject's hand: bones, joints and forward kinematics.

This module shares no code with `models.kinematics` or with the first subject. Only the meaning of
the 48 numbers is common: frames, order of joints and the flexions at which a joint counts as zero
are those of `models.skeleton`, so that angles can be compared.

A finger is a planar chain on a saddle joint. The knuckle swings sideways by one angle, and all
three joints then bend in the resulting plane. The thumb has two bones, and also rolls about the
line from its saddle joint to its tip, which does not move the tip. So the position of a fingertip
has a closed form, and so have most angles with which a finger reaches a point (`reach.py`).

Fingers are 8 to 10 % longer than those of the first subject. The palm is 3 % shorter and 11 %
narrower, and the base of the thumb is nearer to the wrist and turned farther outwards. Finger
lengths of adults vary by 6 to 11 % about their mean (Chatzioglou, Pinar, Govsa 2024, Anat Cell Biol
57, 172-182: thumb 49.5 +- 5.5 mm, middle finger 70.7 +- 5.2 mm), so these proportions are possible
for another person. Index, ring and little finger have 0.92, 0.94 and 0.77 of the length of the
middle finger; in that article, they have 0.90, 0.93 and 0.75.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.pose import BALL_JOINTS, JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION

ANGLES = ("swing", "first", "second", "roll", "last")
"""Angles of a finger (rad): `swing`, sideways at the knuckle, positive towards the thumb; `first`,
flexion of the knuckle; `second`, flexion of the middle joint; `roll`, about the line from knuckle
to tip, for the thumb only; `last`, flexion of the last joint in addition to that caused by the
middle joint (`TENDON`). Flexions count from the straight finger, and the thumb's `first` from its
resting direction."""
SWING, FIRST, SECOND, ROLL, LAST = range(5)

TENDON = np.array([0.0, 0.62, 0.62, 0.60, 0.55])
"""Flexion of the last joint per flexion of the middle joint, since both share a tendon."""


def _radians(*rows: tuple[float, ...]) -> Array:
    return np.deg2rad(np.array(rows))


@dataclass(frozen=True)
class SecondHand:
    """A right hand. Arrays have one row per finger, the thumb first; lengths are m, angles rad.

    Attributes:
        name: Name in captures.
        knuckle: (5, 3) positions of the knuckles in the hand frame: origin at the wrist, y along
            the fingers, z out of the back of the hand, x towards the little finger.
        saddle: (5, 3, 3) rotations, hand from knuckle. At a zero joint, the first bone is along the
            knuckle's y axis.
        bones: (5, 3) lengths of the bones, of the last bone to the middle of the fingertip; the
            third length of the thumb is 0.
        zero: (5, 3) flexion at which each joint counts as zero.
        tip_radius: (5,) radii of the fingertips.
        reach_limits: (2, 5, 5) least and greatest `ANGLES` of voluntary movements.
    """

    name: str
    knuckle: Array
    saddle: Array
    bones: Array
    zero: Array
    tip_radius: Array
    reach_limits: Array

    def joint_limits(self) -> tuple[Array, Array]:
        """Least (42,) and greatest (42,) rotation-vector components of legal poses, rad.

        Flexions are the clinical ranges (knuckle -20 to 85 degrees, middle joint 0 to 105, last
        joint -10 to 75) minus the flexions at which joints count as zero. Joints that are nearly
        hinges have a few degrees of play about their other axes.
        """
        saddle = ((-55.0, -10.0, -24.0), (50.0, 10.0, 24.0))
        middle, last = (
            ((-60.0, -4.0, -5.0), (45.0, 4.0, 5.0)),
            ((-45.0, -4.0, -5.0), (40.0, 4.0, 5.0)),
        )
        thumb = (
            ((-38.0, -24.0, -38.0), (38.0, 24.0, 38.0)),
            ((-52.0, -8.0, -10.0), (32.0, 8.0, 10.0)),
        )
        rows = [*thumb, *([saddle, middle, last] * 4)]
        lower, upper = np.deg2rad(np.array(rows)).reshape(BALL_JOINTS, 2, 3).swapaxes(0, 1)
        return lower.ravel(), upper.ravel()

    @property
    def last_bone(self) -> NDArray[np.int64]:
        """Index (5,) of each finger's outermost bone."""
        return _FIRST_BONE + np.array(_BONES) - 1

    def rests(self) -> Array:
        """Rotations (14, 3, 3) parent from bone at a zero joint."""
        out = np.empty((BALL_JOINTS, 3, 3))
        for finger, (first, count) in enumerate(zip(_FIRST_BONE, _BONES, strict=True)):
            out[first] = self.saddle[finger]
            for k in range(1, count):
                out[first + k] = _about_x(-self.zero[finger, k])
        return out

    def bent(self, angles: Array) -> Array:
        """Flexions (..., 5, 3) of the three joints, from straight, for `ANGLES` (..., 5, 5)."""
        last = TENDON * angles[..., SECOND] + angles[..., LAST]
        return np.stack([angles[..., FIRST], angles[..., SECOND], last], axis=-1)

    def tips_in_palm(self, angles: Array) -> Array:
        """Fingertips (..., 5, 3) m in the hand frame, for `ANGLES` (..., 5, 5)."""
        slope = np.cumsum(self.bent(angles), axis=-1) - self.zero[:, :1]
        forward = (self.bones * np.cos(slope)).sum(axis=-1)
        down = (self.bones * np.sin(slope)).sum(axis=-1)
        swing = angles[..., SWING]
        local = np.stack([-forward * np.sin(swing), forward * np.cos(swing), -down], axis=-1)
        return (self.saddle @ local[..., None])[..., 0] + self.knuckle

    def pose(self, root: Array, turn: Array, angles: Array) -> Array:
        """Poses (n, 48) of wrist and angles.

        Args:
            root: (n, 3) m, position of the wrist.
            turn: (n, 3, 3) rotation of the wrist.
            angles: (n, 5, 5) `ANGLES` of the fingers.
        """
        from scipy.spatial.transform import Rotation

        n = len(root)
        bent = self.bent(angles) - self.zero
        base = _about_z(angles[..., SWING]) @ _about_x(-bent[..., 0])
        # The roll is about the line from the knuckle to the tip.
        local = self.tips_in_palm(angles) - self.knuckle
        line = np.einsum("fji,nfj->nfi", self.saddle, local)
        line /= np.linalg.norm(line, axis=-1, keepdims=True)
        roll = Rotation.from_rotvec((angles[..., ROLL, None] * line).reshape(-1, 3)).as_matrix()
        base = roll.reshape(n, 5, 3, 3) @ base
        knuckles = Rotation.from_matrix(base.reshape(-1, 3, 3)).as_rotvec().reshape(n, 5, 3)
        joints = np.zeros((n, BALL_JOINTS, 3))
        joints[:, _FIRST_BONE] = knuckles
        joints[:, _FIRST_BONE + 1, 0] = -bent[..., 1]
        joints[:, _FIRST_BONE[1:] + 2, 0] = -bent[:, 1:, 2]
        q = np.empty((n, POSE_SIZE))
        q[:, ROOT_POSITION] = root
        q[:, ROOT_ROTATION] = Rotation.from_matrix(turn).as_rotvec()
        q[:, JOINTS] = joints.reshape(n, -1)
        return q

    def chain(self, q: Array) -> tuple[Array, Array, Array]:
        """Forward kinematics of poses (n, 48).

        Returns:
            Positions of the joints (n, 14, 3) m, rotations of the bones (n, 14, 3, 3) and
            fingertips (n, 5, 3) m, in the frame in which the poses are given.
        """
        from scipy.spatial.transform import Rotation

        n = len(q)
        turns = Rotation.from_rotvec(q[:, 3:].reshape(-1, 3)).as_matrix().reshape(n, 15, 3, 3)
        places, rotations = np.empty((n, BALL_JOINTS, 3)), np.empty((n, BALL_JOINTS, 3, 3))
        tips = np.empty((n, len(FINGERS), 3))
        for finger, (first, count) in enumerate(zip(_FIRST_BONE, _BONES, strict=True)):
            place = q[:, ROOT_POSITION] + turns[:, 0] @ self.knuckle[finger]
            rotation = turns[:, 0] @ self.saddle[finger]
            for k in range(count):
                if k:
                    rotation = rotation @ _about_x(-self.zero[finger, k])
                rotation = rotation @ turns[:, 1 + first + k]
                places[:, first + k], rotations[:, first + k] = place, rotation
                place = place + self.bones[finger, k] * rotation[..., 1]
            tips[:, finger] = place
        return places, rotations, tips

    def tips(self, q: Array) -> Array:
        """Middles (n, 5, 3) m of the fingertips of poses (n, 48)."""
        return self.chain(q)[2]


_BONES = (2, 3, 3, 3, 3)
_FIRST_BONE = np.array([0, 2, 5, 8, 11])


def _about_x(angle: Array | float) -> Array:
    """Rotations (..., 3, 3) about x by angles in rad."""
    return _turn(np.asarray(angle, float), 1, 2)


def _about_y(angle: Array | float) -> Array:
    """Rotations (..., 3, 3) about y by angles in rad."""
    return _turn(np.asarray(angle, float), 2, 0)


def _about_z(angle: Array | float) -> Array:
    """Rotations (..., 3, 3) about z by angles in rad."""
    return _turn(np.asarray(angle, float), 0, 1)


def _turn(angle: Array, i: int, j: int) -> Array:
    """Rotation (..., 3, 3) that turns axis i towards axis j."""
    out = np.zeros((*angle.shape, 3, 3))
    out[..., 3 - i - j, 3 - i - j] = 1.0
    out[..., i, i] = out[..., j, j] = np.cos(angle)
    out[..., j, i] = np.sin(angle)
    out[..., i, j] = -np.sin(angle)
    return out


def attitude(yaw: Array, pitch: Array, roll: Array) -> Array:
    """Rotations (n, 3, 3) of a hand, from angles (n,) rad. Positive yaw is counterclockwise seen
    from above, positive pitch raises the fingers, and positive roll lowers the side of the little
    finger."""
    return _about_z(yaw) @ _about_x(pitch) @ _about_y(roll)


def _thumb_saddle() -> Array:
    """Rotation (3, 3) of the resting thumb. The thumb points forwards, outwards and down, with its
    pad towards the other fingers."""
    along = np.array([-0.46, 0.64, -0.44])
    along /= np.linalg.norm(along)
    pad = np.array([0.66, 0.72, -0.15])
    pad -= (pad @ along) * along
    dorsal = -pad / np.linalg.norm(pad)
    return np.stack([np.cross(along, dorsal), along, dorsal], axis=1)


def _slender() -> SecondHand:
    zero = _radians((0, 20, 0), *[(30, 45, 30)] * 4)
    splay = np.deg2rad([5.0, 0.5, -4.5, -11.0])
    saddle = np.concatenate([_thumb_saddle()[None], _about_z(splay) @ _about_x(-zero[1:, 0])])
    return SecondHand(
        name="slender",
        knuckle=1e-3
        * np.array(
            [[-19, 18, -11], [-23, 85.5, 0], [-3.5, 88, 2], [15, 83.5, 0.5], [32, 75, -4]], float
        ),
        saddle=saddle,
        bones=1e-3
        * np.array(
            [[48, 56, 0], [50, 28.5, 22.5], [54.5, 32, 23.5], [50.5, 30, 23], [39.5, 24, 21]]
        ),
        zero=zero,
        tip_radius=1e-3 * np.array([8.0, 6.8, 7.0, 6.7, 6.0]),
        reach_limits=np.stack(
            [
                _radians((-30, -30, 0, -18, 0), *[(-18, -18, 6, 0, -12)] * 4),
                _radians((30, 30, 68, 18, 0), *[(18, 75, 95, 0, 10)] * 4),
            ]
        ),
    )


SLENDER = _slender()
"""The hand of every second subject."""
