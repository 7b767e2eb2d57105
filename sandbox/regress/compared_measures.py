"""Measures of a trial that a regression run compares: their declarations and their computation.

Success and time decide whether a run passes. The other measures describe the quality of the
movement; their changes are only reported.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import log
from typing import Any

from models.arithmetic import length
from models.scene import CONTROL_PERIOD
from sandbox.session.messages import Snapshot

SUCCESS, TIME = "success", "time"
DECIDING = (SUCCESS, TIME)
"""Names of the measures that decide whether a run passes."""


@dataclass(frozen=True)
class Measure:
    """A measure of a trial.

    Attributes:
        name: Its name in options, reports and baselines.
        unit: Its unit; empty for counts and shares.
        more_is_better: True if larger values are better.
        about: Description in words.
        relative: True if changes are shares of the value before; otherwise they are differences.
    """

    name: str
    unit: str
    more_is_better: bool
    about: str
    relative: bool = False

    def change(self, before: float, now: float) -> float:
        """Change of a trial's value; positive changes are worse.

        A relative change is the logarithm of the ratio of both values.
        """
        change = log(now / before) if self.relative else now - before
        return -change if self.more_is_better else change


MEASURES: dict[str, Measure] = {
    measure.name: measure
    for measure in (
        Measure(SUCCESS, "points", True, "trials that succeed"),
        Measure(TIME, "s", False, "time to success; the task's limit for trials that fail", True),
        Measure("progress", "", True, "how near the goal was at the end"),
        Measure("largest force", "N", False, "largest force of a finger on objects"),
        Measure("detour", "", False, "path length of objects with a goal / straight distance"),
        Measure("fingertip error", "mm", False, "mean distance of fingertips from their touches"),
        Measure("grasps", "", False, "number of times two fingers closed on objects"),
        Measure("put back", "", False, "number of times an object left the workspace"),
        Measure("contacts lost", "", False, "touches that the screen lost"),
    )
}
"""Measures by name."""

_FORCES_EVERY = 8
"""Number of snapshots between two readings of the forces: 0.13 s."""
_MOVED = 0.005
"""Smallest sum of the objects' distances from their starts (m) for which a detour is computed."""


class HandMeter:
    """A view that measures the quality of the hand's movement in a trial."""

    def __init__(self) -> None:
        self._seen = 0
        self._force = 0.0
        self._grasps, self._grasping = 0, False
        self._paths: dict[str, float] = {}
        self._begins: dict[str, Any] = {}
        self._places: dict[str, Any] = {}
        self._errors, self._tips = 0.0, 0
        self._lost: set[tuple[int, int]] = set()
        self._losses = 0

    def see(self, snapshot: Snapshot) -> None:
        """Processes a snapshot; it must get every snapshot of a trial, in order."""
        if not snapshot.score.held:
            self._move(snapshot)
            self._touch(snapshot)
            if self._seen % _FORCES_EVERY == 0:
                self._press(snapshot)
        self._seen += 1

    def values(self, respawned: int) -> dict[str, float]:
        """Values by name; measures that do not apply to the trial are missing.

        Args:
            respawned: Number of returns of objects, from the trial's result.
        """
        values = {
            "largest force": self._force,
            "grasps": float(self._grasps),
            "put back": float(respawned),
            "contacts lost": float(self._losses),
        }
        ways = {n: length(self._places[n] - begin) for n, begin in self._begins.items()}
        way = sum(ways.values())
        if way > _MOVED:
            values["detour"] = sum(self._paths.values()) / way
        if self._tips:
            values["fingertip error"] = 1000.0 * self._errors / self._tips
        return {name: round(value, 6) for name, value in values.items()}

    def _move(self, snapshot: Snapshot) -> None:
        for goal in snapshot.goals:
            place = snapshot.objects[goal.object].position
            last = self._places.get(goal.object)
            if last is None:
                self._begins[goal.object] = place
            else:
                step = length(place - last)
                self._paths[goal.object] = self._paths.get(goal.object, 0.0) + step
            self._places[goal.object] = place

    def _touch(self, snapshot: Snapshot) -> None:
        lost = set()
        for number, hand in enumerate(snapshot.hands):
            for contact, place in zip(hand.contacts, hand.places, strict=True):
                if contact.state == "lost":
                    lost.add((number, contact.id))
                elif contact.label is not None and contact.label in hand.solid:
                    self._errors += length(hand.tips[contact.label] - place)
                    self._tips += 1
        self._losses += len(lost - self._lost)
        self._lost = lost

    def _press(self, snapshot: Snapshot) -> None:
        grasping = False
        for load in snapshot.loads:
            forces = [finger.force for finger in load.fingers]
            self._force = max(self._force, *forces)
            grasping |= sum(force > 0.0 for force in forces) >= 2
        self._grasps += grasping and not self._grasping
        self._grasping = grasping


def value(measure: str, trial: Mapping[str, Any], limit: float) -> float | None:
    """A measure of a trial; None if it is unknown or does not apply.

    Args:
        measure: Name of the measure.
        trial: The trial's `success`, `time_s`, `progress` and `measures`.
        limit: s, time limit of its task. It is the time of a failed trial.
    """
    if measure == SUCCESS:
        return float(trial["success"])
    if measure == TIME:
        # No trial takes less than a control period, but a baseline may have been edited.
        return max(float(trial["time_s"]), CONTROL_PERIOD) if trial["success"] else limit
    if measure == "progress":
        return float(trial["progress"])
    found = trial["measures"].get(measure)
    return None if found is None else float(found)


def pairs(
    measure: str,
    before: Mapping[int, Mapping[str, Any]],
    now: Mapping[int, Mapping[str, Any]],
    limit: float,
) -> Iterator[tuple[int, float, float]]:
    """Yields each seed that has a value before and now, with both values.

    Args:
        measure: Name of the measure.
        before, now: Trials by seed.
        limit: s, time limit of the task.
    """
    for seed, trial in now.items():
        if seed in before:
            was, here = value(measure, before[seed], limit), value(measure, trial, limit)
            if was is not None and here is not None:
                yield seed, was, here
