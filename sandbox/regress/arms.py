"""Arms of a regression run: every task as it is, and every task made hard.

In the plain arm nearly all trials succeed, so that a small loss shows in their times alone. In the
hard arm objects or rooms are smaller, or friction is lower, so that a part of the trials fails, and
a small loss shows in their number. With seeds 0 to 39 each task succeeds in 70 to 90 % of them
(docs/results.md). The settings are frozen: a change of one makes the trials of earlier baselines
incomparable. A task of one's own has the plain arm alone.
"""

from __future__ import annotations

PLAIN, HARD = "plain", "hard"
ARMS = {PLAIN: (PLAIN,), HARD: (HARD,), "both": (PLAIN, HARD)}
"""Arms by the word that chooses them."""

HARD_SETTINGS: dict[str, str] = {
    "box-to-goal": "size=0.51",
    "wrench-turn": "size=0.7",
    "wrench-slide": "size=0.44",
    "stack": "size=0.6",
    "stack-three": "size=0.63",
    "stack-vertical": "size=0.27",
    "carry-together": "size=0.675",
    "slalom": "size=0.64",
    "chords": "size=0.7",
    "dial": "size=0.71",
    "gather": "room=0.73",
    "books": "size=0.655",
    "insert": "room=0.15",
    "close-case": "friction=0.37",
    "single-keys": "size=0.5",
}
"""What the hard arm varies (`--vary`), by task."""

_HARD_MARK = f" ({HARD})"


def row_name(task: str, arm: str) -> str:
    """Name of a task in an arm, in reports and baselines: `stack`, `stack (hard)`."""
    return task + _HARD_MARK if arm == HARD else task


def arm_of(row: str) -> str:
    """Arm of a row by its name."""
    return HARD if row.endswith(_HARD_MARK) else PLAIN


def setting_of(row: str) -> str:
    """What is varied in a row's trials; empty in the plain arm."""
    return HARD_SETTINGS.get(row.removesuffix(_HARD_MARK), "") if arm_of(row) == HARD else ""
