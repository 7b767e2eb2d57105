"""Finger chains to which calibrated fingers are mapped; the paper calls them Maya-fingers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from encoders.paalm.angles import FRAMES
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.chain import FINGER_LIMITS, THUMB_LIMITS, Bend, FingerChain
from encoders.paalm.coupling import Coupling
from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.options import PaalmOptions
from encoders.paalm.palm import vector_of
from models.frames import FINGERS, Vector
from models.skeleton import ADULT, Skeleton

_ZERO_FRAMES = [tuple(map(tuple, f.tolist())) for f in FRAMES]


def bone_lengths(skeleton: Skeleton = ADULT) -> list[tuple[float, float, float]]:
    """Bone lengths (m) of every finger; 0 for the thumb's third bone, which the skeleton lacks."""
    out = []
    for finger in range(len(FINGERS)):
        own = [b.length for b in skeleton.bones if b.finger == finger]
        first, second, third = [*own, 0.0, 0.0][:3]
        out.append((first, second, third))
    return out


@dataclass(frozen=True)
class RiggedFinger:
    """One finger, whose visible part is converted to a target of its chain.

    Attributes:
        finger: Finger, thumb 0 to little 4.
        chain: Chain of bones, in metres of the rig.
        open_length: Distance (m, in the rig's scale) from base to tip at a length ratio of 1.
        knuckle: Position (m) of the knuckle in palm coordinates.
        from_knuckle: True if a target is the line from the knuckle to the tip, False if it follows
            from direction and length ratio.
        scale: Metres of the rig per metre of the person's hand.
    """

    finger: int
    chain: FingerChain
    open_length: float
    knuckle: Vector
    from_knuckle: bool
    scale: float

    def local(self, v: Vector) -> Vector:
        """Transforms a direction from palm axes to the finger's frame."""
        if self.finger:
            return v
        (a, b, c), (d, e, f), (g, h, i) = _ZERO_FRAMES[0]
        x, y, z = v
        return x * a + y * d + z * g, x * b + y * e + z * h, x * c + y * f + z * i

    def bend(self, target: Vector) -> Bend:
        """Angles of the chain for a target: a vector (m, in the rig's scale) from the base, in palm
        axes."""
        return self.chain.solve(self.local(target))


def assumed_coupling(calibration: HandCalibration, options: PaalmOptions) -> Coupling:
    """The initial coupling of a hand: the coupling of the options, else that of the calibration,
    else that of the device's dialect."""
    return options.coupling or calibration.coupling or options.coupling_for(calibration.dialect)


def rig(calibration: HandCalibration, options: PaalmOptions) -> list[RiggedFinger]:
    """The five chains of a calibrated hand."""
    out = []
    rest = bone_lengths()
    coupling = assumed_coupling(calibration, options)
    for finger in range(len(FINGERS)):
        limits = FINGER_LIMITS if finger else THUMB_LIMITS
        standard = float(calibration.standard[finger])
        if calibration.bones is not None:
            first, second, third = calibration.bones[finger].tolist()
            chain = FingerChain((first, second, third), coupling, limits)
            out.append(
                RiggedFinger(
                    finger, chain, standard, vector_of(calibration.bases[finger]), False, 1.0
                )
            )
            continue
        hidden = options.hidden if finger else options.thumb_hidden
        chain = FingerChain(rest[finger], coupling, limits, hidden)
        open_length = chain.chord(options.open_bend)
        scale = open_length / standard
        by_tips = calibration.by_tip and options.solve == "tips"
        by_knuckle = calibration.by_tip or (options.direction == "thumb" and finger == 0)
        base, along = calibration.bases[finger], calibration.directions[finger]
        behind = options.behind if finger and by_tips else hidden
        knuckle = vector_of(base - along * (behind * chain.lengths[0] / scale))
        if by_knuckle:
            chain = FingerChain(rest[finger], coupling, limits)
            open_length = chain.chord(options.open_bend)
        if finger and calibration.palm_shift is not None:
            # Targets start at the average hand's knuckles, and the rig has the device's scale.
            x, y, z = average_knuckle(finger)
            a, b, c = calibration.palm_shift
            knuckle, scale = (x + a, y + b, z + c), 1.0
        out.append(RiggedFinger(finger, chain, open_length, knuckle, by_knuckle, scale))
    return out


def with_palm_shift(calibration: HandCalibration, options: PaalmOptions) -> HandCalibration:
    """Adds to a calibration the palm shift that brings the average hand's knuckles nearest to the
    measured knuckles."""
    measured = np.array([r.knuckle for r in rig(calibration, options)])[1:]
    average = np.array([average_knuckle(finger) for finger in range(1, len(FINGERS))])
    return replace(calibration, palm_shift=vector_of((measured - average).mean(axis=0)))


def shares_behind(options: PaalmOptions) -> list[float]:
    """Distances (5,) from each finger's visible part back to its knuckle, as shares of its longest
    visible length."""
    shares = []
    for finger, bones in enumerate(bone_lengths()):
        limits, hidden = FINGER_LIMITS, options.hidden
        if finger == 0:
            limits, hidden = THUMB_LIMITS, options.thumb_hidden
        chain = FingerChain(bones, options.coupling_for(None), limits, hidden)
        behind = options.behind if finger else hidden
        shares.append(behind * bones[0] / chain.chord(options.open_bend))
    return shares


def average_knuckle(finger: int) -> Vector:
    """Knuckle (m) of a finger of the average hand, in palm coordinates."""
    x, y, z = ADULT.bones[ADULT.first_bone[finger]].anchor
    a, b, c = PALM_CENTRE
    return x - a, y - b, z - c
