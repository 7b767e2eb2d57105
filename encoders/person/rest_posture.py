"""Rest posture: an encoder is corrected by poses of a person's resting hand, which a device sees
once.

Touches do not determine some constants of a person: the height of the wrist, the flexion of fingers
at rest, the zero of a device. An encoder for any person therefore has a constant error for each
person. A camera or a Leap that sees the hand on the surface for a moment measures this error: it is
the difference between the seen pose and the encoder's pose, averaged over a few samples. A sample
also contains the accidental posture of its moment. Therefore only the part of the difference that
is likely to be constant is used. It is estimated as a random effect with the variance of the
population.

A sample has the touches and the pose of one moment, in metres and radians. Both are those of the
person's hand in its own size, in the 3-D surface frame; a left hand is mirrored to a right hand.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from msgspec import Struct, field
from numpy.typing import ArrayLike, NDArray

from encoders.capture import Capture, load_capture
from encoders.correction import PAD_HEIGHT, tip_targets
from encoders.encoder import Encoder
from encoders.input_vector import contact_vectors
from encoders.regression.trained import TrainedModel
from encoders.regression.yaw_normalised import turned_root, yaw_of
from models.arithmetic import Array, matrix_product, matrix_vector, solve_positive, squared_lengths
from models.errors import EncoderError, InputError
from models.frames import FINGERS
from models.json_input import check_layout, decoded, read_bytes
from models.kinematics import Kinematics
from models.person import RestSample, RestSamples
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, mirrored, relative_pose
from models.rotations import unwrap_near
from models.skeleton import ADULT, Skeleton

SCHEMA = 1
"""Version of the file's layout."""

KIND = "hand-sandbox rest posture"

MOST = 12
"""Largest number of samples of a posture; more samples hardly improve it."""

LEAST_FINGERS = 2
"""Least number of touches: a single touch has no layout from which an encoder could predict a
pose."""

SLACK = 0.35
"""Angle (rad) by which a seen joint may be outside our hand's range, since the zero of a joint
differs between hands."""

FAR = 0.05
"""Greatest distance (m, at the trained hand's size) from a touch to the fingertip of our hand in
the seen pose. People's bones differ by a centimetre; swapped fingers give a greater distance."""

DIGITS = 5
"""Decimals of metres and radians in files."""

_WHAT = "the rest posture cannot be used"
_REMEDY = "docs/playing.md says how a rest posture is made"


class _RestFile(Struct, forbid_unknown_fields=True):
    kind: str
    schema: int
    hand: str
    simulated: bool
    samples: list[RestSample] = field(name="looks")


def rest_samples(capture: Capture, most: int = MOST) -> RestSamples:
    """Samples from a capture: the last frames of at most `most` takes, evenly spaced among all
    takes."""
    last = np.flatnonzero(np.diff(capture.trial, append=capture.trial[-1] + 1))
    last = last[capture.down[last].sum(axis=1) >= LEAST_FINGERS]
    chosen = last[np.unique(np.linspace(0, len(last) - 1, most).astype(int))] if len(last) else last
    return tuple(_rest_sample(capture.xy[t], capture.q[t]) for t in chosen)


def _rest_sample(xy: Array, q: Array) -> RestSample:
    places = [None if np.isnan(x) else (x, y) for x, y in xy.round(DIGITS).tolist()]
    return RestSample(tuple(places), tuple(q.round(DIGITS).tolist()))


