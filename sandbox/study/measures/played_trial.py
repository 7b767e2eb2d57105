"""Input of measures: result and 60 Hz table of a finished trial, and groups of measures."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import total
from models.frames import FINGERS
from models.scene import CONTROL_PERIOD
from sandbox.study.measures.columns import Columns
from sandbox.study.measures.handling import drops, grasps, push_intervals, true_intervals
from sandbox.study.measures.labels import FingersByContact, label_errors, label_switches
from sandbox.study.measures.movement import (
    STILL,
    efficiency,
    end_distance,
    path_length,
    sparc,
    speeds,
)
from sandbox.study.measures.throughput import movement_along
from sandbox.trial.result import TrialResult

JUMP = 0.05
"""m in one control period; only an object that is put back moves this far."""

DOWN = "down"

JOINTS = (
    ("hinge_rad", float(np.rad2deg(1.0)), 1.0, "hinge_travel_deg", "hinge_efficiency"),
    ("slide_m", 1.0, STILL, "slide_travel_m", "slide_efficiency"),
)
"""Of hinges and slides: end of the name of the column, unit of the column in that of the travel,
shortest travel that has an efficiency, and the names of travel and efficiency."""

Values = dict[str, Any]


class PlayedTrial:
    """A finished trial; groups of measures are computed once, when they are first used.

    Args:
        table: The 60 Hz table.
        result: The trial's result.
        truth: Source of the `true_*` columns.

    Attributes:
        whole: The 60 Hz table.
        table: The rows up to `time_s`; what happens after success does not count.
        result: The trial's result.
        truth: Source of the `true_*` columns; empty if the true fingers are unknown.
    """

    def __init__(self, table: Columns, result: TrialResult, truth: str = "") -> None:
        self.whole, self.result, self.truth = table, result, truth
        self.table = table.until(result.time_s)

    @cached_property
    def palm(self) -> Values:
        """Path, speed and smoothness of the commanded palm."""
        return _palm(self.table) if len(self.table) else {}

    @cached_property
    def objects(self) -> Values:
        """Path, speed, smoothness and placement of the objects with a goal."""
        return _objects(self.table) if len(self.table) else {}

    @cached_property
    def joints(self) -> Values:
        """Travel and efficiency of hinges and slides of the parts with a goal."""
        return _joints(self.table) if len(self.table) else {}

    @cached_property
    def handling(self) -> Values:
        """Pushes, grasps and drops; empty if contacts with objects are unknown."""
        return _handling(self.table) if len(self.table) else {}

    @cached_property
    def labels(self) -> Values:
        """Changes and errors of the labels."""
        return _labels(self.table, self.truth) if len(self.table) else {}

    @property
    def first_attempt_success(self) -> bool | None:
        """Success without a regrasp, a drop or an object put back; None if contacts are unknown."""
        handling = self.handling
        if not handling:
            return None
        clean = not (handling["regrasps"] or handling["drops"] or self.result.respawned)
        return self.result.success and clean


def _palm(table: Columns) -> Values:
    """Path, speed and smoothness of the commanded palms, over all hands."""
    paths: list[tuple[list[Array], list[Array]]] = []
    for hand in table.hands:
        positions = table.numbers(*(f"{hand}q_position_{axis}" for axis in "xyz"))
        down = true_intervals([phase == DOWN for phase in table.words(f"{hand}phase")])
        parts = [positions[first : last + 1] for first, last in down]
        if sum(len(part) for part in parts) >= 2:
            paths.append((parts, [speeds(part, CONTROL_PERIOD) for part in parts]))
    if not paths:
        return {}
    joined = [np.concatenate(parts) for parts, _ in paths]
    lengths = [path_length(path) for path in joined]
    longest = max((part for _, speed in paths for part in speed), key=len)
    moves = longest.sum() * CONTROL_PERIOD >= STILL
    return {
        "palm_path_m": total(lengths),
        "palm_efficiency": efficiency(total(map(end_distance, joined)), total(lengths)),
        "palm_peak_m_s": float(max(part.max(initial=0.0) for _, speed in paths for part in speed)),
        "palm_sparc": sparc(longest, CONTROL_PERIOD) if moves else None,
    }


def _objects(table: Columns) -> Values:
    """Path, speed, smoothness and placement of the objects with a goal."""
    names = [name for name in table.objects() if f"{name}_goal_x" in table]
    if not names:
        return {}
    places = {name: table.numbers(*(f"{name}_{axis}" for axis in "xyz")) for name in names}
    goals = {name: table.numbers(*(f"{name}_goal_{axis}" for axis in "xyz")) for name in names}
    parts = {name: _unbroken(places[name]) for name in names}
    lengths = {name: total(path_length(part) for part in parts[name]) for name in names}
    speed = {name: [speeds(part, CONTROL_PERIOD) for part in parts[name]] for name in names}
    length = total(lengths.values())
    values: Values = {
        "object_path_m": length,
        "object_efficiency": efficiency(
            total(end_distance(part) for some in parts.values() for part in some), length
        ),
        "object_peak_m_s": float(max(s.max(initial=0.0) for some in speed.values() for s in some)),
        "placement_error_m": float(
            np.mean([np.linalg.norm(places[name][-1] - goals[name][-1]) for name in names])
        ),
        "placement_error_deg": float(
            np.rad2deg(np.mean([abs(table.numbers(f"{name}_off_rad")[-1, 0]) for name in names]))
        ),
    }
    farthest = max(names, key=lambda name: lengths[name])
    begin = _first_push(table)
    if begin is not None and lengths[farthest] >= STILL and len(parts[farthest]) == 1:
        values["object_sparc"] = sparc(speed[farthest][0][begin:], CONTROL_PERIOD)
    if len(names) == 1:
        values |= _move(places[names[0]], goals[names[0]])
    return values


def _joints(table: Columns) -> Values:
    """Travel and efficiency of hinges and slides, over all parts with a goal."""
    values: Values = {}
    for column, unit, still, travel, straight in JOINTS:
        parts: list[Array] = []
        for name in table.objects():
            if f"{name}_{column}" in table and f"{name}_goal_x" in table:
                # A part that is put back is not moved by anybody.
                back = _put_back(table.numbers(*(f"{name}_{axis}" for axis in "xyz")))
                parts += np.split(table.numbers(f"{name}_{column}")[:, 0] * unit, back)
        if parts:
            length = total(float(np.abs(np.diff(part)).sum()) for part in parts)
            distance = total(abs(float(part[-1] - part[0])) for part in parts)
            values[travel] = length
            values[straight] = distance / length if length >= still else None
    return values


def _move(places: Array, goals: Array) -> Values:
    """Amplitude and endpoint error of an object's movement; empty if its goal moves."""
    if np.ptp(goals, axis=0).max() > STILL:
        return {}
    move = movement_along(places[0], goals[-1], places[-1])
    return {} if move is None else {"move_amplitude_m": move[0], "move_error_m": move[1]}


