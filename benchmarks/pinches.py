"""Measures the labels of single layouts for the sets of fingers that people use most.

    python -m benchmarks.pinches
    python -m benchmarks.pinches --layouts 1000 --people 6      # a quick run

These are pinches and neighbouring fingers. Layouts of thumb and index finger are drawn from the
range of real pinches (326 pinches of 19 people on an iPad): distances of 45 to 85 mm, and
directions of 16 to 72 degrees from thumb to index finger. Layouts of the other sets are those of
pinned simulated people. Labels are inferred from one layout alone, without its history. For the
second column the touching set is declared.
"""

from __future__ import annotations

import argparse

import numpy as np
from rich.console import Console
from rich.table import Table

from encoders.capture import Capture
from encoders.labels.belief import builtin_population_model
from encoders.labels.labelling import odds_of_sets, true_row
from encoders.labels.pair_network import USUAL_SETS, NetworkEvidence
from models.arithmetic import Array
from training.judged import JUDGED, NEXT, pinned_people

OPENING = (0.045, 0.085)
"""Range of the distance (m) between thumb and index finger."""

DIRECTION = (16.0, 72.0)
"""Range of the direction (degrees) from thumb to index finger, counterclockwise from the right."""

SETS = {
    "thumb + middle": (0, 2),
    "index + middle": (1, 2),
    "middle + ring": (2, 3),
    "thumb + index + middle": (0, 1, 2),
    "index + middle + ring": (1, 2, 3),
}
"""Name of a set -> its fingers."""


def pinches(rng: np.random.Generator, count: int) -> Array:
    """Draws layouts (count, 2, 2) m of thumb and index finger, with y towards the person."""
    opening = rng.uniform(*OPENING, count)
    direction = np.deg2rad(rng.uniform(*DIRECTION, count))
    layouts = np.zeros((count, 2, 2))
    layouts[:, 1, 0] = opening * np.cos(direction)
    layouts[:, 1, 1] = -opening * np.sin(direction)
    return layouts


def layouts_of(
    rng: np.random.Generator, people: tuple[Capture, ...], fingers: tuple[int, ...], count: int
) -> Array:
    """Draws layouts (count, k, 2) m of people in which exactly these k fingers touch. All people
    are equally likely."""
    own = []
    for person in people:
        alone = person.down[:, fingers].all(axis=1) & (person.down.sum(axis=1) == len(fingers))
        if alone.any():
            own.append(person.xy[alone][:, fingers])
    drawn = [own[i] for i in rng.integers(len(own), size=count)]
    return np.stack([xy[rng.integers(len(xy))] for xy in drawn])


def right(
    evidence: NetworkEvidence, layouts: Array, fingers: tuple[int, ...]
) -> tuple[float, float]:
    """Returns the percentage of layouts with correct labels, without and with the set declared."""
    truth = true_row(np.array(fingers))
    odds = odds_of_sets({fingers: 1.0}, USUAL_SETS)[len(fingers)]
    assert odds is not None
    posteriors = np.array([evidence.log_posterior(xy) for xy in layouts])
    free, declared = posteriors.argmax(axis=1), (posteriors + odds).argmax(axis=1)
    return 100 * float(np.mean(free == truth)), 100 * float(np.mean(declared == truth))


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--layouts", type=int, default=10000, help="number of layouts of every set")
    parser.add_argument("--people", type=int, default=36, help="number of people of each generator")
    parser.add_argument(
        "--group", choices=(JUDGED, NEXT), default=JUDGED, help="pinned people of the test"
    )
    options = parser.parse_args()
    population = builtin_population_model()
    counts = {"first": options.people, "second": options.people}
    with Console(stderr=True).status("drawing people of the test"):
        people = pinned_people(options.group, counts)
    rng = np.random.default_rng(0)
    cases: dict[str, tuple[Array, tuple[int, ...]]] = {
        "thumb + index, as people pinch": (pinches(rng, options.layouts), (0, 1))
    }
    for name, fingers in SETS.items():
        cases[name] = layouts_of(rng, people, fingers, options.layouts), fingers
    table = Table("single looks, % right", "`population`", "set declared")
    for name, (layouts, fingers) in cases.items():
        shares = right(population.evidence, layouts, fingers)
        table.add_row(name, *(f"{share:.1f}" for share in shares))
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
