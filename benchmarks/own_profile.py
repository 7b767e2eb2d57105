"""What a profile is worth to names of fingers: the hand's size, and layouts of five fingers.

    python -m benchmarks.own_profile
    python -m benchmarks.own_profile --people 12      # of each generator, a quick look

People to judge on are drawn with the digest of the names that ship. The first third of a person's
takes fills a profile, as `sandbox play --learn` does; the others are named with it, each from the
beginning. Nothing is learned during these takes, except in the row that says so. Left out is who
has fewer than three takes, or never has five fingers down in the first third.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from benchmarks.strangers import Frames, answers, row
from encoders.capture import Capture
from encoders.captures.population import simulate_population
from encoders.captures.population.population import PEOPLE
from encoders.labels.belief import BeliefLabels
from encoders.labels.own_layouts import MOST, OwnLayouts
from encoders.labels.population_belief import builtin_population_belief, builtin_population_model

KEPT = (1, 3, MOST)
"""Numbers of layouts in the profile."""


def of_takes(capture: Capture, wanted: NDArray[np.bool_]) -> Capture:
    """Some frames of a capture."""
    parts = {name: getattr(capture, name)[wanted] for name in ("time", "trial", "ids", "xy", "q")}
    return replace(capture, **parts)


def in_two(person: Capture) -> tuple[Capture, Capture]:
    """The first third of a person's takes, and the others."""
    takes = np.unique(person.trial)
    early = person.trial < takes[len(takes) // 3]
    return of_takes(person, early), of_takes(person, ~early)


def of_size_one(person: Capture) -> Capture:
    """A person's takes, with touches divided by the hand's size as a session divides them."""
    return replace(person, xy=person.xy / person.meta["size"])


def profile(early: Capture, most: int) -> OwnLayouts:
    """The newest layouts of five fingers in some takes."""
    own = OwnLayouts()
    for t in np.flatnonzero(early.down.all(axis=1)):
        own = own.with_new(early.xy[t])
    return OwnLayouts(own.metres[-most:])


def still(known: OwnLayouts | None) -> BeliefLabels:
    """Names that learn nothing more."""
    return BeliefLabels(builtin_population_model(), known)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--people", type=int, default=None, help="people of each generator")
    count = parser.parse_args().people
    groups = {g: count if count is not None else n for g, n in PEOPLE["judge"].items() if n}
    drawn = simulate_population(builtin_population_model().digest, {"judge": groups}).people
    several = [person for person in drawn if len(np.unique(person.trial)) >= 3]
    people = [(a, b) for a, b in map(in_two, several) if a.down.all(axis=1).any()]
    title = f"later takes of {len(people)} simulated people; sure: claims 0.99 or more"
    head = ("2", "3", "4", "5", "all [95 %]", "sure: right", "sure, 3+", "error of p")
    table = Table("names, % of frames right", *head, title=title)
    without = [answers(later, still) for _, later in people]
    row(table, "without layouts", without)
    sized = [answers(of_size_one(later), still) for _, later in people]
    row(table, "with the hand's size", sized)
    learning = [answers(later, builtin_population_belief) for _, later in people]
    row(table, "learning within a take", learning)
    gains = [("with the hand's size", sized), ("learning within a take", learning)]
    for most in KEPT:
        name = f"{most} from earlier takes"
        kept = [answers(later, still, profile(early, most)) for early, later in people]
        row(table, name, kept)
        gains.append((name, kept))
    Console(width=130).print(table)
    for name, with_them in gains:
        print(f"{name}: {gained(without, with_them)} points for a person")


def gained(before: list[Frames], after: list[Frames]) -> str:
    """Mean gain over people in points, with its 95 % interval."""
    points = [
        100 * (np.mean(b.right) - np.mean(a.right)) for a, b in zip(before, after, strict=True)
    ]
    drawn = np.random.default_rng(0).choice(points, (2000, len(points))).mean(axis=1)
    low, high = np.percentile(drawn, [2.5, 97.5])
    return f"{np.mean(points):+.1f} [{low:+.1f}, {high:+.1f}]"


if __name__ == "__main__":
    main()
