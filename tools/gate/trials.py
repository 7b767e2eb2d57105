"""Trials of the simulated user: every task with solid fingertips and with solid hands, and other
settings."""

from __future__ import annotations

from typing import Any

from sandbox import run_trial
from tools.gate.rows import Observed, outcome

TASKS = (
    "box-to-goal",
    "wrench-turn",
    "wrench-slide",
    "stack",
    "stack-three",
    "stack-vertical",
    "carry-together",
    "slalom",
    "chords",
    "dial",
    "gather",
    "books",
    "insert",
    "close-case",
    "single-keys",
)

SEEDS = {"fingertips": range(20), "hand": range(4)}
"""Value of `--solid` -> seeds of every task."""

SETTINGS: dict[str, tuple[str, dict[str, Any]]] = {
    "encoder linear": ("box-to-goal", {"encoder": "linear"}),
    "encoder quadratic": ("box-to-goal", {"encoder": "quadratic"}),
    "encoder cubic": ("box-to-goal", {"encoder": "cubic"}),
    "encoder pca-ik": ("box-to-goal", {"encoder": "pca-ik"}),
    "encoder paper": ("box-to-goal", {"encoder": "paper"}),
    "bare": ("box-to-goal", {"bare": True}),
    "left hand, turned and small": (
        "wrench-turn",
        {"hand": "left", "turn": 180, "hand_size": 0.9},
    ),
    "position servos, safe impulse": ("stack", {"servo": "position", "impulse": "safe"}),
    "soft servos": ("stack", {"contact": "soft"}),
    "touches lost": ("box-to-goal", {"fingers": 2, "drop_outs": 0.3}),
    "five fingers, larger": ("wrench-slide", {"fingers": 5, "vary": "size=1.2"}),
    "leap-simulated": ("stack", {"device": "leap-simulated"}),
    "leap-simulated v1": ("box-to-goal", {"device": "leap-simulated:v1"}),
    "leap-simulated, two hands": ("carry-together", {"device": "leap-simulated"}),
    "webxr-simulated": ("box-to-goal", {"device": "webxr-simulated"}),
}
"""Name -> task and options that differ from the defaults."""

SETTING_SEEDS = (2, 3)
"""Seeds of every entry of `SETTINGS`."""

Job = tuple[str, str, int, dict[str, Any]]
"""Group, task, seed and options of a trial."""


def jobs(quick: bool) -> dict[tuple[str, str], Job]:
    """Trials by the group and name of their row; with `quick`, one seed of each."""
    found: dict[tuple[str, str], Job] = {}
    for solid, seeds in SEEDS.items():
        group = f"solid {solid}"
        for task in TASKS:
            for seed in list(seeds)[: 1 if quick else None]:
                found[group, f"{task} {seed}"] = (group, task, seed, {"solid": solid})
    for name, (task, options) in SETTINGS.items():
        for seed in SETTING_SEEDS[: 1 if quick else None]:
            found["settings", f"{name}: {task} {seed}"] = ("settings", task, seed, options)
    return found


def play(job: Job) -> Observed:
    """Plays a trial and returns its row."""
    _, task, seed, options = job
    return outcome(run_trial(task, seed, trajectories=False, **options).result)