def check_rest_samples(samples: Sequence[RestSample], size: float) -> None:
    """Checks the samples of a right hand.

    Args:
        samples: The samples.
        size: Size of the hand relative to the trained hand.

    Raises:
        EncoderError: There are no samples or too many, or no hand of this size has such joints or
            touches.
    """
    if not 1 <= len(samples) <= MOST:
        raise EncoderError(
            "a rest posture has too few or too many samples",
            got=len(samples),
            expected=f"1 to {MOST}",
        )
    for number, sample in enumerate(samples, 1):
        where = f"sample {number}"
        touching = sum(place is not None for place in sample.touches)
        if len(sample.touches) != len(FINGERS) or touching < LEAST_FINGERS:
            raise EncoderError(
                "a sample has too few touches",
                where=where,
                got=f"{touching} of {len(sample.touches)} fingers",
                expected=f"{LEAST_FINGERS} to 5 touches, null for lifted fingers",
            )
        if len(sample.pose) != POSE_SIZE:
            raise EncoderError(
                "a sample's pose has a wrong length",
                where=where,
                got=len(sample.pose),
                expected="48 numbers",
            )
    xy, q = _arrays(samples, size)
    joints = q[:, JOINTS]
    beyond = np.maximum(ADULT.lower - joints, joints - ADULT.upper)
    number, component = divmod(int(beyond.argmax()), beyond.shape[1])
    if beyond[number, component] > SLACK:
        raise EncoderError(
            "no hand has such a joint",
            where=f"sample {number + 1}, number {JOINTS.start + component + 1} of the pose",
            got=f"{joints[number, component]:.2f} rad",
            expected=f"about {ADULT.lower[component]:.2f} to {ADULT.upper[component]:.2f} rad",
        )
    off = np.linalg.norm(tip_targets(xy) - Kinematics(ADULT).tips(q), axis=2)  # any order: a check
    if np.nanmax(off) > FAR:
        number, finger = divmod(int(np.nanargmax(off)), len(FINGERS))
        raise EncoderError(
            "the pose's fingertip is far from its touch",
            where=f"sample {number + 1}, {FINGERS[finger]}",
            got=f"{100 * off[number, finger]:.1f} cm",
            expected=f"{100 * FAR:.0f} cm or less, for a hand of size {size:.2f}",
        )


def _arrays(samples: Sequence[RestSample], size: float) -> tuple[Array, Array]:
    """Touches (n, 5, 2) m and poses (n, 48) of samples, scaled from a hand's size to the trained
    hand's size."""
    nothing = (np.nan, np.nan)
    xy = np.array(
        [[nothing if p is None else p for p in sample.touches] for sample in samples], float
    )
    q = np.array([sample.pose for sample in samples], float)
    q[:, ROOT_POSITION] /= size
    return xy / size, q


def read_rest(path: Path, hand: str) -> RestSamples:
    """Reads a rest posture without the checks that need the size of the hand; see `load_rest`.

    Raises:
        InputError: The file is missing, of another version or kind, or of the other hand.
    """
    if path.suffix == ".npz":
        capture = load_capture(path)
        # Poses of a capture are those of a right hand; `recorded_side` marks a mirrored left hand.
        side = str(capture.meta.get("recorded_side") or capture.meta.get("side", hand))
        samples = rest_samples(capture)
    else:
        side, samples = _read(path)
    if side != hand:
        raise InputError(
            "the rest posture is of the other hand",
            where=str(path),
            got=side,
            expected=hand,
            remedy=f"Use it with --hand {side}, or make a rest posture of the {hand} hand",
        )
    return samples


def load_rest(path: Path, hand: str, size: float) -> RestSamples:
    """Reads a rest posture: a file of samples, or a capture (.npz), of which the last frames of
    takes are used.

    Args:
        path: The file.
        hand: `right` or `left`, the hand of the person whose rest posture is read.
        size: Size of the person's hand.

    Raises:
        InputError: The file is missing, of another version or kind, of the other hand, or contains
            joints that no hand has.
    """
    samples = read_rest(path, hand)
    try:
        check_rest_samples(samples, size)
    except EncoderError as error:
        raise InputError(
            f"{_WHAT}: {error.what}",
            where=f"{path}, {error.where}" if error.where else str(path),
            got=error.got,
            expected=error.expected,
            remedy=_REMEDY,
        ) from None
    return samples


def _read(path: Path) -> tuple[str, RestSamples]:
    where = str(path)
    data = read_bytes(path, InputError, what="the rest posture cannot be read", remedy=_REMEDY)
    what = "this is not a rest posture"
    check_layout(data, KIND, SCHEMA, InputError, what=what, where=where, remedy=_REMEDY)
    values = decoded(data, _RestFile, InputError, what=_WHAT, where=where, remedy=_REMEDY)
    samples = tuple(values.samples)
    return values.hand, tuple(map(_mirrored, samples)) if values.hand == "left" else samples


