"""Measures labels of fingers for people and generators that are not in the training data.

    python -m benchmarks.strangers --people 6      # a quick run with the default labels
    python -m benchmarks.strangers                 # all people of the test
    python -m training people --group train --out people.npz
    python -m benchmarks.strangers --population people.npz      # and both generators held out

The rows of the table are:

- both frozen subjects, with labels that were trained on people of the other sources alone (held-out
  generator);
- pinned people, without further information, after one touch with five fingers, and with their sets
  of fingers declared: the list of sets that occur in more than 5 % of their takes, or the set that
  touches.

The last columns compare the claimed probabilities with the share of correct labels. The labeller
sees every frame and restarts with every take, so that no take depends on another.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import Progress, track
from rich.table import Table

from benchmarks.one_line import run
from encoders.capture import Capture
from encoders.labels.belief import (
    BeliefLabels,
    OwnLayouts,
    PopulationBelief,
    builtin_population_belief,
)
from encoders.labels.labelling import LogOdds, odds_of_sets
from encoders.labels.pair_network import USUAL_SETS
from training.judged import JUDGED, NEXT, pinned_people, subject
from training.names import train_names
from training.population import Population, load_population
from training.population.population import PEOPLE

DAY_SEED = 19
"""Seed of the test days."""

SURE = 0.99
"""Probability from which on labels count as sure."""

_BARS = Console(stderr=True)

Maker = Callable[[OwnLayouts | None], BeliefLabels]
Fingers = tuple[int, ...]

OFTEN = 0.05
"""Share of a person's takes above which a set of fingers is in the person's declared list."""


@dataclass
class Frames:
    """Labels of the frames of one person or day.

    Attributes:
        fingers: Number of contacts of each frame.
        right: True where all of its labels are correct.
        claimed: Probability of the labels that the labeller returned.
    """

    fingers: list[int] = field(default_factory=list)
    right: list[bool] = field(default_factory=list)
    claimed: list[float] = field(default_factory=list)


def answers(
    capture: Capture,
    make: Maker,
    known: OwnLayouts | None = None,
    declared: Callable[[Fingers], LogOdds] | None = None,
) -> Frames:
    """Labels all frames of a capture. The labeller restarts with every take.

    Args:
        capture: Takes of one person.
        make: Makes the labeller.
        known: Known layouts of the person.
        declared: Returns the log factors of the sets of fingers, from the fingers that touch.
    """
    frames, labeller, take = Frames(), make(known), None
    rng = np.random.default_rng(0)
    for t in range(len(capture)):
        if capture.trial[t] != take:
            labeller.restart()
            take = capture.trial[t]
        down = np.flatnonzero(capture.down[t])
        if declared is not None:
            labeller.odds = declared(tuple(down.tolist()))
        fingers = rng.permutation(down)
        places = {int(capture.ids[t, f]): tuple(capture.xy[t, f].tolist()) for f in fingers}
        labelling = labeller.assign(places, {})
        truth = {int(capture.ids[t, f]): int(f) for f in fingers}
        frames.fingers.append(len(fingers))
        frames.right.append(labelling.labels == truth)
        frames.claimed.append(labelling.probability)
    return frames


def row(table: Table, name: str, people: Sequence[Frames]) -> None:
    """Adds a row to the table: percentage of frames with correct labels, by number of fingers and
    in all, with a bootstrap interval over people, and the error of the probabilities."""
    fingers = np.concatenate([p.fingers for p in people])
    right = np.concatenate([p.right for p in people])
    claimed = np.concatenate([p.claimed for p in people])
    shares = [f"{100 * right[fingers == k].mean():.1f}" for k in range(2, 6)]
    rng = np.random.default_rng(0)
    sums = np.array([[np.sum(p.right), len(p.right)] for p in people], float)
    drawn = sums[rng.integers(len(sums), size=(2000, len(sums)))].sum(axis=1)
    low, high = 100 * np.percentile(drawn[:, 0] / drawn[:, 1], [2.5, 97.5])
    sure = claimed >= SURE
    several = fingers >= 3
    tenth = np.minimum((10 * claimed).astype(int), 9)
    gap = sum(
        abs(claimed[tenth == b].mean() - right[tenth == b].mean()) * (tenth == b).mean()
        for b in np.unique(tenth)
    )
    table.add_row(
        name,
        *shares,
        f"{100 * right.mean():.1f} [{low:.1f}, {high:.1f}]",
        f"{100 * right[sure].mean():.1f}" if sure.any() else "-",
        f"{100 * sure[several].mean():.0f}",
        f"{100 * gap:.1f}",
    )


def sets_in_use(person: Capture) -> list[Fingers]:
    """Returns the sets of fingers that occur in more than 5 % of a person's takes."""
    takes = np.unique(person.trial)
    in_takes: Counter[Fingers] = Counter()
    for take in takes:
        down = np.unique(person.down[person.trial == take], axis=0)
        in_takes.update(tuple(np.flatnonzero(row).tolist()) for row in down)
    return [fingers for fingers, n in in_takes.items() if n > OFTEN * len(takes)]


