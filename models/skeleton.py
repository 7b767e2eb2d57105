"""The hand's skeleton as a table: 14 ball joints, one per phalanx.

Hand frame of a right hand: origin at the wrist, y along the fingers, z out of the back of the hand,
x towards the little finger, so that the thumb is at -x. Each bone's own frame has y along the bone
and z dorsal (the nail's side); flexion is a negative rotation about x. A ball joint is zero in the
middle of its range of flexion. So no component of a legal rotation vector exceeds 65 degrees, and
rotation vectors behave like plain vectors in this range.

Sizes are those of an average adult hand. The thumb has a carpometacarpal and a metacarpophalangeal
joint; its interphalangeal joint is fixed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, fsum, radians, sin

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array, length, stacked_product
from models.frames import FINGERS
from models.rotations import exp

_MIRROR = np.diag([-1.0, 1.0, 1.0])


@dataclass(frozen=True)
class Bone:
    """One ball joint and the phalanx it carries.

    Attributes:
        name: Joint name, `index_pip` for example.
        finger: Label of its finger, thumb 0 .. little 4.
        anchor: (3,) m, position of the joint in the frame of its parent bone, or of the palm.
        rest: (3, 3) rotation, parent from bone, at a zero joint.
        length: Distance (m) from the joint to the next one or to the centre of the fingertip.
        radius: Radius of the capsule that represents the flesh (m).
        lower: (3,) rad, least rotation-vector components of a legal pose.
        upper: (3,) rad, greatest rotation-vector components.
        stiffness: Stiffness (N m/rad) of the servo.
        armature: Armature (kg m2) added to the joint; without it, links of a few grams make the
            servo unstable.
    """

    name: str
    finger: int
    anchor: tuple[float, float, float]
    rest: Array
    length: float
    radius: float
    lower: Array
    upper: Array
    stiffness: float
    armature: float


@dataclass(frozen=True)
class Skeleton:
    """The bones of a right hand, or of a left one created by `mirrored`.

    Attributes:
        name: Name of the skeleton in captures.
        bones: 14 bones, finger by finger, from the palm outwards; the order of the pose `q`.
        palm_radius: Thickness of the palm's capsules (m).
        side: `right` or `left`.
    """

    name: str
    bones: tuple[Bone, ...]
    palm_radius: float
    side: str = "right"

    @cached_property
    def first_bone(self) -> Array:
        """Index (5,) of each finger's first bone."""
        return np.array(
            [
                next(i for i, b in enumerate(self.bones) if b.finger == f)
                for f in range(len(FINGERS))
            ]
        )

    @cached_property
    def last_bones(self) -> dict[int, Bone]:
        """Each finger's last bone, which ends in its fingertip."""
        return {bone.finger: bone for bone in self.bones}

    @cached_property
    def lower(self) -> Array:
        """Least legal rotation-vector components (42,) rad of all bones."""
        return np.concatenate([b.lower for b in self.bones])

    @cached_property
    def upper(self) -> Array:
        """Greatest legal rotation-vector components (42,) rad of all bones."""
        return np.concatenate([b.upper for b in self.bones])

    @property
    def tip_radius(self) -> Array:
        """Radii (5,) m of the fingertips' end spheres."""
        last = [*(self.first_bone[1:] - 1), len(self.bones) - 1]
        return np.array([self.bones[i].radius for i in last])

    def scaled(self, factor: float) -> Skeleton:
        """The same hand, `factor` times as large in every direction."""
        bones = tuple(
            replace(
                b,
                anchor=(b.anchor[0] * factor, b.anchor[1] * factor, b.anchor[2] * factor),
                length=b.length * factor,
                radius=b.radius * factor,
            )
            for b in self.bones
        )
        name = f"{self.name} x{factor:g}"
        return Skeleton(name, bones, self.palm_radius * factor, self.side)

    def mirrored(self) -> Skeleton:
        """The other hand, mirrored across x = 0; its own inverse.

        On it, the pose `models.pose.mirrored(q)` is the mirror image of pose q on this hand.
        """
        bones = tuple(
            replace(
                b,
                anchor=(-b.anchor[0], b.anchor[1], b.anchor[2]),
                rest=stacked_product(stacked_product(_MIRROR, b.rest), _MIRROR),
                # Mirrored rotations keep their sign about x, and change it about y and z.
                lower=np.array([b.lower[0], -b.upper[1], -b.upper[2]]),
                upper=np.array([b.upper[0], -b.lower[1], -b.lower[2]]),
            )
            for b in self.bones
        )
        side = "left" if self.side == "right" else "right"
        return Skeleton(self.name, bones, self.palm_radius, side)


