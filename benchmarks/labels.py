"""Measures how often fingers are named right: this project's labellers beside the paper's Table 2.

Test days are free play of the simulated subject, drawn by SHA-256 from the frozen configuration and
the trained belief, so that nobody chose them. Two questions are asked of every labeller:

- alone: every frame by itself, nothing known of what came before (as in Table 2);
- in play: labels are decided when a contact appears, with whatever the labeller remembers, and are
  carried until the next one does (as in the program).

A frame counts as right if all its contacts are. One finger: at the end of every stretch all other
fingers leave; alone, a lone contact that nothing is known of.

The belief assumes that thumb and neighbouring fingers touch together more often than other sets,
and so does the simulated subject; the last rows are the belief without that assumption.

    python -m benchmarks.labels --days 3
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.machine import describe_machine
from encoders.capture import Capture
from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.labels.assignment import AssignmentLabels
from encoders.labels.belief import BeliefLabels, builtin_belief, builtin_trained_belief
from encoders.labels.label_evidence import LabelEvidence, even_prior
from encoders.labels.labelling import Labeller, PaperLabels
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.trained import TrainedModel, builtin_capture
from models.pose import POSE_SIZE

PAPER = {
    "Linear": (52.66, 34.04, 64.35, 66.87),
    "Quadratic": (55.66, 70.72, 79.36, 99.88),
    "Cubic": (56.24, 52.38, 86.49, 99.33),
    "PCA IK": (51.85, 51.50, 48.15, 62.88),
}
"""Table 2 of Chung, Kim, Han and Pollard (2015): accuracy (%) with 2, 3, 4 and 5 fingers."""

COUNTS = (1, 2, 3, 4, 5)
RESAMPLES = 2000
"""Number of resamples of takes for the 95 % interval; frames of one take are not independent."""

EVERY = 3
"""Every so many frames, one is judged: at 30 Hz, neighbouring frames are nearly equal."""


def test_days(count: int) -> list[int]:
    """Days that follow from the configuration and the belief."""
    text = json.dumps(FROZEN.as_json(), sort_keys=True) + builtin_trained_belief().digest
    return [
        1 + int.from_bytes(sha256(f"{text}\n{i}".encode()).digest()[:3], "big")
        for i in range(count)
    ]


def labellers() -> dict[str, Labeller]:
    """Every method, trained on the built-in capture."""
    U, Q = builtin_capture().u, builtin_capture().relative

    def model(degree: int) -> TrainedModel:
        encoder = PolynomialEncoder(degree).fit(U, Q)
        return TrainedModel("", encoder, np.eye(POSE_SIZE), U, Q)

    quadratic, trained = model(2), builtin_trained_belief()
    known = trained.evidence
    even = LabelEvidence(known.layouts, known.shapes, known.order, even_prior())
    return {
        "paper's rule, linear": PaperLabels(model(1)),
        "paper's rule, quadratic": PaperLabels(quadratic),
        "paper's rule, cubic": PaperLabels(model(3)),
        "paper's rule, touches (its PCA IK)": PaperLabels(quadratic, "touches"),
        "assignment to expected places": AssignmentLabels(quadratic),
        "belief": builtin_belief(),
        "belief, finger sets equally likely": BeliefLabels(replace(trained, evidence=even)),
    }


@dataclass
class Tally:
    """Right and judged frames by number of fingers, take by take."""

    right: dict[int, list[int]] = field(default_factory=lambda: {k: [] for k in COUNTS})
    judged: dict[int, list[int]] = field(default_factory=lambda: {k: [] for k in COUNTS})

    def new_take(self) -> None:
        for counts in (self.right, self.judged):
            for column in counts.values():
                column.append(0)

    def add(self, fingers: int, right: bool) -> None:
        self.right[fingers][-1] += right
        self.judged[fingers][-1] += 1

    def percent(self, counts: tuple[int, ...]) -> float:
        judged = sum(sum(self.judged[k]) for k in counts)
        right = sum(sum(self.right[k]) for k in counts)
        return 100.0 * right / judged if judged else float("nan")

    def interval(self, counts: tuple[int, ...]) -> tuple[float, float]:
        """95 % of resampled takes."""
        right = np.sum([self.right[k] for k in counts], axis=0)
        judged = np.sum([self.judged[k] for k in counts], axis=0)
        picks = np.random.default_rng(0).integers(0, len(right), (RESAMPLES, len(right)))
        shares = 100.0 * right[picks].sum(axis=1) / judged[picks].sum(axis=1)
        low, high = np.percentile(shares, [2.5, 97.5])
        return float(low), float(high)


def contacts_of(
    capture: Capture, frame: int
) -> tuple[dict[int, tuple[float, float]], dict[int, int]]:
    """Contacts of a frame by id, and their true fingers."""
    fingers = np.flatnonzero(capture.down[frame])
    ids, xy = capture.ids[frame], capture.xy[frame]
    return (
        {int(ids[f]): (float(xy[f, 0]), float(xy[f, 1])) for f in fingers},
        {int(ids[f]): int(f) for f in fingers},
    )


def takes(capture: Capture) -> Iterator[np.ndarray]:
    """Frames of every take."""
    for trial in np.unique(capture.trial):
        yield np.flatnonzero(capture.trial == trial)


def alone(labeller: Labeller, days: list[Capture]) -> Tally:
    """Every frame by itself."""
    tally = Tally()
    for capture in days:
        for frames in takes(capture):
            tally.new_take()
            for frame in frames[::EVERY]:
                contacts, truth = contacts_of(capture, frame)
                labeller.reset()
                tally.add(len(truth), labeller.assign(contacts, {}).labels == truth)
            # The take's last frame once more, one finger at a time.
            for contact, finger in truth.items():
                labeller.reset()
                found = labeller.assign({contact: contacts[contact]}, {}).labels
                tally.add(1, found == {contact: finger})
    return tally


def in_play(labeller: Labeller, days: list[Capture]) -> Tally:
    """Labels decided when contacts appear and carried while they live."""
    tally = Tally()
    for capture in days:
        for frames in takes(capture):
            tally.new_take()
            labeller.reset()
            labels: Mapping[int, int] = {}
            truth: dict[int, int] = {}
            for frame in frames:
                contacts, now = contacts_of(capture, frame)
                if now != truth:
                    for contact, finger in truth.items():
                        tally.add(1, labels[contact] == finger)
                if now.keys() - truth.keys():
                    labels = labeller.assign(contacts, {}).labels
                truth = now
                tally.add(len(truth), {i: labels[i] for i in truth} == truth)
    return tally


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--days", type=int, default=3, help="how many test days")
    console = Console(width=110)
    numbers = test_days(parser.parse_args().days)
    console.print(describe_machine())
    days = [simulate(FROZEN, SEED, day) for day in track(numbers, "test days", console=console)]
    frames = sum(len(day) for day in days)
    console.print(
        f"{frames} frames of test days {numbers} of the SIMULATED subject, "
        f"{sum(len(np.unique(d.trial)) for d in days)} takes. "
        "Percent of frames with all fingers named right."
    )
    table = Table("", *(f"{k}" for k in COUNTS), "2-5 (95 % over takes)")
    for name, labeller in labellers().items():
        for how, ask in (("alone", alone), ("in play", in_play)):
            tally = ask(labeller, days)
            low, high = tally.interval(COUNTS[1:])
            table.add_row(
                f"{name}, {how}",
                *(f"{tally.percent((k,)):.1f}" for k in COUNTS),
                f"{tally.percent(COUNTS[1:]):.1f} ({low:.1f} to {high:.1f})",
            )
    console.print(table)
    console.print("The paper's Table 2, of one real person's touches: other data, other test.")
    paper = Table("", *(f"{k}" for k in COUNTS[1:]))
    for name, row in PAPER.items():
        paper.add_row(name, *(f"{value:.2f}" for value in row))
    console.print(paper)


if __name__ == "__main__":
    main()