@cache
def odds_of_one(fingers: Fingers) -> LogOdds:
    """Returns the log factors if only one set of fingers is used."""
    return odds_of_sets({fingers: 1.0}, USUAL_SETS)


def with_list(person: Capture) -> Frames:
    """Labels the frames of a person who has declared a list of equally likely sets."""
    odds = odds_of_sets(dict.fromkeys(sets_in_use(person), 1.0), USUAL_SETS)
    return answers(person, builtin_population_belief, declared=lambda _: odds)


def with_very_set(person: Capture) -> Frames:
    """Labels the frames of a person whose touching set of fingers is declared at every frame."""
    return answers(person, builtin_population_belief, declared=odds_of_one)


def after_five(person: Capture) -> OwnLayouts:
    """Returns one layout of five fingers of a person, the first of the capture."""
    return OwnLayouts(person.xy[np.flatnonzero(person.down.all(axis=1))[:1]])


def of(belief: PopulationBelief) -> Maker:
    """Returns a function that makes labellers with a trained belief."""
    return lambda known: BeliefLabels(belief, known, learns=True)


def tracked(captures: Iterable[Capture], what: str, total: int) -> Iterable[Capture]:
    """Returns the captures, with a progress bar."""
    return track(captures, what, total, console=_BARS)


def trained_without(held: str, train: Population) -> PopulationBelief:
    """Trains a belief on people of all sources but one."""
    others = train.of(without=held)
    with Progress(console=_BARS, transient=True) as bars:
        bar = bars.add_task(f"training without the {held} generator", total=1.0)
        return train_names(
            others.people, others.digest, lambda share, _: bars.update(bar, completed=share)
        )


def held_out(table: Table, train: Population, count: int) -> None:
    """Adds the rows of both frozen subjects to the table.

    Args:
        table: The table.
        train: People of the training data, of all sources.
        count: Number of test days of each subject.
    """
    for held in ("first", "second"):
        belief, one = trained_without(held, train), subject(held)
        days = [one.day(day, None) for day in one.judged_days(count, DAY_SEED)]
        judged = list(tracked(days, f"{held} subject", len(days)))
        row(table, f"{held} subject, generator held out", [answers(c, of(belief)) for c in judged])


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--population", type=Path, help="training data for the rows with held-out generators"
    )
    parser.add_argument(
        "--days", type=int, default=12, help="number of test days of each frozen subject"
    )
    parser.add_argument(
        "--people", type=int, default=None, help="number of people of each generator"
    )
    parser.add_argument(
        "--group", choices=(JUDGED, NEXT), default=JUDGED, help="pinned people of the test"
    )
    options = parser.parse_args()
    table = Table(
        "names, % of frames right",
        "2",
        "3",
        "4",
        "5",
        "all [95 %]",
        "sure: right",
        "sure, 3+",
        "error of p",
        title="simulated people; sure: claims 0.99 or more",
    )
    if options.population is not None:
        held_out(table, load_population(options.population).of(group="train"), options.days)
    count = options.people
    groups = {g: count if count is not None else n for g, n in PEOPLE["judge"].items() if n}
    with _BARS.status("drawing people of the test"):
        judged = pinned_people(options.group, groups)
    seen = [p for p in judged if p.down.all(axis=1).any()]
    row(table, f"{len(seen)} pinned people", [answers(p, builtin_population_belief) for p in seen])
    primed = [answers(p, builtin_population_belief, after_five(p)) for p in seen]
    row(table, "the same after one touch with five", primed)
    row(table, "the same, the person's list declared", [with_list(p) for p in seen])
    row(table, "the same, the very set declared", [with_very_set(p) for p in seen])
    Console(width=130).print(table)


if __name__ == "__main__":
    run(main)
