"""The measures of a trial, each with its declaration and its computation.

docs/measures.md defines them in full. The column of `trials.csv`, the row in the codebook, the use
in exclusion rules and the place in the report all follow from the declaration. A study may also
have one measure of its own, in a file beside its design.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import inf, isfinite
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from models.errors import InputError
from models.plugins import PluginKind, failure, place_in
from sandbox.study.measures.arrays import NO_CONTACT, TrialArrays
from sandbox.study.measures.grasping import handling, labels
from sandbox.study.measures.movement import joints, movement, objects, palm
from sandbox.trial.result import TrialResult, fields

Value = bool | int | float | str | None
"""Value of a measure; None if it does not apply to the trial."""

HIGH, LOW = "high", "low"
"""Values of `Measure.better`."""
LIMIT, SHARE, COUNT, LOG, PLAIN = "limit", "share", "count", "log", "plain"
"""Values of `Measure.scale`: a time that ends at a limit; yes or no; a count; a number above 0
whose ratios are compared; any other number."""

SIMULATED_USER, DEVICE = "simulated user", "device"
"""Values of `label_truth`: the true fingers come from the simulated user who played the trial, or
from the device."""
BALASUBRAMANIAN = "Balasubramanian, Melendez-Calderon, Roby-Brami and Burdet 2015"
ISO = "ISO 9241-411; Soukoreff and MacKenzie 2004"


@dataclass(frozen=True)
class Measure:
    """A measure of a trial.

    Attributes:
        name: Column of `trials.csv`.
        unit: Unit of the numbers; `0/1` for yes or no; empty for counts and words.
        title: Title in plots.
        means: Definition in one line, for the codebook.
        of: Function that computes the value from the trial up to `time_s` and the trial's result;
            it returns None if the measure does not apply. If the function raises an error, or
            returns a number that is not finite, the cell is empty and the reason is printed. None
            for the throughput, which is a measure of several trials.
        better: `HIGH` or `LOW`, the better direction; empty if neither is better.
        scale: How a report averages and compares values: one of `LIMIT`, `SHARE`, `COUNT`, `LOG`
            and `PLAIN`.
        source: Publication that defines the measure; empty if it was defined for this program.
        low: Smallest possible value.
        words: True if the values are words; exclusion rules and reports cannot use such measures.
        by_frames: False if the result alone is enough to compute it.
        in_report: False if only the tables have it, and not the report.
    """

    name: str
    unit: str
    title: str
    means: str
    of: Callable[[TrialArrays, TrialResult], Value] | None = None
    better: str = ""
    scale: str = PLAIN
    source: str = ""
    low: float = 0.0
    words: bool = False
    by_frames: bool = True
    in_report: bool = True

    @property
    def limits(self) -> tuple[float, float]:
        """Smallest and largest possible value."""
        return self.low, 1.0 if self.unit in ("0/1", "0 to 1") else inf

    @property
    def meaning(self) -> str:
        """Definition with its source, for the codebook."""
        return f"{self.means} ({self.source})" if self.source else self.means


Of = Callable[[TrialArrays, TrialResult], Value]


def _group(function: Callable[[TrialArrays], dict[str, Any]], name: str) -> Of:
    """A function for `Measure.of` that returns one value of a group, computed once a trial."""
    return lambda trial, result: trial.once(function).get(name)


def _of_result(name: str, title: str, better: str, scale: str) -> Measure:
    """A measure that is a field of the trial's result, with its unit and meaning."""
    about, value = fields()[name], attrgetter(name)
    return Measure(
        name,
        about.unit,
        title,
        about.meaning,
        lambda trial, result: value(result),
        better,
        scale,
        by_frames=False,
    )


def _live(name: str, unit: str, title: str, means: str) -> Measure:
    """A measure that is taken while the trial runs, such as a latency, and stored in the result."""
    return Measure(
        name,
        unit,
        title,
        means,
        lambda trial, result: (result.measures or {}).get(name),
        LOW,
        LOG,
        by_frames=False,
    )


