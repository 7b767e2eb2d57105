"""Measures the errors of a hand of another size, and what calibrating it gives back.

The simulated subject gets hands of 85 to 115 % of the trained one; its habits, the pad of its
fingertips, the screen and the noise stay as they are. `best`, trained on the hand of 100 %, then
reconstructs days that follow by SHA-256 from the subject's configuration:

- without: touches as they are, as if the hand were the trained one;
- calibrated: touches divided by the size that `encoders.person.hand_size` estimates from three
  spreads of
  five fingers, and the pose multiplied by it. The spreads are the subject's own, from a day that is
  not tested: the middle and both ends of its five-finger layouts stand for what it would do if
  asked. Drawn several times; the sizes found are printed, and the first one is used;
- known: the same with the true size, which no calibration can beat by much.

    python -m benchmarks.hand_size --days 2
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track

from benchmarks.machine import describe_machine
from encoders.capture import Capture
from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.evaluation import Method
from encoders.evaluation.errors import pose_errors
from encoders.evaluation.intervals import block_interval
from encoders.evaluation.labels import SEVERAL, own_labels
from encoders.evaluation.subjects import subject
from encoders.evaluation.training import Training
from encoders.labels.labelling import Labeller, Labelling
from encoders.person.hand_size import builtin_sizes
from encoders.regression.trained import builtin_capture
from models.arithmetic.arrays import Array
from models.errors import InputError
from models.pose import ROOT_POSITION
from models.skeleton import ADULT

SIZES = (0.85, 0.90, 1.00, 1.10, 1.15)
DRAWS = 20
"""Calibrations of each hand, to see how far they scatter."""

RANKS = (0.5, 0.05, 0.95)
AROUND = 0.04
"""Shares of the subject's five-finger layouts, by size, that are its natural, closed and wide one,
and how far around them a draw is taken."""


@dataclass(frozen=True)
class SizedLabels:
    """A labeller that sees touches of another hand as those of the trained one."""

    labeller: Labeller
    size: float

    @property
    def remembers(self) -> bool:
        return self.labeller.remembers

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        scaled = {i: (x / self.size, y / self.size) for i, (x, y) in contacts.items()}
        return self.labeller.assign(scaled, fixed)

    def reset(self) -> None:
        self.labeller.reset()

    def restart(self) -> None:
        self.labeller.restart()


def layouts(capture: Capture, rng: np.random.Generator) -> list[Array]:
    """Three spreads (5, 2) m out of a day."""
    xy = capture.xy[capture.down.all(axis=1)]
    order = np.argsort(np.linalg.norm(xy - xy.mean(axis=1, keepdims=True), axis=(1, 2)))
    places = [rank + rng.uniform(-AROUND, AROUND) for rank in RANKS]
    return [xy[order[round(place * (len(order) - 1))]] for place in places]


def calibrations(capture: Capture, draws: int) -> tuple[list[float], int]:
    """Sizes found in several draws from a day, and how many draws were refused."""
    rng = np.random.default_rng(0)
    found, refused = [], 0
    for _ in range(draws):
        try:
            found.append(builtin_sizes().estimate(layouts(capture, rng)).ratio)
        except InputError:
            refused += 1
    return found, refused


def row(method: Method, tests: list[Capture], size: float) -> list[str]:
    """Wrist and joint errors with true and own labels, and labels, of days scaled by a size."""
    wrist: dict[bool, list[Array]] = {True: [], False: []}
    angle: dict[bool, list[Array]] = {True: [], False: []}
    right, several, block = [], [], []
    for number, capture in enumerate(tests):
        own = own_labels(
            capture, lambda: SizedLabels(method.labeller(), size), method.history, number
        )
        for true_labels, xy in ((True, capture.xy), (False, own.xy)):
            q = method.estimate(capture.time, capture.trial, xy / size)
            q = q.copy()
            q[:, ROOT_POSITION] *= size
            errors = pose_errors(q, capture.q)
            wrist[true_labels].append(errors.wrist)
            angle[true_labels].append(errors.angle)
        right.append(own.right)
        several.append(np.isin(capture.down.sum(axis=1), SEVERAL))
        block.append(1000 * number + capture.trial)
    takes, chosen = np.concatenate(block), np.concatenate(several)
    columns = [np.concatenate(part[k]) for k in (True, False) for part in (wrist, angle)]
    cells = [_cell(column, takes, ".2f") for column in columns]
    named = np.asarray(100.0 * np.concatenate(right)[chosen], float)
    return [*cells, _cell(named, takes[chosen], ".1f")]


def _cell(values: Array, takes: NDArray[np.int64], form: str) -> str:
    low, high = block_interval(values, takes)
    return f"{values.mean():{form}} ({low:{form}} to {high:{form}})"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--days", type=int, default=2, help="tested days of every hand")
    parser.add_argument("--day-seed", type=int, default=0)
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES)
    options = parser.parse_args()
    console = Console(width=200, highlight=False)
    calibrated_on, *tested = subject("first").judged_days(options.days + 1, options.day_seed)
    method = Training(builtin_capture(), shipped=True).method("best")
    console.print(describe_machine())
    console.print(
        f"SIMULATED subject {SEED} of configuration {subject('first').digest[:12]}, "
        f"calibrated on day {calibrated_on}, tested on days {tested}; "
        "means and 95 % intervals over takes"
    )
    head = ["hand", "touches", "wrist cm", "joints deg", "wrist cm, own labels"]
    head += ["joints deg, own labels", "labels right, 2 to 5 fingers, %"]
    console.print(f"| {' | '.join(head)} |\n|{' --- |' * len(head)}", markup=False)
    notes = []
    for size in track(options.sizes, "hands", console=Console(stderr=True)):
        hand = ADULT.scaled(size)
        days = [simulate(FROZEN, SEED, day, skeleton=hand) for day in tested]
        found, refused = calibrations(simulate(FROZEN, SEED, calibrated_on, skeleton=hand), DRAWS)
        notes.append(
            f"hand {size:g}: sizes found {np.mean(found):.3f} on average, "
            f"{min(found):.3f} to {max(found):.3f} in {len(found)} calibrations, {refused} refused"
        )
        for name, used in (("without", 1.0), ("calibrated", found[0]), ("known", size)):
            what = name if name != "calibrated" else f"calibrated: {used:.3f}"
            cells = " | ".join(row(method, days, used))
            console.print(f"| {size:g} | {what} | {cells} |", markup=False)
    console.print("\n".join(notes), markup=False)


if __name__ == "__main__":
    main()
