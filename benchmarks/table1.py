"""Measures the errors of the paper's Table 1 on simulated subjects.

    python -m benchmarks.table1 --seeds 10 11 12 13 --days 1 2 3

Every seed is another subject. Encoders are trained on day 0 and tested on later days, with true
labels and without correction and filter. The errors are those of reconstructions on simulated
captures, whose configuration was tuned on seeds 0 to 2 (docs/encoding.md). The paper's numbers are
printed beside them for comparison only.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from encoders.capture import Capture
from encoders.captures.subject import FROZEN, simulate
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.training import train
from models.arithmetic import Array
from models.pose import ROOT_POSITION, joint_vectors
from models.rotations import geodesic_angle

Predict = Callable[[Array], Array]

PAPER = {"linear": (3.98, 9.08), "quadratic": (2.55, 8.57), "cubic": (3.17, 9.94)}
"""Method -> mean distance (cm) and angle (degrees), Table 1 of Chung, Kim, Han and Pollard
(2015)."""

PAPER_VARIANCE = {3: 68, 6: 87, 9: 94, 12: 97}
"""Number of principal components -> percent of the training data's variance, section 3 of the
paper."""


def errors(predict: Predict, capture: Capture) -> tuple[float, float, float]:
    """Returns the mean errors of predictions: distance of the wrist (cm), geodesic angle of the
    ball joints (degrees), and absolute component of their rotation vectors (degrees)."""
    guess, truth = predict(capture.u), capture.relative
    distance = np.linalg.norm((guess - truth)[:, ROOT_POSITION], axis=1)
    angle = geodesic_angle(joint_vectors(guess), joint_vectors(truth))
    component = np.abs(joint_vectors(guess) - joint_vectors(truth))
    turned, bent = (float(np.rad2deg(a.mean())) for a in (angle, component))
    return 100 * float(distance.mean()), turned, bent


def methods(capture: Capture) -> dict[str, Predict]:
    """Trains the compared methods on a capture: the paper's least squares, and ridge regression
    with a cross-validated penalty."""
    U, Q = capture.u, capture.relative
    mean = Q.mean(axis=0)
    return {
        "mean pose": lambda u: np.broadcast_to(mean, (len(u), len(mean))),
        "linear": PolynomialEncoder(1).fit(U, Q).predict,
        "quadratic": PolynomialEncoder(2).fit(U, Q).predict,
        "cubic": PolynomialEncoder(3).fit(U, Q).predict,
        "ridge quadratic": train(capture, "ridge", 2, None).encoder.predict,
    }


def variance_shares(poses: Array) -> list[float]:
    """Returns the percentages of the variance of vectors (T, n) in their first 3, 6, 9 and 12
    principal components."""
    values = np.linalg.eigvalsh(np.cov(poses.T))[::-1]
    return [float(100 * values[:k].sum() / values.sum()) for k in PAPER_VARIANCE]


def measure(seeds: list[int], days: list[int]) -> tuple[dict[str, Array], Array, Array]:
    """Measures errors (seeds, days, 3) by method, and percentages of variance (seeds, 4) of poses
    and of joints."""
    found: dict[str, list[list[tuple[float, float, float]]]] = {}
    whole, joints = [], []
    for seed in track(seeds, "subjects", console=Console(stderr=True)):
        training = simulate(FROZEN, seed, 0)
        whole.append(variance_shares(training.relative))
        joints.append(variance_shares(training.relative[:, 6:]))
        tests = [simulate(FROZEN, seed, day) for day in days]
        for name, predict in methods(training).items():
            found.setdefault(name, []).append([errors(predict, test) for test in tests])
    return {n: np.array(e) for n, e in found.items()}, np.array(whole), np.array(joints)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[10, 11, 12, 13])
    parser.add_argument("--days", type=int, nargs="+", default=[1, 2, 3])
    options = parser.parse_args()
    found, whole, joints = measure(options.seeds, options.days)
    console = Console(width=110)
    console.print(
        f"simulated subjects {options.seeds}, each trained on day 0 and tested on days "
        f"{options.days}; true labels; mean (least to greatest over subjects and days)"
    )
    table = Table("method", "wrist cm", "paper", "joint angle deg", "paper", "|component| deg")
    for name, e in found.items():
        wrist, angle, component = (
            f"{x.mean():.2f} ({x.min():.2f} to {x.max():.2f})" for x in np.moveaxis(e, -1, 0)
        )
        there = [f"{x:.2f}" for x in PAPER.get(name, ())] or ["", ""]
        table.add_row(name, wrist, there[0], angle, there[1], component)
    console.print(table)
    variance = Table("principal components", *map(str, PAPER_VARIANCE), title="percent of variance")
    variance.add_row("48 numbers of the relative pose (m, rad)", *_percent(whole))
    variance.add_row("42 numbers of the joints (rad)", *_percent(joints))
    variance.add_row("paper", *map(str, PAPER_VARIANCE.values()))
    console.print(variance)


def _percent(shares: Array) -> list[str]:
    return [f"{x:.1f}" for x in shares.mean(axis=0)]


if __name__ == "__main__":
    main()