def _unbroken(places: Array) -> list[Array]:
    """Splits a path (n, 3) at the moments at which the object was put back."""
    return np.split(places, _put_back(places))


def _put_back(places: Array) -> list[int]:
    """Rows of a path (n, 3) at which the object was put back."""
    far = np.linalg.norm(np.diff(places, axis=0), axis=1) > JUMP
    return (np.flatnonzero(far) + 1).tolist()


def _handled(table: Columns, name: str) -> list[tuple[int, int]]:
    grip = table.numbers(f"{name}_grip_N")[:, 0]
    return push_intervals(table.words(f"{name}_digits"), np.nan_to_num(grip), CONTROL_PERIOD)


def _known(table: Columns) -> list[str]:
    """Names of the objects whose contacts are known at all moments."""
    return [name for name in table.objects() if all(table.words(f"{name}_grip_N"))]


def _first_push(table: Columns) -> int | None:
    """First row in which a hand pushes an object; None if there is none."""
    runs = [run for name in _known(table) for run in _handled(table, name)]
    return min((first for first, _ in runs), default=None)


def _handling(table: Columns) -> Values:
    """Pushes, grasps and drops; empty if contacts with objects are unknown."""
    names = _known(table)
    if not names:
        return {}
    held = []
    dropped = 0
    for name in names:
        digits = table.words(f"{name}_digits")
        held.append(grasps(digits, _handled(table, name)))
        free = [not d and not by for d, by in zip(digits, table.words(f"{name}_by"), strict=True)]
        dropped += drops(free, table.numbers(f"{name}_z")[:, 0])
    first = _first_push(table)
    return {
        "first_push_s": None if first is None else float(table.numbers("time_s")[first, 0]),
        "grasps": sum(held),  # any order: whole numbers
        "regrasps": sum(max(number - 1, 0) for number in held),  # any order: whole numbers
        "drops": dropped,
    }


def _labels(table: Columns, truth: str) -> Values:
    """Changes and errors of the labels."""
    labels = _by_contact(table, "touch")
    values: Values = {"label_switches": label_switches(labels)}
    errors = label_errors(labels, _by_contact(table, "true"), CONTROL_PERIOD)
    return values | ({**errors, "label_truth": truth} if errors else {})


def _by_contact(table: Columns, kind: str) -> list[FingersByContact]:
    """Finger by hand and contact, for each row; `kind` is `touch` or `true`."""
    columns = [
        (hand, finger, table.whole(f"{hand}{kind}_{name}"))
        for hand in table.hands
        for finger, name in enumerate(FINGERS)
    ]
    return [
        {
            (hand, contact): finger
            for hand, finger, contacts in columns
            if (contact := contacts[row]) is not None
        }
        for row in range(len(table))
    ]