def _first_attempt(trial: TrialArrays, result: TrialResult) -> bool | None:
    """True for success without a regrasp, a drop or an object that was put back; None if contacts
    with objects are unknown."""
    found = trial.once(handling)
    if not found:
        return None
    return result.success and not (found["regrasps"] or found["drops"] or result.respawned)


def _label_truth(trial: TrialArrays, result: TrialResult) -> str | None:
    """Source of the true fingers; None if they are unknown."""
    if not any((hand.true != NO_CONTACT).any() for hand in trial.hands):
        return None
    return result.fingers_by or DEVICE


MEASURES: tuple[Measure, ...] = (
    _of_result("success", "Success", HIGH, SHARE),
    _of_result("progress", "Progress", HIGH, PLAIN),
    _of_result("time_s", "Time", LOW, LIMIT),
    Measure(
        "completion_s",
        "s",
        "Completion time",
        "time_s if the trial succeeded, else empty",
        lambda trial, result: result.time_s if result.success else None,
        LOW,
        LOG,
        by_frames=False,
        in_report=False,
    ),
    Measure(
        "first_attempt_success",
        "0/1",
        "Success at the first attempt",
        "1: success without a regrasp, a drop, or an object that left the workspace",
        _first_attempt,
        HIGH,
        SHARE,
    ),
    _live("first_contact_s", "s", "Time to first touch", "simulated time of the first touch"),
    Measure(
        "first_push_s",
        "s",
        "Time to first contact",
        "simulated time at which the hand first pushed an object",
        _group(handling, "first_push_s"),
        LOW,
        LOG,
    ),
    Measure(
        "grasps",
        "",
        "Grasps",
        "number of intervals in which the hand pushes an object with two digits or more at once",
        _group(handling, "grasps"),
        LOW,
        COUNT,
    ),
    Measure(
        "regrasps",
        "",
        "Regrasps",
        "number of grasps, up to time_s, of an object that had been grasped before and released "
        "for 0.1 s or longer",
        _group(handling, "regrasps"),
        LOW,
        COUNT,
    ),
    Measure(
        "drops",
        "",
        "Drops",
        "number of times that an untouched object fell by more than 10 mm",
        _group(handling, "drops"),
        LOW,
        COUNT,
    ),
    Measure(
        "palm_path_m",
        "m",
        "Path of the palm",
        "length of the path of the commanded palm while the hand was down",
        _group(palm, "palm_path_m"),
        LOW,
        LOG,
    ),
    Measure(
        "palm_efficiency",
        "0 to 1",
        "Path efficiency of the palm",
        "distance from start to end of the palm's path, divided by its length",
        _group(palm, "palm_efficiency"),
        HIGH,
    ),
    Measure(
        "palm_sparc",
        "",
        "Smoothness of the palm",
        "spectral arc length of the palm's speed in the longest interval in which the hand was "
        "down; negative; values nearer 0 are smoother",
        _group(palm, "palm_sparc"),
        HIGH,
        source=BALASUBRAMANIAN,
        low=-inf,
    ),
    Measure(
        "object_path_m",
        "m",
        "Path of the object",
        "total length of the paths of all objects with a goal",
        _group(objects, "object_path_m"),
        LOW,
        LOG,
    ),
    Measure(
        "object_efficiency",
        "0 to 1",
        "Path efficiency of the object",
        "sum of the distances from start to end of the objects' paths, divided by object_path_m",
        _group(objects, "object_efficiency"),
        HIGH,
    ),
    Measure(
        "object_sparc",
        "",
        "Smoothness of the object",
        "spectral arc length of the speed of the object with a goal that moved farthest, from "
        "first_push_s to time_s",
        _group(objects, "object_sparc"),
        HIGH,
        source=BALASUBRAMANIAN,
        low=-inf,
    ),
    Measure(
        "placement_error_m",
        "m",
        "Placement error",
        "distance of an object from its goal at time_s; mean over goals",
        _group(objects, "placement_error_m"),
        LOW,
        LOG,
    ),
    Measure(
        "placement_error_deg",
        "deg",
        "Placement error (angle)",
        "angle about the vertical between an object and its goal at time_s; for a symmetric "
        "object, to the nearest equivalent angle; mean over goals",
        _group(objects, "placement_error_deg"),
        LOW,
    ),
    Measure(
        "hinge_travel_deg",
        "deg",
        "Travel of the hinge",
        "total angle by which the hinges of all parts with a goal were turned, in both directions",
        _group(joints, "hinge_travel_deg"),
        LOW,
    ),
    Measure(
        "hinge_efficiency",
        "0 to 1",
        "Efficiency of the hinge",
        "sum of the net turns of the hinges of all parts with a goal, divided by hinge_travel_deg",
        _group(joints, "hinge_efficiency"),
        HIGH,
    ),
    Measure(
        "slide_travel_m",
        "m",
        "Travel of the slide",
        "total distance by which the slides of all parts with a goal were moved, in both "
        "directions",
        _group(joints, "slide_travel_m"),
        LOW,
        LOG,
    ),
    Measure(
        "slide_efficiency",
        "0 to 1",
        "Efficiency of the slide",
        "sum of the net displacements of the slides of all parts with a goal, divided by "
        "slide_travel_m",
        _group(joints, "slide_efficiency"),
        HIGH,
    ),
    Measure(
        "label_switches",
        "",
        "Label switches",
        "number of times that a labelled touch got another finger label",
        _group(labels, "label_switches"),
        LOW,
        COUNT,
    ),
    Measure(
        "label_truth",
        "",
        "Source of the true fingers",
        "source of the true fingers: `simulated user` or `device`; empty if they are unknown",
        _label_truth,
        words=True,
    ),
    Measure(
        "label_accuracy",
        "0 to 1",
        "Label accuracy",
        "share of the time of labelled touches in which the label was right",
        _group(labels, "label_accuracy"),
        HIGH,
    ),
    Measure(
        "label_errors",
        "",
        "Wrong labels",
        "number of times that a touch got a wrong finger label",
        _group(labels, "label_errors"),
        LOW,
        COUNT,
    ),
    Measure(
        "label_recovery_s",
        "s",
        "Time to the right label",
        "time from a wrong label to the right label of the same touch; mean over the corrected "
        "errors",
        _group(labels, "label_recovery_s"),
        LOW,
        LOG,
    ),
    _live(
        "lost_s",
        "s",
        "Lost time",
        "real time that the simulation lost because the machine was too slow; 0 on a fast machine",
    ),
    _live(
        "waited_s",
        "s",
        "Time before the first touch",
        "real time from the moment at which the scene is visible to the first touch, which starts "
        "simulated time; pauses and time without the page are left out; 0 if simulated time starts "
        "at once",
    ),
    _live(
        "away_s",
        "s",
        "Time without the page",
        "total real time for which the page was closed, hidden, or silent for more than 1.5 s "
        "(1 s with a finger down)",
    ),
    _live(
        "latency_p95_ms",
        "ms",
        "Latency (95th percentile)",
        "95th percentile of the time from receiving a touch to the step in which it took effect",
    ),
    Measure(
        "throughput_bit_s",
        "bit/s",
        "Effective throughput",
        "effective throughput over the successful trials of the session with the same task and "
        "levels (at least 3, without practice and excluded trials); the same value in all rows "
        "with this task and these levels",
        better=HIGH,
        scale=LOG,
        source=ISO,
    ),
)
"""All measures except a study's own measure, in the order of their columns."""