def save_rest(samples: Sequence[RestSample], path: Path, hand: str, simulated: bool) -> None:
    """Writes a rest posture. The file has the samples of the person's own hand, not mirrored.

    Args:
        samples: Samples of the hand; those of a left hand are mirrored to a right hand.
        path: The file.
        hand: `right` or `left`.
        simulated: True if no real person was seen.

    Raises:
        InputError: The file cannot be written; an existing file is unchanged.
    """
    own = [_mirrored(sample) for sample in samples] if hand == "left" else list(samples)
    values: dict[str, Any] = {"kind": KIND, "schema": SCHEMA, "hand": hand, "simulated": simulated}
    text = json.dumps(values | {"looks": [asdict(sample) for sample in own]}, indent=1)
    beside = path.with_name(f"{path.name}.new")
    try:
        beside.write_text(text, encoding="utf-8")
        beside.replace(path)
    except OSError as error:
        raise InputError(
            "the rest posture cannot be written",
            where=str(path),
            got=error.strerror,
            remedy="Choose another path with --out",
        ) from None


def _mirrored(sample: RestSample) -> RestSample:
    if len(sample.pose) != POSE_SIZE:
        return sample
    touches = tuple(place and (-place[0], place[1]) for place in sample.touches)
    return RestSample(touches, tuple(mirrored(sample.pose).tolist()))


class _Shifted(Encoder):
    """An encoder with a person's constant offset added to its poses.

    Args:
        plain: A fitted encoder.
        offset: (48,) m and rad; the root's part is in the frame that turns with the hand.
    """

    def __init__(self, plain: Encoder, offset: Array) -> None:
        self.plain, self.offset = plain, offset

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Fits the inner encoder; the offset does not change."""
        self.plain.fit(U, Q)
        return self

    def predict(self, U: ArrayLike) -> Array:
        """See `Encoder.predict`."""
        q = np.asarray(self.plain.predict(U), float)
        rows = q.reshape(-1, POSE_SIZE)
        moved = rows + turned_root(np.tile(self.offset, (len(rows), 1)), yaw_of(rows))
        return np.asarray(moved.reshape(q.shape))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays of the inner encoder, and the offset."""
        return self.plain.arrays() | {"offset": self.offset}


def knowing_rest(model: TrainedModel, samples: Sequence[RestSample], size: float) -> TrainedModel:
    """Adapts a model to a person whose rest posture was seen.

    Args:
        model: A model for any person.
        samples: Samples of the person's hand; those of a left hand are mirrored to a right hand.
        size: Size of the person's hand.

    Raises:
        EncoderError: The model is for one person and does not contain the variance between people,
            or no hand has such samples.
    """
    personal = model.personal_covariance
    if personal is None:
        raise EncoderError(
            "this encoder cannot use a rest posture",
            where=f"--encoder {model.name}",
            expected="an encoder for any person, such as population",
        )
    check_rest_samples(samples, size)
    xy, q = _arrays(samples, size)
    u, leftmost = contact_vectors(xy)
    guess = model.encoder.predict(u)
    off = turned_root(relative_pose(q, leftmost) - guess, -yaw_of(guess))
    mean = off[0].copy()
    for row in off[1:]:
        mean += row
    mean /= len(off)
    # Covariance of the mean of the samples: the part that is constant for a person, and the part
    # that varies between samples, divided by their number.
    varying = model.residual_covariance - personal
    spread = personal + varying / len(off) + _LEAST * np.eye(POSE_SIZE)
    gain = np.array([solve_positive(spread.copy(), row) for row in personal])
    offset = matrix_vector(gain, mean)
    told = matrix_product(gain, personal)
    covariance = model.residual_covariance - 0.5 * (told + told.T)
    return replace(model, encoder=_Shifted(model.encoder, offset), residual_covariance=covariance)


_LEAST = 1e-9
"""Variance (m2, rad2) that is added so that the covariance has an inverse."""


