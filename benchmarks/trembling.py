"""Measures cost and gain of smoothing as a simulated Leap grows noisier: PAALM's, which follows the
device's trembling, against fixed constants.

    python -m benchmarks.trembling                                  # angles and jitter
    python -m benchmarks.trembling --noise 3 --trials 12 --first 8  # and boxes at their goals

Development persons and seeds; nobody is real.
"""

from __future__ import annotations

import argparse
from functools import partial

import numpy as np

import sandbox.trial.hand_input as hand_input
from benchmarks.in_air import Depth, play
from encoders.evaluation.paalm_judge import judge_recording
from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import leap_take
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP
from sandbox.cli.evaluate.paalm_readings import FIRST_PERSON
from sandbox.devices.simulated.leap_disturbance import LeapDisturbance

WAYS = {
    "as it trembles": PaalmOptions(),
    "0.03 s": PaalmOptions(longest=PaalmOptions().smoothing),
    "0.08 s": PaalmOptions(smoothing=0.08, longest=0.08),
}
FIGURES = ("mcp_deg", "pip_deg", "dip_deg", "seen_pip_deg", "jitter_deg")


def main() -> None:
    """Prints a line for every noise and way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--persons", type=int, default=3)
    parser.add_argument("--noise", type=float, nargs="+", default=(1.0, 2.0, 3.0))
    parser.add_argument("--trials", type=int, default=0, help="of box-to-goal, at every noise")
    parser.add_argument("--first", type=int, default=0, help="seed of the first trial")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.trials)
    people = range(FIRST_PERSON, FIRST_PERSON + options.persons)
    hands = {person: simulate_air(person) for person in people}
    print("SIMULATED persons and device; v1, mean over persons")
    for noise in options.noise:
        device = LeapDisturbance(noise).applied(FROZEN_LEAP)
        takes = [leap_take(hand, person, configuration=device) for person, hand in hands.items()]
        for name, way in WAYS.items():
            found = [judge_recording(name, take, way, names=False).figures for take in takes]
            means = [f"{k} {np.mean([f[k] for f in found]):.2f}" for k in FIGURES]
            print(
                f"noise x{noise:g}, {name:15}",
                *means,
                *_boxes(way, noise, seeds),
                sep="  ",
                flush=True,
            )


def _boxes(way: PaalmOptions, noise: float, seeds: range) -> list[str]:
    """Measures how often a box is brought to its goal over development seeds."""
    if not seeds:
        return []
    hand_input.Paalm = partial(Paalm, way)  # type: ignore[assignment, attr-defined]
    trouble = LeapDisturbance(noise)
    won = [
        play("box-to-goal", seed, "v1", "skilled", 1.0, Depth(), trouble)[0].success
        for seed in seeds
    ]
    return [f"boxes {sum(won)} of {len(seeds)}"]


if __name__ == "__main__":
    main()