REMOVED = {
    "instant": "progress",
    "held": "success",
    "final": "success",
    "palm_peak_m_s": "palm_sparc",
    "object_peak_m_s": "object_sparc",
    "label_unrecovered": "label_errors",
    "away": "away_s",
    "latency_p50_ms": "latency_p95_ms",
    "latency_p99_ms": "latency_p95_ms",
    "move_amplitude_m": "throughput_bit_s",
    "move_error_m": "throughput_bit_s",
}
"""Removed measures of earlier versions, and the measures that replace them."""

_BY_NAME = {measure.name: measure for measure in MEASURES}
_IN_FILES: PluginKind[Measure] = PluginKind("measure", "", InputError)


def find_measure(name: str, own: Measure | None = None) -> Measure | None:
    """Returns the measure with a name; None if it does not exist.

    Args:
        name: Name of the measure's column.
        own: The study's own measure, if it has one.
    """
    return own if own is not None and name == own.name else _BY_NAME.get(name)


def all_measures(own: Measure | None) -> tuple[Measure, ...]:
    """All measures of a study, in the order of their columns."""
    return MEASURES if own is None else (*MEASURES, own)


def rule_measures(own: Measure | None) -> tuple[str, ...]:
    """Names of the measures that exclusion rules may use: numbers of a single trial, `time_s`
    first."""
    names = [m.name for m in all_measures(own) if not m.words and m.of is not None]
    return ("time_s", *(name for name in names if name != "time_s"))


