"""Measures the time of a whole regression trial, and of its parts.

    python -m benchmarks.whole_run [--solid hand]

A trial is the work of `sandbox regress` for one seed, from its settings to its result: making the
scene, simulated user, default encoder, reconstruction, physics, score and hash. Each number is a
median over trials. Processor time is the time of the trial itself. Wall time also includes waiting
for other programs on the same cores. In the table of parts, the time of a part does not include the
parts that it calls. Physics is the reference: the rest of the program should take less than a few
times as long.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import gettempdir
from typing import Any, Literal, get_args

import mujoco
from threadpoolctl import threadpool_limits

from sandbox.trial.assembly import device_makers

Solid = Literal["fingertips", "hand"]

GOAL = 20.0
"""Goal: how many times faster than real time a whole trial should be on one core."""

PARTS = (
    "physics",
    "simulated user",
    "contacts and labels",
    "encoder",
    "fingertip correction",
    "rest of the reconstruction",
    "watching for turned hands",
    "solid fingers",
    "free fingers led clear",
    "score",
    "state hash",
    "what views get",
    "what a diverged trial keeps",
    "rest",
)


_LOOKS = 2000


class Clock:
    """Measures the processor time of nested parts, each without the parts inside it.

    Attributes:
        spent: Part -> time (s).
    """

    def __init__(self) -> None:
        self.spent = dict.fromkeys(PARTS, 0.0)
        self._stack = ["rest"]
        # Reading the clock takes time itself, which is subtracted from all parts.
        begin = time.process_time()
        for _ in range(_LOOKS):
            time.process_time()
        self._look = (time.process_time() - begin) / _LOOKS
        self._since = time.process_time()

    def enter(self, part: str) -> None:
        """Begins a part."""
        self._stop()
        self._stack.append(part)

    def leave(self) -> None:
        """Ends the part that began last."""
        self._stop()
        self._stack.pop()

    def _stop(self) -> None:
        now = time.process_time()
        self.spent[self._stack[-1]] += now - self._since - self._look
        self._since = now


@contextmanager
def timed(clock: Clock, places: Sequence[tuple[Any, str, str]]) -> Iterator[None]:
    """Measures the time of methods in the context.

    Args:
        clock: The clock.
        places: Owner of a method, its name, and the part to which its time counts.
    """
    methods = [getattr(owner, name) for owner, name, _ in places]

    def measured(method: Callable[..., Any], part: str) -> Callable[..., Any]:
        def call(*args: Any, **kwargs: Any) -> Any:
            clock.enter(part)
            try:
                return method(*args, **kwargs)
            finally:
                clock.leave()

        return call

    for (owner, name, part), method in zip(places, methods, strict=True):
        setattr(owner, name, measured(method, part))
    try:
        yield
    finally:
        for (owner, name, _), method in zip(places, methods, strict=True):
            setattr(owner, name, method)


def whole_trial(seed: int, fingers: int, solid: Solid) -> tuple[float, float, float]:
    """Returns simulated time, processor time and wall time (s) of a trial, from settings to
    result."""
    from sandbox.session.session import Session
    from sandbox.trial.driver import play_trial
    from sandbox.trial.trial_options import TrialOptions, trial_settings

    sessions: list[Session] = []

    def remember(session: Session) -> list[Any]:
        sessions.append(session)
        return []

    wall, own = time.perf_counter(), time.process_time()
    chosen = trial_settings(TrialOptions(seed=seed, fingers=fingers, solid=solid))
    play_trial(
        chosen,
        device_makers(chosen),
        remember,
        dump=Path(gettempdir()),
    )
    return sessions[0].time, time.process_time() - own, time.perf_counter() - wall


def parts_of_trial(seed: int, fingers: int, solid: Solid) -> dict[str, float]:
    """Returns the mean processor time (s) of every part in one control step of a trial."""
    from sandbox.trial.assembly import build
    from sandbox.trial.driver import DivergenceRecorder, Trial
    from sandbox.trial.trial_options import TrialOptions, trial_settings

    chosen = trial_settings(TrialOptions(seed=seed, fingers=fingers, solid=solid))
    box = DivergenceRecorder({})
    session: Any = build(chosen, device_makers(chosen), box)
    rig: Any = session.rigs[0]
    hand = getattr(rig.reconstructor, "trained", rig.reconstructor)
    clock = Clock()
    places = [
        (mujoco, "mj_step", "physics"),
        (rig.device, "poll", "simulated user"),
        (rig.device, "show", "simulated user"),
        (rig.reconstructor, "step", "rest of the reconstruction"),
        (hand._tracker, "step", "contacts and labels"),
        (hand, "_name", "contacts and labels"),
        (hand.model.encoder, "predict", "encoder"),
        (hand._correction, "correct", "fingertip correction"),
        (rig.yaw, "step", "watching for turned hands"),
        (session._gates[0], "update", "solid fingers"),
        (type(session.task), "measure", "score"),
        (session.scorer, "update", "score"),
        (session, "_chain", "state hash"),
        (session, "snapshot", "what views get"),
        (box, "state", "what a diverged trial keeps"),
        (box, "input", "what a diverged trial keeps"),
    ]
    avoidance = session._avoidance[0]
    if avoidance is not None:
        places.append((avoidance, "step", "free fingers led clear"))
    with timed(clock, places):
        Trial(session, []).run()
    steps = session.step / session.scene.substeps
    return {part: spent / steps for part, spent in clock.spent.items()}


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fingers", type=int, nargs="+", default=[2, 3, 5])
    parser.add_argument("--seeds", type=int, default=8, help="trials of each")
    parser.add_argument("--solid", choices=get_args(Solid), default="fingertips")
    args = parser.parse_args()
    # One thread, as in every executor of regression runs.
    with threadpool_limits(1):
        tables(args.fingers, range(args.seeds), args.solid)


def tables(fingers: Sequence[int], seeds: Sequence[int], solid: Solid) -> None:
    """Measures the trials and prints the tables."""
    from benchmarks.machine import describe_machine

    print(describe_machine())
    print(f"box-to-goal, solid {solid}, medians of {len(seeds)} trials, one core\n")
    print(
        "| fingers | simulated | processor time | wall time | times real time (processor) | "
        "times real time (wall) |"
    )
    print("|" + " --- |" * 6)
    for count in fingers:
        whole_trial(0, count, solid)
        trials = [whole_trial(seed, count, solid) for seed in seeds]
        simulated, own, wall = (median(t[i] for t in trials) for i in range(3))
        real = [median(t[0] / t[i] for t in trials) for i in (1, 2)]
        print(
            f"| {count} | {simulated:.2f} s | {own:.3f} s | {wall:.3f} s "
            f"| {real[0]:.1f} (goal {GOAL:.0f}) | {real[1]:.1f} |"
        )
    columns = []
    for count in fingers:
        found = [parts_of_trial(seed, count, solid) for seed in seeds]
        columns.append({part: median(f[part] for f in found) for part in PARTS})
    print("\nProcessor time in one control step of 16 ms, us (and against physics):\n")
    print("| part | " + " | ".join(f"{n} fingers" for n in fingers) + " |")
    print("|" + " --- |" * (1 + len(columns)))
    for part in (*PARTS, "all"):
        cells = []
        for column in columns:
            spent = sum(column.values()) if part == "all" else column[part]
            cells.append(f"{1e6 * spent:.0f} ({spent / column['physics']:.2f})")
        print(f"| {part} | " + " | ".join(cells) + " |")
    print(f"\n{describe_machine()}, at the end")


if __name__ == "__main__":
    main()