def _degrees(*values: float) -> Array:
    return np.deg2rad(np.array(values))


def _facing(along: ArrayLike, pad: ArrayLike) -> Array:
    """Frame (3, 3) with y along one direction (3,), and -z, the direction of the finger's pad, as
    near as possible to another direction (3,)."""
    y = np.asarray(along, float)
    y = y / length(y)
    pad = np.asarray(pad, float)
    z = -(pad - fsum((pad * y).tolist()) * y)
    z /= length(z)
    return np.stack([np.cross(y, z), y, z], axis=1)


# Ranges: rotation about x (extension +, flexion -), y (twist), z (abduction), relative to the
# reference flexions 30, 45, 30 degrees (finger) and 20 degrees (thumb MCP). Flexion limits follow
# the usual clinical ranges (MCP -20..90, PIP 0..110, DIP -10..80); the few degrees of twist and
# sideways play at the hinge-like joints are what soft tissue allows.
_MCP = (_degrees(-60, -10, -25), _degrees(50, 10, 25))
_PIP = (_degrees(-65, -5, -6), _degrees(45, 5, 6))
_DIP = (_degrees(-50, -5, -6), _degrees(40, 5, 6))
_CMC = (_degrees(-40, -25, -40), _degrees(40, 25, 40))
_THUMB_MCP = (_degrees(-55, -10, -12), _degrees(35, 10, 12))

# finger -> knuckle in the palm (m), splay about z (deg), phalanx lengths (m), radii (m)
_FINGERS = {
    "index": ((-0.026, 0.088, 0.000), 4.0, (0.045, 0.026, 0.021), (0.0090, 0.0082, 0.0070)),
    "middle": ((-0.004, 0.091, 0.002), 0.0, (0.050, 0.030, 0.022), (0.0092, 0.0083, 0.0072)),
    "ring": ((0.017, 0.086, 0.000), -4.0, (0.046, 0.028, 0.022), (0.0088, 0.0080, 0.0070)),
    "little": ((0.036, 0.077, -0.004), -10.0, (0.036, 0.021, 0.020), (0.0080, 0.0072, 0.0064)),
}


def _right_hand() -> Skeleton:
    flexion = {
        name: exp(_degrees(-angle, 0, 0))
        for name, angle in (("mcp", 30.0), ("pip", 45.0), ("dip", 30.0), ("thumb", 20.0))
    }
    # The resting thumb opposes the index: it points forward, down and outwards, its pad turned
    # towards the index fingertip across the pinch axis (52 degrees in the palm's plane).
    thumb = _facing((-0.38, 0.66, -0.55), (cos(radians(52.0)), sin(radians(52.0)), 0.0))
    half = exp(_degrees(10.0, 0, 0))
    bones = [
        Bone(
            "thumb_cmc",
            0,
            (-0.022, 0.022, -0.010),
            stacked_product(thumb, half),
            0.046,
            0.0115,
            *_CMC,
            8.0,
            8e-4,
        ),
        Bone(
            "thumb_mcp",
            0,
            (0.0, 0.046, 0.0),
            flexion["thumb"],
            0.052,
            0.0080,
            *_THUMB_MCP,
            4.0,
            4e-4,
        ),
    ]
    for label, (name, (knuckle, splay, lengths, radii)) in enumerate(_FINGERS.items(), start=1):
        base = stacked_product(exp(_degrees(0, 0, splay)), flexion["mcp"])
        bones += [
            Bone(f"{name}_mcp", label, knuckle, base, lengths[0], radii[0], *_MCP, 6.0, 6e-4),
            Bone(
                f"{name}_pip",
                label,
                (0.0, lengths[0], 0.0),
                flexion["pip"],
                lengths[1],
                radii[1],
                *_PIP,
                3.0,
                3e-4,
            ),
            Bone(
                f"{name}_dip",
                label,
                (0.0, lengths[1], 0.0),
                flexion["dip"],
                lengths[2],
                radii[2],
                *_DIP,
                1.5,
                1.5e-4,
            ),
        ]
    return Skeleton("adult", tuple(bones), 0.011)


ADULT = _right_hand()
"""The hand of the sandbox and of the built-in captures."""