def load_measure(place: str, folder: Path) -> Measure:
    """Loads a study's own measure.

    Args:
        place: `FILE.py:NAME`.
        folder: Folder of the design, in which the file is.

    Raises:
        InputError: The file or the measure does not exist, the measure is not valid, or it has the
            name of another measure.
    """
    named = place_in(place)
    beside = named is not None and Path(named.source).name == named.source
    if named is None or not (named.in_file and named.member and beside):
        raise InputError(
            "this does not name a measure in a file",
            where="own_measure",
            got=place,
            expected="FILE.py:NAME, with the file in the folder of the design",
        )
    measure = _IN_FILES.load(named._replace(source=str(folder / named.source))).value
    if not isinstance(measure, Measure):
        raise InputError(
            "expected a measure",
            where=place,
            got=type(measure).__name__,
            expected="sandbox.study.measures.measures.Measure",
        )
    wrong = ""
    if measure.name in _BY_NAME or measure.name in REMOVED:
        wrong = "the program has a measure of this name"
    elif not measure.name.isidentifier():
        wrong = "this name cannot be the name of a column"
    elif measure.of is None:
        wrong = "the measure has no function that computes it"
    if wrong:
        raise InputError(wrong, where=place, got=measure.name, expected="such as palm_height_m")
    return measure


@dataclass(frozen=True)
class Measured:
    """Computed measures of a trial.

    Attributes:
        values: `Value` by name; None for an empty cell.
        failed: Reasons why measures failed, by name; their cells are empty.
        moved: Amplitude and error of the movement to the goal, m, for the throughput; None if
            there is no such movement.
    """

    values: dict[str, Any] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    moved: tuple[float, float] | None = None


def measure_trial(
    trial: TrialArrays | None, result: TrialResult, measures: Iterable[Measure] = MEASURES
) -> Measured:
    """Computes the measures of a trial.

    Args:
        trial: The trial's frames. If they are None or empty, measures that need them are empty.
        result: The trial's result.
        measures: The measures to compute.
    """
    # Frames after `time_s`, such as those after success, do not count.
    counts = TrialArrays.of({}) if trial is None else trial.until(result.time_s)
    found = Measured(moved=movement(counts))
    for measure in measures:
        if measure.of is None:
            continue
        value: Any = None
        if len(counts) or not measure.by_frames:
            try:
                value = measure.of(counts, result)
            except Exception as error:
                # A study's own measure may raise any error. The caller prints the reason.
                found.failed[measure.name] = failure(error)
            value = value.item() if isinstance(value, np.generic) else value
            if wrong := _wrong(value):
                found.failed[measure.name], value = wrong, None
        found.values[measure.name] = value
    return found


def _wrong(value: Any) -> str:
    """Reason why a value cannot be stored in a table; empty if it can be stored."""
    if value is not None and not isinstance(value, bool | int | float | str):
        return f"it returned a {type(value).__name__}, not a number, yes or no, or a word"
    if isinstance(value, float) and not isfinite(value):
        return f"it returned {value}"
    return ""
