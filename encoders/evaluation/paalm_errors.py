"""Evaluates PAALM on takes: errors of angles and labels, jitter, time, and impossible postures.

Frames of a recording depend on each other, so every figure is computed first within a recording and
then over recordings. docs/paalm.md defines the measures. Angles are those of the four fingers; the
thumb has separate figures. Frames in which the hand is held open for calibration do not count.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.angles import angles_of_joints
from encoders.paalm.average import average_calibration, calibrate_on_recording
from encoders.paalm.calibration import EQUAL_BENDS, MOST_BENT, measure, pointing
from encoders.paalm.chain import FINGER_LIMITS
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.joint_angles import Paalm
from encoders.paalm.options import PaalmOptions
from encoders.paalm.palm import palm_of
from encoders.paalm.simulated.air import FROZEN_AIR
from encoders.paalm.simulated.forward import FROZEN_LEAP, LeapTake
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, SIDES, HandFrame, TrackedFinger, TrackedHand, Vector
from models.kinematics import Kinematics
from models.skeleton import ADULT


def take_of_recording(frames: Sequence[HandFrame], side: str) -> LeapTake:
    """Extracts the frames of one hand whose five fingers have labels and joints.

    Raises:
        EncoderError: There are no such frames.
    """
    kept: list[HandFrame] = []
    names: list[dict[int, int]] = []
    angles: list[Array] = []
    for frame in frames:
        hand = next((h for h in frame.hands if h.side == side), None)
        if hand is None or not _whole(hand):
            continue
        palm = palm_of(hand, side)
        ordered = sorted(hand.fingers, key=lambda f: f.finger or 0)
        joints = [[palm.place(j) for j in f.joints or ()] for f in ordered]
        angles.append(angles_of_joints(joints))
        kept.append(replace(frame, hands=(hand,)))
        names.append({f.id: int(f.finger or 0) for f in ordered})
    if not kept:
        raise EncoderError(
            f"no {side} hand with five fingers and their joints",
            expected="a recording in which the device reports joints",
        )
    table = np.array(angles)
    is_open = (table[:, 1:, 2] + table[:, 1:, 3] < MOST_BENT).all(axis=1) & (
        table[:, 1:, 0] < 45.0
    ).all(axis=1)
    return LeapTake(tuple(kept), tuple(names), table, _steady(np.asarray(is_open)), side, "v3")


def independent(take: LeapTake) -> bool:
    """True if PIP and DIP are independent in this recording, so that they can be evaluated."""
    apart = np.abs(take.angles[:, 1:, 2] - take.angles[:, 1:, 3]).mean()
    return bool(apart > EQUAL_BENDS)


def as_first_software(take: LeapTake, seed: int = 0) -> LeapTake:
    """The hand as the first software would have reported it: fingers in random order, without
    labels and joints.

    The first software lost folded fingers. A finger that the device reports as not stretched is
    therefore left out, except while the hand is held open. A finger that returns gets a new id.
    """
    rng = np.random.default_rng([seed, 0xF175])
    fresh, current = 0, dict.fromkeys(range(len(FINGERS)), -1)
    frames, names = [], []
    for frame, held in zip(take.frames, take.open, strict=True):
        hand = frame.hands[0]
        shown: list[TrackedFinger] = []
        for finger in hand.fingers:
            name = int(finger.finger or 0)
            if finger.extended is False and not held:
                current[name] = -1
                continue
            if current[name] < 0:
                current[name], fresh = fresh, fresh + 1
            shown.append(
                TrackedFinger(current[name], finger.tip, pointing(finger), measure(finger))
            )
        order = rng.permutation(len(shown)).tolist()
        shown = [shown[i] for i in order]
        unnamed = replace(hand, fingers=tuple(shown))
        frames.append(replace(frame, hands=(unnamed,), dialect="v1"))
        names.append({i: n for n, i in current.items() if i >= 0})
    return replace(take, frames=tuple(frames), fingers=tuple(names), dialect="v1")


def _whole(hand: TrackedHand) -> bool:
    return len(hand.fingers) == len(FINGERS) and all(
        f.joints is not None and f.finger is not None for f in hand.fingers
    )


def _steady(is_open: NDArray[np.bool_], most: float = 0.3) -> NDArray[np.bool_]:
    """Booleans (T,): True for the first open frames, which calibrate the hand.

    At most the share `most` of all frames is chosen, or 10 frames if these are more.
    """
    chosen = is_open & (np.cumsum(is_open) <= max(most * len(is_open), 10))
    return np.asarray(chosen)


NEAR = 3.0
"""A joint within this angle (degrees) of its limit counts as at its limit."""
CLAW = (-10.0, 45.0)
"""A finger is a claw if its MCP flexion is at most the first value and its PIP flexion is above the
second value (degrees)."""


@dataclass(frozen=True)
class Plausibility:
    """Shares of the fingers, without thumbs, that a device saw in a recording.

    Attributes:
        fingers: Number of seen fingers, over all frames.
        backward: Share of fingers whose knuckle is at its backward limit.
        claws: Share of fingers that are claws (`CLAW`).
        at_limit: Share of fingers with any other angle at a limit. PIP and DIP count only at their
            largest flexion, since straight joints are plausible.
        tips: 95th percentile of the distance (m) of the fingertips that the device saw from those
            of an average hand in the estimated pose.
        remark: Reason why an average hand was used, not a measured hand; empty if none was
            used.
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
    """Measures how plausible PAALM's postures of all hands of a recording are.

    Args:
        frames: Frames of the recording.
        options: Options of PAALM.
        live: True processes the frames like those of a live device: without calibration on the
            recording.

    Raises:
        EncoderError: No finger is seen in the recording.
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
        raise EncoderError(
            "no finger is seen in this recording",
            expected="a hand with index, middle, ring or little finger in some frame",
        )
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


def moved(hand: TrackedHand, by: Vector) -> TrackedHand:
    """The hand shifted by `by`, m."""

    def shift(v: Vector) -> Vector:
        return v[0] + by[0], v[1] + by[1], v[2] + by[2]

    def finger(f: TrackedFinger) -> TrackedFinger:
        if f.joints is None:
            return replace(f, tip=shift(f.tip))
        a, b, c, d = (shift(j) for j in f.joints)
        return replace(f, tip=shift(f.tip), joints=(a, b, c, d))

    return replace(hand, palm=shift(hand.palm), fingers=tuple(map(finger, hand.fingers)))


def side_by_side(right: LeapTake, left: LeapTake, apart: float = 0.15) -> list[HandFrame]:
    """Frames with both hands, each shifted by `apart` (m) to its side, for the length of the
    shorter take."""
    return [
        HandFrame(
            x.time,
            (
                replace(moved(y.hands[0], (-apart, 0.0, 0.0)), id=2),
                moved(x.hands[0], (apart, 0.0, 0.0)),
            ),
        )
        for x, y in zip(right.frames, left.frames, strict=False)
    ]


def two_hand_milliseconds(right: LeapTake, left: LeapTake) -> float:
    """Median ms of a step with two hands, measured on this machine."""
    frames = side_by_side(right, left)
    paalm = Paalm()
    held = (right.open & left.open)[: len(frames)]
    is_open = [f for f, both in zip(frames, held, strict=True) if both]
    paalm.calibrate(is_open, "both", len(is_open) // 2)
    paalm.reset()
    spent = []
    for frame in frames:
        begin = time.perf_counter()
        paalm.step(frame)
        spent.append(time.perf_counter() - begin)
    return 1e3 * float(np.median(spent))


_LEAST_OPEN = 10

CALIBRATION_SHARE = 0.8
"""Share of the open frames that the calibration requires; some frames lack a finger."""


_SHOWN = (
    "mcp_deg",
    "mcp_spread_deg",
    "pip_deg",
    "dip_deg",
    "pip_dip_deg",
    "thumb_cmc_deg",
    "thumb_mcp_deg",
    "jitter_deg",
    "ms_per_frame",
)


@dataclass(frozen=True)
class Judgement:
    """Results for one recording.

    Attributes:
        name: Name of the recording.
        figures: Figures by name; NaN where the recording has no truth.
        frames: Number of evaluated frames.
    """

    name: str
    figures: dict[str, float]
    frames: int


def test_seeds(count: int) -> list[int]:
    """Seeds derived from the frozen configuration, so that they cannot be chosen.

    They are the first outputs of SHA-256 over hands, device and the method's defaults, 32 bits
    each.
    """
    frozen = json.dumps(
        [asdict(FROZEN_AIR), asdict(FROZEN_LEAP), asdict(PaalmOptions())], sort_keys=True
    )
    return [
        int.from_bytes(hashlib.sha256(f"{frozen}#{i}".encode()).digest()[:4], "big")
        for i in range(count)
    ]


def calibrated_on(take: LeapTake, options: PaalmOptions, measured: bool = True) -> Paalm:
    """Creates a PAALM that is calibrated on a recording's open frames.

    There are two exceptions. A hand with reported joints that is hardly ever open is not measured;
    its calibration follows from its reported bones. A hand that is solved by its tips, and that
    cannot be measured in its open frames, starts as an average hand, as with a live device.

    Args:
        take: The recording.
        options: Options of PAALM.
        measured: False does not measure the hand, even if it is open.

    Raises:
        EncoderError: There are too few open frames, or the hand is not open in them.
    """
    is_open = [f for f, held in zip(take.frames, take.open, strict=True) if held]
    paalm = Paalm(options)
    by_tip = take.dialect == "v1" and options.solve == "tips"
    if not measured or (len(is_open) < _LEAST_OPEN and take.dialect == "v3"):
        known = take.frames if take.dialect == "v3" else ()
        paalm.use({take.side: average_calibration(known, take.side, options)})
        return paalm
    if len(is_open) < _LEAST_OPEN:
        raise EncoderError(
            "the hand is hardly ever held open",
            got=f"{len(is_open)} frames",
            expected=f"{_LEAST_OPEN} or more",
        )
    hands: Any = take.side
    try:
        paalm.calibrate(is_open, hands, round(CALIBRATION_SHARE * len(is_open)))
    except EncoderError:
        if not by_tip:
            raise
        paalm.use({take.side: average_calibration((), take.side, options)})
    return paalm


def judge_recording(
    name: str,
    take: LeapTake,
    options: PaalmOptions | None = None,
    angles: bool = True,
    names: bool = True,
    measured: bool = True,
) -> Judgement:
    """Evaluates one recording.

    Args:
        name: Name of the recording.
        take: Frames and truth.
        options: Options of PAALM; labels are evaluated with the paper's order as well.
        angles: False where the recording has no truth for single joints.
        names: False leaves out the accuracy of labels, which needs two more passes.
        measured: False does not measure the hand, as with a live device.
    """
    options = options or PaalmOptions()
    paalm = calibrated_on(take, options, measured)
    begin = time.perf_counter()
    steps = [paalm.step(frame) for frame in take.frames]
    milliseconds = 1e3 * (time.perf_counter() - begin) / len(steps)
    blank = np.full((len(FINGERS), 4), np.nan)
    tables = np.array([s.hands[take.side].table if s.hands else blank for s in steps])
    figures = {
        **_angles(tables, take, angles),
        "ms_per_frame": milliseconds,
    }
    for identity in ("tracked", "paper"):
        chosen = replace(options, identity=identity)
        figures[f"identity_{identity}"] = (
            _identity(take, chosen, measured) if names else float("nan")
        )
    return Judgement(name, figures, int((~take.open).sum()))


def summary(judgements: Sequence[Judgement]) -> dict[str, Any]:
    """Summary of the figures over recordings, as the command writes it; JSON values only."""
    if not judgements:
        raise EncoderError("no recording to judge", expected="1 or more")
    table = {k: np.array([j.figures[k] for j in judgements]) for k in judgements[0].figures}
    mean = {k: None if np.isnan(v).all() else float(np.nanmean(v)) for k, v in table.items()}
    seen = ("mcp_deg", "pip_deg", "dip_deg", "pip_dip_deg")
    return {
        **{k: mean[k] for k in _SHOWN},
        "seen_fingers": {k: mean[f"seen_{k}"] for k in seen},
        "identity_percent": {
            "paper": mean["identity_paper"],
            "tracked": mean["identity_tracked"],
        },
        "frames": sum(j.frames for j in judgements),
        "recordings": len(judgements),
        "per_recording": [
            {"name": j.name, "frames": j.frames}
            | {k: None if np.isnan(v) else v for k, v in j.figures.items()}
            for j in judgements
        ],
    }


def _angles(tables: Array, take: LeapTake, wanted: bool) -> dict[str, float]:
    judged_frames = ~take.open
    error = (tables - take.angles)[judged_frames]
    fingers = error[:, 1:]
    seen = np.array([[f in names.values() for f in range(1, 5)] for names in take.fingers])
    columns = {
        "mcp_deg": np.abs(fingers[..., 0]),
        "pip_deg": np.abs(fingers[..., 2]),
        "dip_deg": np.abs(fingers[..., 3]),
        "pip_dip_deg": np.abs(fingers[..., 2] + fingers[..., 3]),
    }
    chosen = seen[judged_frames]
    figures = {k: _mean(v) for k, v in columns.items()}
    figures |= {f"seen_{k}": _mean(v[chosen]) for k, v in columns.items()}
    # Change from frame to frame minus the change of the truth, for fingers that stay visible.
    steps = np.diff(tables - take.angles, axis=0)[:, 1:][..., [0, 2, 3]]
    stays = (seen[1:] & seen[:-1]) & judged_frames[1:, None]
    figures |= {
        "mcp_spread_deg": _mean(np.abs(fingers[..., 1])),
        "thumb_cmc_deg": _mean(np.abs(error[:, 0, 0])),
        "thumb_mcp_deg": _mean(np.abs(error[:, 0, 2])),
        "jitter_deg": float(np.sqrt(_mean(steps[stays] ** 2))),
    }
    return figures if wanted else dict.fromkeys(figures, float("nan"))


def _identity(take: LeapTake, options: PaalmOptions, measured: bool) -> float:
    """Percentage of visible fingers with the right label, in evaluated frames."""
    if any(f.finger is not None for frame in take.frames for h in frame.hands for f in h.fingers):
        return float("nan")  # The device labels them.
    paalm = calibrated_on(take, options, measured)
    right = total = 0
    for frame, names, held in zip(take.frames, take.fingers, take.open, strict=True):
        hands = paalm.step(frame).hands
        if held or take.side not in hands:
            continue
        for finger, name in enumerate(FINGERS):
            device_id = hands[take.side].ids[name]
            if device_id is not None:
                right += names[device_id] == finger
                total += 1
    return 100.0 * right / total if total else float("nan")


def _mean(values: Array) -> float:
    values = values[np.isfinite(values)]
    return float(values.mean()) if values.size else float("nan")
