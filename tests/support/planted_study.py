"""Studies whose truth is known: tables of trials from a model, to check what the report says.

A trial's time is lognormal with effects of the level, the task, the person, the person with this
level, and practice. Meanwhile things get lost at a rate that the level and the person change; then
the trial has failed. At the limit it ends, too. Times that are longer than that are never seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.study.design.balance import order_of
from sandbox.study.tables.column import csv_bytes, names_of
from sandbox.study.tables.trial_table import RESULT

COLUMNS = (
    *("experiment", "ppid", "session_num", "trial_num", "block_num", "trial_num_in_block"),
    *("start_time", "end_time", "mode", "number", "hand", "hand_size", "attempt", "counted"),
    *("practice", "repetition", "excluded", "exclusion_reason", "factor_encoder", "factor_task"),
    *names_of(RESULT),
)
"""Columns of the tables of trials, named as in UXF, which a report reads as well."""


@dataclass(frozen=True)
class Truth:
    """A study to be made.

    Attributes:
        people: Participants.
        times: s, geometric mean of each level of `encoder`, amid the session, before failures.
        tasks: Factor of each level of `task` on times.
        repetitions: Of every combination.
        person, person_level, residual: Standard deviations of log time.
        practice: Change of log time with every doubling of trials done.
        losses: Rate 1/s at which a thing is lost, by level of `encoder`.
        careless: Standard deviation over people of the log of that rate.
        limit: s.
    """

    people: int = 24
    times: tuple[float, ...] = (10.0, 8.5, 7.0)
    tasks: tuple[float, ...] = (0.8, 1.25)
    repetitions: int = 4
    person: float = 0.25
    person_level: float = 0.18
    residual: float = 0.35
    practice: float = -0.06
    losses: tuple[float, ...] = (0.020, 0.012, 0.006)
    careless: float = 0.5
    limit: float = 20.0

    @property
    def levels(self) -> tuple[str, ...]:
        """Of `encoder`."""
        return tuple("abcdefgh"[: len(self.times)])


@dataclass(frozen=True)
class Trials:
    """Trials of many people: arrays of (people, trials)."""

    level: np.ndarray
    task: np.ndarray
    repetition: np.ndarray
    time: np.ndarray
    status: np.ndarray


def draw(truth: Truth, seed: int) -> Trials:
    """Draws a study's trials; `seed` decides all chance."""
    rng = np.random.default_rng([seed, 9_114])
    count = truth.people
    levels, tasks = len(truth.times), len(truth.tasks)
    order = np.array([order_of("latin", levels, p, (0,)) for p in range(count)])
    level = np.repeat(order, tasks * truth.repetitions, axis=1)
    inner = np.stack(
        [
            np.concatenate(
                [
                    np.repeat(order_of("latin", tasks, p + place, (0,)), truth.repetitions)
                    for place in range(levels)
                ]
            )
            for p in range(min(count, 2 * tasks))
        ]
    )
    task = inner[np.arange(count) % len(inner)]
    shape = level.shape
    repetition = np.broadcast_to(np.tile(np.arange(truth.repetitions), levels * tasks), shape)
    practice = np.log2(np.arange(1, shape[1] + 1))
    own = rng.normal(0.0, truth.person_level, (count, levels))
    log_time = (
        np.log(truth.times)[level]
        + np.log(truth.tasks)[task]
        + rng.normal(0.0, truth.person, (count, 1))
        + np.take_along_axis(own, level, axis=1)
        + truth.practice * (practice - practice.mean())
        + rng.normal(0.0, truth.residual, shape)
    )
    rate = np.array(truth.losses)[level] * np.exp(rng.normal(0.0, truth.careless, (count, 1)))
    lost = rng.exponential(1.0, shape) / np.maximum(rate, 1e-12)
    time = np.minimum(np.exp(log_time), np.minimum(lost, truth.limit))
    status = np.where(time == lost, "failed", np.where(time == truth.limit, "timeout", "held"))
    return Trials(level, task, repetition + 1, time, status)


def write_study(folder: Path, truth: Truth, seed: int) -> None:
    """Writes a study's `trials.csv`, with everything that the report needs.

    Args:
        folder: Of the study; made where there is none.
        truth: What it follows.
        seed: Of all chance.
    """
    drawn = draw(truth, seed)
    rows = []
    for p in range(truth.people):
        clock = 0.0
        for k in range(drawn.level.shape[1]):
            held, time = drawn.status[p, k] == "held", float(drawn.time[p, k])
            rows.append(
                {
                    "experiment": f"planted-{seed}",
                    "ppid": f"P{p + 1:03d}",
                    "session_num": 1,
                    "trial_num": k + 1,
                    "block_num": 1 + k // truth.repetitions,
                    "trial_num_in_block": 1 + k % truth.repetitions,
                    "start_time": clock,
                    "end_time": clock + time,
                    "mode": "simulated",
                    "number": p + 1,
                    "hand": "right",
                    "hand_size": 1.0,
                    "attempt": 1,
                    "counted": True,
                    "practice": False,
                    "repetition": int(drawn.repetition[p, k]),
                    "excluded": False,
                    "exclusion_reason": "",
                    "factor_encoder": truth.levels[drawn.level[p, k]],
                    "factor_task": f"task{drawn.task[p, k] + 1}",
                    "task": f"task{drawn.task[p, k] + 1}",
                    "encoder": truth.levels[drawn.level[p, k]],
                    "seed": 100 * p + k,
                    "success": bool(held),
                    "status": str(drawn.status[p, k]),
                    "progress": 1.0 if held else 0.5,
                    "time_s": time,
                    "reason": "",
                    "respawned": 0,
                    "state_hash": "",
                }
            )
            clock += time + 4.0
    (folder / "tables").mkdir(parents=True, exist_ok=True)
    (folder / "tables/trials.csv").write_bytes(csv_bytes(rows, COLUMNS))
