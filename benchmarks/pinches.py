"""Single looks at the finger sets that people use most: pinches and neighbouring fingers.

    python -m benchmarks.pinches
    python -m benchmarks.pinches --layouts 1000 --people 6      # a quick look

Thumb and index finger are drawn by what real pinches are like (326 of 19 people on an iPad):
openings of 45 to 85 mm, directions of the index finger as seen from the thumb of 16 to 72 degrees.
Layouts of the other sets are those of simulated people to judge on, drawn with the digest of the
names that ship. A look is the answer to the contacts alone, without any history.
"""

from __future__ import annotations

import argparse

import numpy as np
from rich.console import Console
from rich.table import Table

from encoders.capture import Capture
from encoders.labels.belief import builtin_population_model
from encoders.labels.labelling import true_row
from encoders.labels.pair_network import NetworkEvidence
from models.arithmetic.arrays import Array
from training.population import simulate_population

OPENING = (0.045, 0.085)
"""m between thumb and index finger."""

DIRECTION = (16.0, 72.0)
"""Degrees, of the index finger as seen from the thumb, counterclockwise from the right."""

SETS = {
    "thumb + middle": (0, 2),
    "index + middle": (1, 2),
    "middle + ring": (2, 3),
    "thumb + index + middle": (0, 1, 2),
    "index + middle + ring": (1, 2, 3),
}
"""Fingers by the name of their set."""


def pinches(rng: np.random.Generator, count: int) -> Array:
    """Layouts (count, 2, 2) m of thumb and index finger, y down."""
    opening = rng.uniform(*OPENING, count)
    direction = np.deg2rad(rng.uniform(*DIRECTION, count))
    layouts = np.zeros((count, 2, 2))
    layouts[:, 1, 0] = opening * np.cos(direction)
    layouts[:, 1, 1] = -opening * np.sin(direction)
    return layouts


def layouts_of(
    rng: np.random.Generator, people: tuple[Capture, ...], fingers: tuple[int, ...], count: int
) -> Array:
    """Layouts (count, k, 2) m of people, in which these fingers alone touch; people are drawn
    evenly."""
    own = []
    for person in people:
        alone = person.down[:, fingers].all(axis=1) & (person.down.sum(axis=1) == len(fingers))
        if alone.any():
            own.append(person.xy[alone][:, fingers])
    drawn = [own[i] for i in rng.integers(len(own), size=count)]
    return np.stack([xy[rng.integers(len(xy))] for xy in drawn])


def right(evidence: NetworkEvidence, layouts: Array, fingers: tuple[int, ...]) -> float:
    """Percent of layouts that are named right."""
    truth = true_row(np.array(fingers))
    labels = [int(np.argmax(evidence.log_posterior(xy))) for xy in layouts]
    return 100 * float(np.mean(np.array(labels) == truth))


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--layouts", type=int, default=10000, help="layouts of every set")
    parser.add_argument("--people", type=int, default=36, help="people of each generator")
    options = parser.parse_args()
    population = builtin_population_model()
    groups = {"judge": {"first": options.people, "second": options.people}}
    with Console(stderr=True).status("drawing people to judge on"):
        people = simulate_population(population.digest, groups).people
    rng = np.random.default_rng(0)
    cases: dict[str, tuple[Array, tuple[int, ...]]] = {
        "thumb + index, as people pinch": (pinches(rng, options.layouts), (0, 1))
    }
    for name, fingers in SETS.items():
        cases[name] = layouts_of(rng, people, fingers, options.layouts), fingers
    table = Table("single looks, % right", "`population`")
    for name, (layouts, fingers) in cases.items():
        table.add_row(name, f"{right(population.evidence, layouts, fingers):.1f}")
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
