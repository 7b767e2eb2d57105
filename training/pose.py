"""Training of the encoder of any person's pose, on a population of simulated people.

The touches and the wrist's position of a person are divided by the size of the hand. A larger hand
in the same posture then gives the same numbers, so the encoder can learn from all people together.
The encoder is `yaw_normalised`, whose predictions rotate with the hand. Its errors are measured on
people on whom it was not trained. The part of the errors that is the same in all frames of a person
is stored separately. It comes from the person's resting posture. Touches do not show this posture,
but a camera or a Leap does (`encoders.person.rest_posture`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.correction import tip_targets
from encoders.input_vector import contact_vectors
from encoders.regression.bone_fit import DISTRUSTS
from encoders.regression.trained import POPULATION, PersonCorrection, TrainedModel
from encoders.regression.training import rounded
from encoders.regression.yaw_normalised import YawNormalisedEncoder, turned_root, yaw_of
from encoders.validation import bounded_errors, error_product
from models.arithmetic import Array
from models.errors import EncoderError
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION, absolute_pose, relative_pose
from models.skeleton import ADULT

SHARES = {"first": 1.0, "second": 1.0, "posed": 0.25}
"""Weight of every source of people in the drawn frames. The weights were chosen on the people of
the group `choose`, for encoders that were trained without their generator. Without posed people,
errors of joint angles were larger; with more posed people, errors of the wrist were larger."""

RIDGES = (0.03, 0.1)
"""Penalties of the encoder, chosen on the same people."""

FRAMES = 60_000
"""Largest number of frames that are drawn for a fit. Each person of a source gives equally many."""

FOLDS = 3
"""Number of parts into which people are divided, to measure errors on people who were left out."""

JUDGED = 120
"""Number of frames of each left-out person in which errors are measured, times the weight of the
person's source."""

KEPT = 3
"""Number of frames of each person in the model's file. They serve for the mean posture, and for
methods that look up training frames."""

MOST_PERSONAL = 0.9
"""Largest share of the errors' variance, in any direction, that counts as personal."""

_LEAST = 1e-10
"""m2 and rad2, added to variances so that their matrix has an inverse."""

Progress = Callable[[float], None]


@dataclass(frozen=True)
class _Sized:
    """A person's frames at the trained hand's size: touches, contact vectors and poses."""

    source: str
    xy: Array
    u: Array
    leftmost: Array
    relative: Array
    q: Array


def at_trained_size(capture: Capture, size: float) -> Capture:
    """The capture, converted to the same postures of a hand of the trained hand's size.

    Args:
        capture: Capture of a hand.
        size: Its length relative to the trained hand.
    """
    q = capture.q.copy()
    q[:, ROOT_POSITION] /= size
    return replace(capture, xy=capture.xy / size, q=q, meta=capture.meta | {"size": 1.0})


def train_population(
    people: Sequence[Capture],
    population: Mapping[str, Any],
    name: str = POPULATION,
    progress: Progress | None = None,
) -> TrainedModel:
    """Trains the encoder for any person, the covariance of its errors, and a correction.

    Args:
        people: Captures of people to train on; `meta` has their `source`, `number` and `size`.
        population: Description of the population for the model's `meta`, as JSON values.
        name: Name of the model.
        progress: Called with the share done, 0 to 1.

    Raises:
        EncoderError: There are too few people.
    """
    if len(people) < 2 * FOLDS:
        raise EncoderError(
            "the population has too few people to train on",
            got=len(people),
            expected=f"{2 * FOLDS} or more",
            remedy="`python -m training people --out FILE` makes a population with enough people",
        )
    sized = [_sized(person) for person in people]
    rng = np.random.default_rng(0)
    steps = FOLDS + 2
    errors: list[Array] = []
    left_out: list[tuple[_Sized, NDArray[np.intp], Array]] = []
    for fold in range(FOLDS):
        encoder = _fitted([p for i, p in enumerate(sized) if i % FOLDS != fold], rng)
        for person in sized[fold::FOLDS]:
            count = max(2, round(JUDGED * SHARES[person.source]))
            frames = rng.integers(len(person.u), size=count)
            guess = encoder.predict(person.u[frames])
            left_out.append((person, frames, guess))
            errors.append(person.relative[frames] - guess)
        if progress:
            progress((fold + 1) / steps)
    covariance, personal = _covariances(errors, [guess for _, _, guess in left_out])
    correction = _correction(left_out, covariance)
    if progress:
        progress((FOLDS + 1) / steps)
    kept = [(p, rng.integers(len(p.u), size=KEPT)) for p in sized]
    meta = {
        "simulated": True,
        "capture": {"subject": "population", "simulated": True},
        "population": dict(population) | {"people": _numbers(people)},
        "shares": SHARES,
        "ridges": list(RIDGES),
    }
    model = TrainedModel(
        name,
        _fitted(sized, rng),
        covariance,
        np.concatenate([p.u[frames] for p, frames in kept]),
        np.concatenate([p.relative[frames] for p, frames in kept]),
        meta,
        correction,
        personal,
    )
    if progress:
        progress(1.0)
    return rounded(model)


