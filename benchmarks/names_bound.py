"""What bounds the names of strangers: the number of people, the very person, and their habits.

    sandbox subject population --group train --out people.npz
    python -m benchmarks.names_bound --population people.npz
    python -m benchmarks.names_bound --population people.npz --times 10    # with more people

People to judge on are drawn with the digest of the names that ship, and named with history, as in
`benchmarks.strangers`. The same method is trained

- on an eighth, a quarter, a half and all of the people, and on more people of other seeds;
- on the very person's script of another day, alone;

and an oracle of habits replaces the odds of finger sets by those of the judged person's own frames.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.one_line import run
from benchmarks.strangers import Frames, answers, of, row, tracked
from encoders.capture import Capture
from encoders.captures.population import load_population, simulate_population
from encoders.captures.population.names import train_names
from encoders.captures.population.population import PEOPLE, script_of
from encoders.labels.layout_density import finger_sets
from encoders.labels.network_evidence import NetworkEvidence
from encoders.labels.network_training import DEFAULT, LayoutPool, train_network
from encoders.labels.population_belief import (
    PopulationBelief,
    builtin_population_model,
    from_weights,
)

PARTS = (8, 4, 2, 1)
"""Divisors of the number of people to train on."""

ALONE = replace(DEFAULT, steps=2000)
"""Training on one person: more steps learn the person's few frames by heart."""

_BARS = Console(stderr=True)


def with_habits(belief: PopulationBelief, person: Capture) -> PopulationBelief:
    """Names that know how often a person uses each set of fingers; one frame is added to each."""
    usual = {}
    counts = person.down.sum(axis=1)
    for count in range(2, 5):
        sets = finger_sets(count)
        for fingers in sets:
            whole = person.down[:, fingers].all(axis=1) & (counts == count)
            usual[tuple(fingers)] = (1.0 + whole.sum()) / (
                1.0 + (counts == count).sum() / len(sets)
            )
    known = NetworkEvidence(belief.evidence.network, belief.evidence.sharpness, usual)
    return replace(belief, evidence=known)


def trained_on(person: Capture) -> PopulationBelief:
    """Names trained on a person's script alone."""
    return from_weights(train_network(LayoutPool([script_of(person)]), ALONE), "")


def named(
    people: Sequence[Capture], beliefs: Sequence[PopulationBelief], what: str
) -> list[Frames]:
    """Answers for people, each by their own names."""
    pairs = zip(people, beliefs, strict=True)
    return [answers(p, of(b)) for p, b in track(pairs, what, len(people), console=_BARS)]


def more_people(times: int) -> list[Capture]:
    """People to train on of other seeds, some times as many as those that ship."""
    people: list[Capture] = []
    for part in track(range(1, times), "drawing more people", console=_BARS):
        people += simulate_population(f"bound {part}", {"train": PEOPLE["train"]}).people
    return people


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--population", type=Path, required=True, help="people to train on")
    parser.add_argument("--people", type=int, default=None, help="people of each generator")
    parser.add_argument("--times", type=int, default=1, help="also so many times the people")
    options = parser.parse_args()
    train = load_population(options.population).of(group="train")
    groups = {g: options.people or n for g, n in PEOPLE["judge"].items() if n}
    ships = builtin_population_model()
    with _BARS.status("drawing people to judge on"):
        drawn = simulate_population(ships.digest, {"judge": groups}).people
    judged = [person for person in drawn if person.down.all(axis=1).any()]
    head = ("2", "3", "4", "5", "all [95 %]", "sure: right", "sure, 3+", "error of p")
    table = Table("names, % of frames right", *head, title=f"{len(judged)} simulated people")
    alike = [ships] * len(judged)
    row(table, "names that ship", named(judged, alike, "names that ship"))
    habits = [with_habits(ships, person) for person in judged]
    row(table, "... with an oracle of habits", named(judged, habits, "oracle of habits"))
    rng = np.random.default_rng(0)
    order = rng.permutation(len(train.people))
    for part in PARTS:
        some = [train.people[i] for i in order[: len(order) // part]]
        with _BARS.status(f"training on {len(some)} people"):
            belief = train_names(some, train.digest)
        judgements = [answers(p, of(belief)) for p in tracked(judged, "judging", len(judged))]
        row(table, f"{len(some)} people", judgements)
    if options.times > 1:
        many = [*train.people, *more_people(options.times)]
        with _BARS.status(f"training on {len(many)} people"):
            belief = train_names(many, train.digest)
        row(table, f"{len(many)} people", [answers(p, of(belief)) for p in judged])
    own = [trained_on(p) for p in track(judged, "training on each", console=_BARS)]
    row(table, "the very person's script alone", named(judged, own, "own names"))
    both = [with_habits(b, p) for b, p in zip(own, judged, strict=True)]
    row(table, "... with an oracle of habits", named(judged, both, "own names and habits"))
    Console(width=130).print(table)


if __name__ == "__main__":
    run(main)
