"""How much of the pose error is left when there is more to learn from: a bound on better encoders.

    python -m benchmarks.bounds --subject second --days 6 --times 4

The same encoders, trained on day 0 alone, and on day 0 with free-play days of the same subject
until there are so many times as many frames. The judged days are free play, too, so the extra days
help more than as many scripted ones would. What no amount of frames explains stays: lifted fingers,
habits of a take, sensors placed anew. True labels; everything is simulated.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.machine import describe_machine
from encoders.capture import Capture
from encoders.evaluation.best import blocked_predictions
from encoders.evaluation.errors import pose_errors
from encoders.evaluation.subjects import SUBJECTS, Subject, subject
from encoders.regression.bone_fit import fitted_skeleton
from encoders.regression.person_correction import PersonCorrection, blocked_variance
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.turned import TurnedEncoder
from encoders.validation import robust_covariance
from models.pose import absolute_pose
from models.skeleton import ADULT

Array = NDArray[np.float64]
AnyEncoder = PolynomialEncoder | TurnedEncoder

ENCODERS: dict[str, Callable[[], AnyEncoder]] = {
    "least-squares quadratic (the paper's)": lambda: PolynomialEncoder(2),
    "least-squares cubic": lambda: PolynomialEncoder(3),
    "quadratic, ridge 0.03": lambda: PolynomialEncoder(2, 0.03),
    "turned, ridge 0.03 (best's kind)": lambda: TurnedEncoder(0.03, 0.03),
}

FOLDS = 5
MORE_DAYS = 1_000
"""Day seed of the free-play days that are learned from; judged days have another."""


def joined(captures: list[Capture]) -> Capture:
    """One capture of several; their trials stay apart."""
    first, trial = 0, []
    for capture in captures:
        trial.append(capture.trial + first)
        first += int(capture.trial.max()) + 1
    parts = zip(*((c.time, c.ids, c.xy, c.q) for c in captures), strict=True)
    time, ids, xy, q = (np.concatenate(part) for part in parts)
    return Capture(time, np.concatenate(trial), ids, xy, q, captures[0].meta)


def more(person: Subject, times: int) -> Capture:
    """Day 0 and as many free-play days as make `times` as many frames."""
    captures = [person.day(0, None)]
    wanted = times * len(captures[0])
    for number in person.judged_days(10 * times, MORE_DAYS):
        if sum(map(len, captures)) >= wanted:
            break
        captures.append(person.day(number, None))
    return joined(captures)


def errors(make: Callable[[], AnyEncoder], training: Capture, tests: list[Capture]) -> list[float]:
    """Mean wrist error (cm) and joint angle (degrees), plain and corrected by fitted bones."""
    U, Q = training.u, training.relative
    residuals = Q - blocked_predictions(make, training, FOLDS)
    correction = PersonCorrection(
        fitted_skeleton(training, ADULT),
        robust_covariance(residuals),
        blocked_variance(training, ADULT),
    )
    encoder = make().fit(U, Q)
    found = []
    for test in tests:
        plain = absolute_pose(encoder.predict(test.u), test.leftmost)
        for q in (plain, correction.correct(plain, test.xy)):
            e = pose_errors(q, test.q)
            found += [e.wrist.mean(), e.angle.mean()]
    means: list[float] = np.reshape(found, (len(tests), -1)).mean(axis=0).tolist()
    return means


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--subject", choices=sorted(SUBJECTS), default="second")
    parser.add_argument("--days", type=int, default=6, help="judged days")
    parser.add_argument("--day-seed", type=int, default=0)
    parser.add_argument("--times", type=int, default=4, help="how many times the frames of day 0")
    options = parser.parse_args()
    console, person = Console(width=110), subject(options.subject)
    days = person.judged_days(options.days, options.day_seed)
    console.print(describe_machine())
    console.print(f"SIMULATED subject {options.subject}, seed {person.seed}; judged days {days}")
    tests = [person.day(day, None) for day in track(days, "judged days", console=console)]
    table = Table("encoder", "frames", "wrist cm", "joints deg", "corrected wrist", "and joints")
    for training in (person.day(0, None), more(person, options.times)):
        for name, make in ENCODERS.items():
            row = (f"{value:.2f}" for value in errors(make, training, tests))
            table.add_row(name, f"{len(training):,}", *row)
    console.print(table)


if __name__ == "__main__":
    main()