def _sized(person: Capture) -> _Sized:
    capture = at_trained_size(person, float(person.meta["size"]))
    u, leftmost = contact_vectors(capture.xy)
    relative = relative_pose(capture.q, leftmost)
    return _Sized(str(person.meta["source"]), capture.xy, u, leftmost, relative, capture.q)


def _fitted(people: Sequence[_Sized], rng: np.random.Generator) -> YawNormalisedEncoder:
    """The encoder, fitted to random frames of people with the weights of their sources."""
    sources = [person.source for person in people]
    total = sum(SHARES[source] for source in set(sources))
    drawn = min(FRAMES, sum(len(person.u) for person in people))
    U, Q = [], []
    for person in people:
        share = SHARES[person.source] / total / sources.count(person.source)
        frames = rng.integers(len(person.u), size=round(drawn * share))
        U.append(person.u[frames])
        Q.append(person.relative[frames])
    return YawNormalisedEncoder(*RIDGES).fit(np.concatenate(U), np.concatenate(Q))


def _covariances(errors: Sequence[Array], guesses: Sequence[Array]) -> tuple[Array, Array]:
    """Second moments (48, 48) of errors, and their part (48, 48) that is constant for a person.

    The personal part is the second moment of the people's mean errors, in the frame that rotates
    with the hand, minus the variance that means of few frames have by chance.

    Args:
        errors: (T, 48) of each person.
        guesses: (T, 48) of each person, poses predicted for the same frames.
    """
    bounded = bounded_errors(np.concatenate(errors))
    parts = np.split(bounded, np.cumsum([len(e) for e in errors])[:-1])
    turned = [turned_root(e, -yaw_of(q)) for e, q in zip(parts, guesses, strict=True)]
    means = np.array([e.mean(axis=0) for e in turned])
    within = sum(np.cov(e, rowvar=False) / len(e) for e in turned) / len(turned)
    covariance = bounded.T @ bounded / len(bounded)
    # The personal part is expressed as shares of the errors. They are limited, so that no share is
    # below 0, and in no direction all errors are personal.
    root = np.linalg.cholesky(covariance + _LEAST * np.eye(len(covariance)))
    shares = np.linalg.solve(root, means.T @ means / len(means) - within)
    values, vectors = np.linalg.eigh(np.linalg.solve(root, shares.T))
    part = root @ vectors * np.sqrt(np.clip(values, 0.0, MOST_PERSONAL))
    return covariance, part @ part.T


def _correction(
    left_out: Sequence[tuple[_Sized, NDArray[np.intp], Array]], covariance: Array
) -> PersonCorrection:
    """The correction for people whose bones are unknown. Its distrust of touches is chosen by its
    errors on left-out people."""
    hand = Kinematics(ADULT)
    poses = np.concatenate([p.q[frames] for p, frames, _ in left_out])
    touches = np.concatenate([p.xy[frames] for p, frames, _ in left_out])
    guesses = np.concatenate(
        [absolute_pose(guess, p.leftmost[frames]) for p, frames, guess in left_out]
    )
    some = np.linspace(0, len(poses) - 1, min(len(poses), 4000)).astype(int)
    poses, touches, guesses = poses[some], touches[some], guesses[some]
    misses = (tip_targets(touches) - hand.tips(poses))[~np.isnan(touches[..., 0])]
    x, y, z = np.mean(misses**2, axis=0)
    variance = np.array([0.5 * (x + y), 0.5 * (x + y), z])
    tried = [
        PersonCorrection(ADULT, covariance, distrust * variance, distrust) for distrust in DISTRUSTS
    ]
    scores = [error_product(c.correct(guesses, touches), poses) for c in tried]
    return tried[int(np.argmin(scores))]


def _numbers(people: Sequence[Capture]) -> dict[str, list[int]]:
    """Numbers of the people by source. With the population's salt, they determine the seeds."""
    numbers: dict[str, list[int]] = {}
    for person in people:
        numbers.setdefault(str(person.meta["source"]), []).append(int(person.meta["number"]))
    return numbers