SECONDS = 1.0
"""Time (s) for which a hand is held still."""
STILL = 0.012
"""Largest distance (m) of a fingertip of a still hand from its median place. In landmarks of a
still hand, a fingertip moves by some millimetres."""
LEVEL = 0.030
"""Largest difference (m) between the height of a fingertip and the median height, for a hand whose
fingertips may all touch. Thumbs lie lower than fingers, and a device errs by a centimetre."""
MOVED = 0.040
"""Least distance (m) by which every fingertip moves between two samples."""


class SeenRest:
    """Takes a sample of a hand in the air whenever the hand is held still, as if on a screen.

    The person holds the hand still for a second, relaxed, with all fingertips on one level: on a
    table, on the switched-off screen, or above the device. The sample's pose is the median of that
    second. The level of the fingertips counts as the screen, and the points below the fingertips
    count as touches.

    Args:
        skeleton: The right hand's skeleton, of the person's size.

    Attributes:
        samples: The samples so far.
        trouble: Reason why the last hand that was held still is not a sample; empty if it is a
            sample.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        self._kinematics = Kinematics(skeleton)
        self._frames: deque[tuple[float, Array, Array]] = deque()
        self._taken: Array | None = None
        self.samples: list[RestSample] = []
        self.trouble = ""

    def lose(self) -> None:
        """Records that the hand is not seen."""
        self._frames.clear()

    def add(self, time: float, q: Array) -> bool:
        """Processes a pose.

        Args:
            time: Time (s) of the pose.
            q: (48,) pose; a left hand is mirrored to a right hand. x right, y away from the person,
                z up.

        Returns:
            True if a sample was taken.
        """
        self._frames.append((time, q, self._kinematics.tips(q)))
        while time - self._frames[0][0] > SECONDS:
            self._frames.popleft()
        if time - self._frames[0][0] < 0.9 * SECONDS:
            return False
        tips = np.array([frame[2] for frame in self._frames])
        middle = np.median(tips, axis=0)
        if float(np.sqrt(squared_lengths(tips - middle)).max()) > STILL:
            return False
        if self._taken is not None and _moved(middle, self._taken) < MOVED:
            return False
        try:
            sample = rest_sample_of(
                np.array([frame[1] for frame in self._frames]), self._kinematics
            )
        except EncoderError as error:
            self.trouble = str(error)
            return False
        self.trouble = ""
        self.samples.append(sample)
        self._taken = middle
        return True


def rest_sample_of(poses: Array, kinematics: Kinematics) -> RestSample:
    """Creates the sample of a hand that was held still.

    Args:
        poses: (n, 48), poses while it was held still; a left hand is mirrored to a right hand. z is
            up.
        kinematics: Kinematics of the hand's skeleton.

    Raises:
        EncoderError: The fingertips are not on one level.
    """
    q = np.median(poses, axis=0)
    turns = unwrap_near(poses[:, ROOT_ROTATION], poses[0, ROOT_ROTATION])
    q[ROOT_ROTATION] = np.median(turns, axis=0)
    tips = kinematics.tips(q)
    heights = tips[:, 2] - np.median(tips[:, 2])
    worst = int(np.argmax(np.abs(heights)))
    if abs(heights[worst]) > LEVEL:
        raise EncoderError(
            "the fingertips are not on one level",
            got=f"the {FINGERS[worst]} is {100 * abs(heights[worst]):.1f} cm "
            f"{'above' if heights[worst] > 0 else 'below'} the other fingertips",
            expected=f"{100 * LEVEL:.0f} cm or less, as for a hand that rests on a screen",
        )
    # The origin is at the leftmost and farthest touch; only relative positions are used.
    q[ROOT_POSITION] -= [tips[:, 0].min(), tips[:, 1].max(), np.median(tips[:, 2]) - PAD_HEIGHT]
    places = (kinematics.tips(q)[:, :2] * [1.0, -1.0]).round(DIGITS).tolist()
    return RestSample(tuple((x, y) for x, y in places), tuple(q.round(DIGITS).tolist()))


def _moved(tips: Array, before: Array) -> float:
    """Movement (m) of the fingertip that moved least."""
    return float(np.sqrt(squared_lengths(tips - before)).min())
