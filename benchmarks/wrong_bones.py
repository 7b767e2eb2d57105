"""The estimate of a person's pose when the bones are known wrongly: does correcting it still pay?

    python -m benchmarks.wrong_bones --subject first --days 4

Skeletons are made wrong (bones by 6 %, knuckles by 4 mm, other draws than validation's), and the
correction is trained from each, with bones fitted to the capture and without. Judged on days that
follow from the subject's configuration; true labels, no filter; everything is simulated.
"""

from __future__ import annotations

import argparse

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from encoders.capture import Capture
from encoders.evaluation.best import blocked_predictions
from encoders.evaluation.errors import pose_errors
from encoders.evaluation.subjects import SUBJECTS, subject
from encoders.regression.bone_fit import perturbed_skeleton
from encoders.regression.person_correction import (
    WRONG_KNUCKLE,
    WRONG_LENGTH,
    PersonCorrection,
    train_correction,
)
from encoders.regression.turned import TurnedEncoder
from encoders.validation import robust_covariance
from models.pose import absolute_pose
from models.skeleton import ADULT, Skeleton

DRAWS = 1_000
"""Seed of the wrong skeletons; validation's own come from seed 0."""


def encoder() -> TurnedEncoder:
    """The kind of encoder that `best` has."""
    return TurnedEncoder(0.03, 0.1)


def measured(
    correction: PersonCorrection | None, trained: TurnedEncoder, tests: list[Capture]
) -> tuple[float, float]:
    """Mean wrist error (cm) and joint angle (degrees) over the test captures."""
    found = []
    for test in tests:
        q = absolute_pose(trained.predict(test.u), test.leftmost)
        if correction:
            q = correction.correct(q, test.xy)
        errors = pose_errors(q, test.q)
        found.append((errors.wrist.mean(), errors.angle.mean()))
    wrist, angle = np.mean(found, axis=0).tolist()
    return wrist, angle


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--subject", choices=sorted(SUBJECTS), default="first")
    parser.add_argument("--days", type=int, default=4, help="judged days")
    parser.add_argument("--day-seed", type=int, default=0)
    parser.add_argument("--skeletons", type=int, default=4, help="wrong ones")
    options = parser.parse_args()
    console, person = Console(width=100), subject(options.subject)
    days = person.judged_days(options.days, options.day_seed)
    console.print(f"SIMULATED subject {options.subject}, seed {person.seed}; judged days {days}")
    tests = [person.day(day, None) for day in track(days, "judged days", console=console)]
    training = person.day(0, None)
    predicted = blocked_predictions(encoder, training)
    covariance = robust_covariance(training.relative - predicted)
    trained = encoder().fit(training.u, training.relative)
    rng = np.random.default_rng(DRAWS)
    skeletons: dict[str, Skeleton] = {"the sandbox's": ADULT}
    for i in range(options.skeletons):
        wrong = perturbed_skeleton(ADULT, rng, WRONG_LENGTH, WRONG_KNUCKLE)
        skeletons[f"wrong by 6 %, {i + 1}"] = wrong
    table = Table("bones", "fitted to the capture", "distrust", "wrist cm", "joints deg")
    wrist, angle = measured(None, trained, tests)
    table.add_row("no correction", "", "", f"{wrist:.2f}", f"{angle:.2f}")
    for name, skeleton in skeletons.items():
        for fit in (True, False):
            made = train_correction(training, predicted, covariance, skeleton, fit)
            wrist, angle = measured(made, trained, tests)
            row = ("yes" if fit else "no", f"{made.distrust:g}", f"{wrist:.2f}", f"{angle:.2f}")
            table.add_row(name, *row)
    console.print(table)


if __name__ == "__main__":
    main()
