"""What it would gain and cost to believe more firmly in the thumb with the fingers next to it.

    python -m benchmarks.habit

People grasp with the thumb and its neighbours, a capture by script gives every set of fingers
equal time, and the belief over labels leans only a little to the first. Here it leans more and
more. Judged is one look, without history, at touches of a simulated subject on a day that trained
nothing, and at the first touches of the simulated user's grasps, who opens the hand wider than the
subject ever does.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.labels import contacts_of
from encoders.evaluation.subjects import subject
from encoders.labels.belief import BeliefLabels, builtin_belief
from encoders.labels.label_evidence import THUMB_AND_NEXT, LabelEvidence, natural_prior
from models.errors import HandSandboxError
from models.frames import TouchFrame
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.session.session import Session

Touches = tuple[dict[int, tuple[float, float]], dict[int, int]]
"""Places in m on the surface and true fingers, by contact."""

HABITS = (THUMB_AND_NEXT, 10.0, 100.0, 1000.0)


def leaning(habit: float) -> BeliefLabels:
    """The built-in belief, with another weight of the natural sets in what was captured."""
    trained = builtin_belief().trained
    known = trained.evidence
    prior = natural_prior(habit)
    evidence = LabelEvidence(known.layouts, known.shapes, known.order, prior)
    return BeliefLabels(replace(trained, evidence=evidence))


def of_subject(day: int, looks: int, count: int) -> Iterator[Touches]:
    """Looks at so many fingers of a subject's day."""
    capture = subject("first").day(day, None)
    frames = np.random.default_rng(day).permutation(len(capture.down))
    found = [f for f in frames if capture.down[f].sum() == count]
    for frame in found[:looks]:
        yield contacts_of(capture, int(frame))


def of_user(tasks: Sequence[str], seeds: range, fingers: int) -> Iterator[Touches]:
    """The first moment at which all fingers of a simulated user are down, trial by trial."""
    for task in tasks:
        for seed in seeds:
            yield first_grasp(task, seed, fingers)


def first_grasp(task: str, seed: int, fingers: int) -> Touches:
    """The first moment of a trial at which so many fingers are down."""
    from sandbox.trial.assembly import build

    chosen = plan(SceneOptions(task=task, seed=seed, fingers=fingers))
    session: Session = build(chosen.settings, chosen.make_device)
    device = session.rigs[0].device
    assert isinstance(device, SimulatedDevice)
    try:
        while not session.over:
            device.show(session.advance())
            frame = session.heard(0)
            assert isinstance(frame, TouchFrame)
            touches = frame.contacts
            if len(touches) == fingers:
                ids = [c.id for c in touches]
                places = [(c.x, c.y) for c in touches]
                return dict(zip(ids, places, strict=True)), {i: device.truth[i] for i in ids}
    finally:
        session.close()
    raise HandSandboxError("no grasp came", where=f"{task}, seed {seed}")


def right(belief: BeliefLabels, touches: Sequence[Touches]) -> str:
    """Percent of looks with every finger's name right, and how many looks."""
    hits = 0
    for places, truth in touches:
        belief.reset()
        hits += dict(belief.assign(places, {}).labels) == truth
    return f"{100 * hits / len(touches):.0f} ({len(touches)})" if touches else "-"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--day", type=int, default=301, help="of the subject; none that is judged")
    parser.add_argument("--looks", type=int, default=400, help="at the subject, for each count")
    parser.add_argument("--seeds", type=int, default=10, help="trials of each task")
    parser.add_argument("--tasks", nargs="+", default=["box-to-goal", "stack", "wrench-turn"])
    args = parser.parse_args()
    print("percent of single looks named right (looks); SIMULATED subject and user")
    print("| fingers | weight | subject, thumb and next | subject, other sets | user's grasps |")
    print("| --- | --- | --- | --- | --- |")
    for count in (2, 3, 4):
        looks = list(of_subject(args.day, args.looks, count))
        natural = [t for t in looks if sorted(t[1].values()) == list(range(count))]
        others = [t for t in looks if sorted(t[1].values()) != list(range(count))]
        grasps = list(of_user(args.tasks, range(args.seeds), count))
        for habit in HABITS:
            belief = leaning(habit)
            cells = (right(belief, natural), right(belief, others), right(belief, grasps))
            print(f"| {count} | {habit:g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
