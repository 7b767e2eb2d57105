"""What bounds the pose of strangers: the number of people, and what touches do not tell.

    sandbox subject population --group train --out people.npz
    python -m benchmarks.pose_bound --population people.npz

Encoders alone, with true names, trained on people of the other sources: on an eighth, a quarter, a
half and all of them. Beside each what an oracle would add that removes the judged person's mean
error, and nothing else. Then how much of people's mean errors a person's mean layout of five
fingers explains, by ridge regression cross-validated over people.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.one_line import run
from encoders.capture import Capture
from encoders.captures.population import load_population
from encoders.evaluation.errors import pose_errors
from encoders.evaluation.subjects import subject
from encoders.regression.population_training import at_trained_size, fitted_to
from encoders.regression.yaw_normalised import YawNormalisedEncoder, turned_root, yaw_of
from models.arithmetic.arrays import Array
from models.pose import JOINTS, ROOT_POSITION, absolute_pose

_BARS = Console(stderr=True)

FOLDS = 5
RIDGES = (1.0, 10.0, 30.0, 100.0, 300.0)


def constant_error(encoder: YawNormalisedEncoder, captures: Sequence[Capture]) -> Array:
    """Mean error (48,) in the frame that turns with the hand."""
    U, Q = (np.concatenate([getattr(c, n) for c in captures]) for n in ("u", "relative"))
    guess = encoder.predict(U)
    return np.asarray(turned_root(Q - guess, -yaw_of(guess)).mean(axis=0))


def judged(encoder: YawNormalisedEncoder, days: Sequence[Capture], offset: Array) -> str:
    """Errors of the wrist and of the joints, with a constant offset added."""
    wrist, angle = [], []
    for day in days:
        guess = encoder.predict(day.u)
        moved = guess + turned_root(np.tile(offset, (len(guess), 1)), yaw_of(guess))
        errors = pose_errors(absolute_pose(moved, day.leftmost), day.q)
        wrist.append(errors.wrist)
        angle.append(errors.angle)
    return f"{np.concatenate(wrist).mean():.2f} / {np.concatenate(angle).mean():.1f}"


def mean_layout(person: Capture) -> Array:
    """Mean layout (10,) m of five fingers, its thumb and middle finger in one direction."""
    xy = person.xy[person.down.all(axis=1)]
    centred = xy - xy.mean(axis=1, keepdims=True)
    z = centred[..., 0] - 1j * centred[..., 1]
    z = z * np.exp(-1j * np.angle(z[:, :1] - z[:, 2:3]))
    mean = z.mean(axis=0)
    return np.concatenate([mean.real, mean.imag])


def explained(layouts: Array, errors: Array, part: slice) -> float:
    """Greatest share of the variance of people's errors (n, 48) that their layouts explain, over
    all ridges."""
    X = (layouts - layouts.mean(axis=0)) / layouts.std(axis=0)
    fold = np.arange(len(X)) % FOLDS
    shares = []
    for ridge in RIDGES:
        left = np.empty_like(errors)
        for k in range(FOLDS):
            A, mean = X[fold != k], errors[fold != k].mean(axis=0)
            coefficients = np.linalg.solve(
                A.T @ A + ridge * np.eye(A.shape[1]), A.T @ (errors[fold != k] - mean)
            )
            left[fold == k] = errors[fold == k] - mean - X[fold == k] @ coefficients
        off = errors - errors.mean(axis=0)
        shares.append(1.0 - np.sum(left[:, part] ** 2) / np.sum(off[:, part] ** 2))
    return float(max(shares))


def main() -> None:
    """Prints both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--population", type=Path, required=True, help="people to train on")
    parser.add_argument("--days", type=int, default=12, help="judged days of each frozen subject")
    options = parser.parse_args()
    train = load_population(options.population).of(group="train")
    table = Table("judged", "people", "wrist cm / joints deg", "with an oracle of the mean error")
    told = Table("trained without", "wrist, % explained", "joints, % explained")
    for held in ("second", "first"):
        one = subject(held)
        days = [one.day(day, None) for day in one.judged_days(options.days, 0)]
        people = train.of(without=held).people
        for part in track((8, 4, 2, 1), f"{held} subject", console=_BARS):
            encoder = fitted_to(people[::part])
            oracle = judged(encoder, days, constant_error(encoder, days))
            plain = judged(encoder, days, np.zeros(48))
            table.add_row(held, str(len(people[::part])), plain, oracle)
        sized = [at_trained_size(p, float(p.meta["size"])) for p in people]
        layouts, errors = [], []
        for k in range(3):
            encoder = fitted_to([p for i, p in enumerate(people) if i % 3 != k])
            for person in sized[k::3]:
                layouts.append(mean_layout(person))
                errors.append(constant_error(encoder, [person]))
        X, E = np.array(layouts), np.array(errors)
        told.add_row(
            held, *(f"{100 * explained(X, E, part):.1f}" for part in (ROOT_POSITION, JOINTS))
        )
    console = Console(width=110)
    console.print(table)
    console.print(told)


if __name__ == "__main__":
    run(main)
