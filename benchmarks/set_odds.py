"""What the odds of a set of fingers do to names, before one of them is chosen.

    python -m benchmarks.set_odds --odds 2.5 5 10
    python -m benchmarks.set_odds --set 1 2 3 --odds 2.5 3.5 5
    python -m benchmarks.set_odds --people 3 --recordings ../shared/data/leap/*.json.lz

Four numbers decide a prior: names of simulated people to choose on, with history; single looks at
the sets that these people put down alone, and at pinches as people make them; single looks at the
simulated user's layouts of thumb, index and middle finger on boxes, by the direction of the hand;
and single looks at real hands in the air, where every set counts the same, so that any prior costs
something. Nobody who is judged takes part.
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
from benchmarks.pinches import SETS, layouts_of, pinches
from benchmarks.pinches import right as right_looks
from benchmarks.real_hands import layout, right
from benchmarks.strangers import answers, of
from encoders.captures.population import simulate_population
from encoders.labels.network_evidence import USUAL_SETS, NetworkEvidence
from encoders.labels.population_belief import PopulationBelief, builtin_population_model
from models.arithmetic.arrays import Array
from sandbox.devices.leap.leap_file import read_leap
from tasks.simulated_user.grasp import grasp_across
from tasks.simulated_user.hand import Hand
from tasks.user import UserConfiguration

THREE = (0, 1, 2)
"""Thumb, index and middle finger."""
DIRECTIONS = (45.0, 60.0, 75.0, 90.0)
"""Degrees from the right, counterclockwise: from the thumb across the box."""
WIDTHS = (0.040, 0.050, 0.060)
"""m, edges of the boxes that are looked at."""
HANDS = 40
"""Hands of simulated users, one a seed."""
LOOKS = 1500
"""Layouts of every set that is looked at."""


def with_odds(fingers: tuple[int, ...], odds: float) -> PopulationBelief:
    """The belief that ships, with other odds of a set of fingers."""
    model = builtin_population_model()
    evidence = model.evidence
    usual = {**USUAL_SETS, fingers: odds}
    other = NetworkEvidence(evidence.network, evidence.sharpness, usual)
    return replace(model, evidence=other)


def of_the_user(direction: float) -> list[Array]:
    """Layouts (3, 2) m of a simulated user's first touch on boxes, y towards the person."""
    configuration = UserConfiguration(fingers=3, natural_axis_of_row=float(np.deg2rad(direction)))
    layouts = []
    for seed in range(HANDS):
        hand = Hand.draw(configuration, seed)
        for width in WIDTHS:
            grasp = grasp_across(float(np.deg2rad(direction)), width, width, hand)
            places = grasp.places(np.zeros(2), grasp.opening(hand), hand)
            layouts.append(places * [1.0, -1.0])
    return [places for places in layouts if len(places) == len(THREE)]


def looks(belief: PopulationBelief, layouts: Sequence[Array]) -> float:
    """Share of single looks at thumb, index and middle finger that are right."""
    make = of(belief)
    truth = {f: f for f in THREE}
    return float(
        np.mean(
            [
                make(None).assign({f: tuple(xy[f].tolist()) for f in THREE}, {}).labels == truth
                for xy in layouts
            ]
        )
    )


def main() -> None:
    """Prints two rows for every odds."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--odds", type=float, nargs="+", default=[2.5, 5.0, 10.0])
    parser.add_argument(
        "--set", type=int, nargs="+", default=list(THREE), help="whose odds: thumb 0 to little 4"
    )
    parser.add_argument("--people", type=int, default=12, help="to choose on, of each generator")
    parser.add_argument("--recordings", type=Path, nargs="*", default=[], help="of a Leap")
    options = parser.parse_args()
    groups = {"first": options.people, "second": options.people}
    people = simulate_population("", {"choose": groups}).people
    hands = [
        places
        for path in options.recordings
        for frame in read_leap(path).frames[::6]
        for hand in frame.hands
        if (places := layout(hand)) is not None
    ]
    user = {direction: of_the_user(direction) for direction in DIRECTIONS}
    rng = np.random.default_rng(1)
    cases: dict[str, tuple[Array, tuple[int, ...]]] = {"pinch": (pinches(rng, LOOKS), (0, 1))}
    for name, fingers in SETS.items():
        cases[name] = layouts_of(rng, people, fingers, LOOKS), fingers
    names = Table(title=f"names, % right; {len(people)} simulated people to choose on")
    columns = ["odds", "2", "3", "4", "5", "all", *(f"user, {d:.0f} deg" for d in DIRECTIONS)]
    for column in [*columns, *(["real hands, 3", "4"] if hands else [])]:
        names.add_column(column, justify="right")
    singles = Table("odds", *cases, title="single looks, % right; the same people")
    for odds in options.odds:
        belief = with_odds(tuple(options.set), odds)
        named = [answers(p, of(belief)) for p in track(people, f"odds {odds:g}", transient=True)]
        touching = np.concatenate([n.fingers for n in named])
        correct = np.concatenate([n.right for n in named])
        cells = [correct[touching == count].mean() for count in range(2, 6)]
        cells += [correct.mean(), *(looks(belief, user[d]) for d in DIRECTIONS)]
        if hands:
            shares = right(hands, of(belief), None)
            cells += [shares[3], shares[4]]
        names.add_row(f"{odds:g}", *(f"{100 * cell:.1f}" for cell in cells))
        look = belief.evidence.log_posterior
        seen = (right_looks(look, xy, fingers) for xy, fingers in cases.values())
        singles.add_row(f"{odds:g}", *(f"{share:.1f}" for share in seen))
    console = Console(width=130)
    console.print(names)
    console.print(singles)


if __name__ == "__main__":
    run(main)
