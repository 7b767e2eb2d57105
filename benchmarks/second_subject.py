"""The paper's method alone on the second simulated subject, beside the bands fixed beforehand.

    python -m benchmarks.second_subject --seeds 10 11 12 13 --days 1 2

Every seed is another subject; it is trained on day 0 and tested on later days. Least squares, true
labels for errors, no correction, no filter; labels by the paper's rule, every third frame by
itself. The bands and their reasons are in docs/second-subject.md.
"""

from __future__ import annotations

import argparse

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.labels import EVERY, contacts_of
from benchmarks.table1 import PAPER_VARIANCE, errors, variance_shares
from encoders.capture import Capture
from encoders.captures.second_subject import FROZEN, SecondConfiguration, simulate
from encoders.labels.labelling import PaperLabels
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.trained import TrainedModel
from models.arithmetic.arrays import Array
from models.pose import POSE_SIZE

DEGREES = {"linear": 1, "quadratic": 2, "cubic": 3}

BANDS = {
    "wrist, cm": (2.55, 2.0, 3.1),
    "joint angle, degrees": (8.57, 7.5, 10.0),
    "labels right with 2 fingers, %": (55.7, 40.0, 65.0),
    "labels right with 3 fingers, %": (70.7, 45.0, 75.0),
    "labels right with 4 fingers, %": (79.4, 55.0, 85.0),
    "labels right with 5 fingers, %": (99.9, 95.0, 100.0),
    **{
        f"variance in {k} components, %": (share, share - 8.0, share + 8.0)
        for k, share in PAPER_VARIANCE.items()
    },
}
"""Quantity -> the paper's number, least and greatest that is accepted."""


def labels_right(training: Capture, test: Capture) -> list[float]:
    """Percent of frames with 2, 3, 4 and 5 contacts that the paper's rule labels without error."""
    encoder = PolynomialEncoder(2).fit(training.u, training.relative)
    model = TrainedModel("", encoder, np.eye(POSE_SIZE), training.u, training.relative)
    labeller = PaperLabels(model)
    right: dict[int, list[bool]] = {k: [] for k in range(2, 6)}
    for frame in range(0, len(test), EVERY):
        contacts, truth = contacts_of(test, frame)
        right[len(truth)].append(labeller.assign(contacts, {}).labels == truth)
    return [100 * float(np.mean(r)) for r in right.values()]


def measure(
    configuration: SecondConfiguration, seeds: list[int], days: list[int]
) -> tuple[Array, dict[str, Array]]:
    """(seeds, days, 10) quantities in the order of `BANDS`; errors (seeds, days, 3) by encoder."""
    rows = np.empty((len(seeds), len(days), len(BANDS)))
    found = {name: np.empty((len(seeds), len(days), 3)) for name in DEGREES}
    for i, seed in enumerate(track(seeds, "subjects", console=Console(stderr=True))):
        training = simulate(configuration, seed, 0)
        U, Q = training.u, training.relative
        shares = variance_shares(Q)
        fitted = {n: PolynomialEncoder(d).fit(U, Q).predict for n, d in DEGREES.items()}
        for j, day in enumerate(days):
            test = simulate(configuration, seed, day)
            for name, predict in fitted.items():
                found[name][i, j] = errors(predict, test)
            wrist, angle, _ = found["quadratic"][i, j]
            rows[i, j] = [wrist, angle, *labels_right(training, test), *shares]
    return rows, found


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[10, 11, 12, 13])
    parser.add_argument("--days", type=int, nargs="+", default=[1, 2])
    options = parser.parse_args()
    rows, found = measure(FROZEN, options.seeds, options.days)
    console = Console(width=110)
    console.print(
        f"second simulated subjects {options.seeds}, each trained on day 0 and tested on days "
        f"{options.days}; the paper's method; mean (least to greatest over subjects and days)"
    )
    table = Table("quantity", "here", "paper", "band", "")
    for (name, (paper, low, high)), x in zip(BANDS.items(), np.moveaxis(rows, -1, 0), strict=True):
        verdict = "in" if low <= x.mean() <= high else "OUT"
        here = f"{x.mean():.2f} ({x.min():.2f} to {x.max():.2f})"
        table.add_row(name, here, f"{paper:g}", f"{low:g} to {high:g}", verdict)
    console.print(table)
    others = Table("least squares", "wrist cm", "joint angle deg", "|component| deg")
    for name, e in found.items():
        others.add_row(
            name,
            *(f"{x.mean():.2f} ({x.min():.2f} to {x.max():.2f})" for x in np.moveaxis(e, -1, 0)),
        )
    console.print(others)


if __name__ == "__main__":
    main()
