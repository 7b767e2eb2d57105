"""Training of the pose of any person's hand on a population of simulated people.

A person's layouts are divided by the size of the hand, and so is the place of the wrist. A larger
hand in the same posture then gives the same numbers, and every person tells something about the
others. The encoder is the one that turns with the hand (`yaw_normalised`). Its errors are those of
people it was not trained on. What stays of them, for one person, in all frames is written down by
itself: a resting posture that touches do not show, and that seeing the hand does
(`encoders.person.rest_posture`).
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
"""Share of every source of people in the frames. Chosen on people to choose on, for encoders that
had not seen their generator: without posed people such strangers' joint angles are worse, with more
of them the wrist is."""

RIDGES = (0.03, 0.1)
"""Penalties of the encoder, chosen on the same people."""

FRAMES = 60_000
"""Most frames that are drawn for a fit; each person of a source gives as many as the others."""

FOLDS = 3
"""Parts into which people are divided to measure errors on people who were left out."""

JUDGED = 120
"""Frames of each left-out person in which errors are measured; posed people give their share."""

KEPT = 3
"""Frames of each person that the model's file keeps: for the mean posture, and for methods that
look up training frames."""

MOST_PERSONAL = 0.9
"""Greatest share of the variance, in any direction, that counts as personal."""

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
    """The capture of the same postures by a hand of the trained hand's size.

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
        population: What the model's `meta` says of the population: JSON values.
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
            remedy="`python -m training people --out FILE` makes one with people to train on",
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
    """The encoder fitted to frames of people, by the shares of their sources."""
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
    """Second moments (48, 48) of errors, and the part of them that a person has in all frames.

    The personal part is that of the mean errors in the frame that turns with the hand, less what
    means of few frames scatter.

    Args:
        errors: (T, 48) of each person.
        guesses: (T, 48) the encoder's poses for the same frames.
    """
    bounded = bounded_errors(np.concatenate(errors))
    parts = np.split(bounded, np.cumsum([len(e) for e in errors])[:-1])
    turned = [turned_root(e, -yaw_of(q)) for e, q in zip(parts, guesses, strict=True)]
    means = np.array([e.mean(axis=0) for e in turned])
    within = sum(np.cov(e, rowvar=False) / len(e) for e in turned) / len(turned)
    covariance = bounded.T @ bounded / len(bounded)
    # As shares of the errors: none is below 0, and in no direction are all errors personal.
    root = np.linalg.cholesky(covariance + _LEAST * np.eye(len(covariance)))
    shares = np.linalg.solve(root, means.T @ means / len(means) - within)
    values, vectors = np.linalg.eigh(np.linalg.solve(root, shares.T))
    part = root @ vectors * np.sqrt(np.clip(values, 0.0, MOST_PERSONAL))
    return covariance, part @ part.T


def _correction(
    left_out: Sequence[tuple[_Sized, NDArray[np.intp], Array]], covariance: Array
) -> PersonCorrection:
    """The correction for people whose bones nobody knows, with a validated trust in touches."""
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
    """Numbers of the people by source, which give their seeds with the population's salt."""
    numbers: dict[str, list[int]] = {}
    for person in people:
        numbers.setdefault(str(person.meta["source"]), []).append(int(person.meta["number"]))
    return numbers
