"""The list of measures of a trial: what each is called, means, and where it comes from.

All are columns of `trial_results.csv`, worked out from a trial's result and its 60 Hz tables
whenever tables are made; never while it runs. docs/measures.md has the whole definitions.
"""

from __future__ import annotations

from dataclasses import dataclass

ALL = "all"
HANDLING = "tasks with things to handle"
GOALS = "tasks with goals"
PLACES = "tasks with one goal that stays where it is"
LABELS = "where fingers are known: simulated users, devices that tell"
LIVE = "devices with a clock of their own"
PAGE = "trials on the page"

HIGH, LOW = "high", "low"
"""Which way a measure is better."""


@dataclass(frozen=True)
class Measure:
    """A measure of a trial.

    Attributes:
        name: Column of `trial_results.csv`.
        unit: Of its numbers; `0/1` for yes or no; empty for a word.
        title: For plots.
        means: Its definition in a line, for the codebook.
        better: `HIGH`, `LOW`, or empty where neither is.
        tasks: Where it applies; elsewhere its cell is empty.
        source: Whose definition it is; `ours` where nobody's.
        at_end: It is known from the trial's result, and not from its 60 Hz tables.
    """

    name: str
    unit: str
    title: str
    means: str
    better: str = ""
    tasks: str = ALL
    source: str = "ours"
    at_end: bool = False


BALASUBRAMANIAN = "Balasubramanian, Melendez-Calderon, Roby-Brami and Burdet 2015"
ISO = "ISO 9241-411; Soukoreff and MacKenzie 2004"

MEASURES = (
    Measure(
        "success", "0/1", "Success",
        "the goal was held for the task's hold time; the same as held",
        better=HIGH, at_end=True,
    ),
    Measure(
        "instant", "0/1", "Reached for an instant",
        "the goal was reached at some moment",
        better=HIGH, at_end=True,
    ),
    Measure(
        "held", "0/1", "Held",
        "the goal was reached for the hold time without a break",
        better=HIGH, at_end=True,
    ),
    Measure(
        "final", "0/1", "Still there at the end",
        "the goal was still reached when the trial ended, 1 s after success",
        better=HIGH, at_end=True,
    ),
    Measure(
        "progress", "0 to 1", "Progress",
        "how near the goal was at the end",
        better=HIGH, at_end=True,
    ),
    Measure(
        "time_s", "s", "Time",
        "simulated time until the goal was held, or until the trial ended",
        better=LOW, at_end=True,
    ),
    Measure(
        "first_attempt_success", "0/1", "Success at the first attempt",
        "success without a regrasp, a drop, or a thing that left the workspace",
        better=HIGH, tasks=HANDLING,
    ),
    Measure(
        "completion_s", "s", "Completion time",
        "time_s of a success; empty without one",
        better=LOW,
    ),
    Measure(
        "first_contact_s", "s", "Time to first touch",
        "simulated time of the first touch",
        better=LOW,
    ),
    Measure(
        "first_push_s", "s", "Time to first contact",
        "simulated time at which the hand first pushed a thing",
        better=LOW, tasks=HANDLING,
    ),
    Measure(
        "grasps", "", "Grasps",
        "stretches of pushing a thing in which two digits or more did at once",
        better=LOW, tasks=HANDLING,
    ),
    Measure(
        "regrasps", "", "Regrasps",
        "grasps, up to time_s, of a thing that had been grasped and let go for 0.1 s or longer",
        better=LOW, tasks=HANDLING,
    ),
    Measure(
        "drops", "", "Drops",
        "times that a thing touched nothing and fell by more than 10 mm",
        better=LOW, tasks=HANDLING,
    ),
    Measure(
        "palm_path_m", "m", "Path of the palm",
        "length of the commanded palm's path while the hand was down",
        better=LOW,
    ),
    Measure(
        "palm_efficiency", "0 to 1", "Path efficiency of the palm",
        "distance between the ends of that path over its length",
        better=HIGH,
    ),
    Measure(
        "object_path_m", "m", "Path of the object",
        "length of the paths of all things that have a goal",
        better=LOW, tasks=GOALS,
    ),
    Measure(
        "object_efficiency", "0 to 1", "Path efficiency of the object",
        "distances between the ends of those paths, added up, over object_path_m",
        better=HIGH, tasks=GOALS,
    ),
    Measure(
        "placement_error_m", "m", "Placement error",
        "distance of a thing from its goal at time_s; mean over goals",
        better=LOW, tasks=GOALS,
    ),
    Measure(
        "placement_error_deg", "deg", "Placement error (turn)",
        "angle about the vertical of a thing against its goal at time_s, look-alike turns being "
        "equal; mean over goals",
        better=LOW, tasks=GOALS,
    ),
    Measure(
        "palm_peak_m_s", "m/s", "Peak speed of the palm",
        "largest speed of the commanded palm while the hand was down",
    ),
    Measure(
        "object_peak_m_s", "m/s", "Peak speed of the object",
        "largest speed of a thing that has a goal",
        better=LOW, tasks=GOALS,
    ),
    Measure(
        "palm_sparc", "", "Smoothness of the palm",
        "spectral arc length of the palm's speed in its longest stay down; negative, nearer 0 is "
        "smoother",
        better=HIGH, source=BALASUBRAMANIAN,
    ),
    Measure(
        "object_sparc", "", "Smoothness of the object",
        "the same of the thing with a goal that went farthest, from first_push_s to time_s",
        better=HIGH, tasks=GOALS, source=BALASUBRAMANIAN,
    ),
    Measure(
        "label_switches", "", "Label switches",
        "times that a touch that had a finger got another one",
        better=LOW,
    ),
    Measure(
        "label_truth", "", "Who knows the fingers",
        "who knows the fingers: `simulated user`, `device`, or nobody",
        tasks=LABELS,
    ),
    Measure(
        "label_accuracy", "0 to 1", "Label accuracy",
        "share of the time of named touches in which the finger was right",
        better=HIGH, tasks=LABELS,
    ),
    Measure(
        "label_errors", "", "Wrong labels",
        "times that a touch got a wrong finger",
        better=LOW, tasks=LABELS,
    ),
    Measure(
        "label_recovery_s", "s", "Time to the right label",
        "from a wrong finger to the right one of the same touch; mean over those that were put "
        "right",
        better=LOW, tasks=LABELS,
    ),
    Measure(
        "label_unrecovered", "", "Labels never put right",
        "wrong fingers that were never put right",
        better=LOW, tasks=LABELS,
    ),
    Measure(
        "lost_s", "s", "Lost time",
        "real time by which the machine fell behind; 0 for a fast one",
        better=LOW, at_end=True,
    ),
    Measure(
        "waited_s", "s", "Time before the first touch",
        "real time from the scene being seen to the first touch, with which simulated time "
        "begins; 0 where it begins at once",
        better=LOW, tasks=PAGE, at_end=True,
    ),
    Measure(
        "away_s", "s", "Page gone",
        "real time for which nothing was heard of the page; stretches above 1 s",
        better=LOW, tasks=PAGE, at_end=True,
    ),
    Measure(
        "away", "", "Times that the page was gone",
        "number of such stretches",
        better=LOW, tasks=PAGE, at_end=True,
    ),
    Measure(
        "latency_p50_ms", "ms", "Latency (median)",
        "touch received to the step that it took effect in: median",
        better=LOW, tasks=LIVE, at_end=True,
    ),
    Measure(
        "latency_p95_ms", "ms", "Latency (95th percentile)",
        "95th percentile of the same",
        better=LOW, tasks=LIVE, at_end=True,
    ),
    Measure(
        "latency_p99_ms", "ms", "Latency (99th percentile)",
        "99th percentile of the same",
        better=LOW, tasks=LIVE, at_end=True,
    ),
    Measure(
        "move_amplitude_m", "m", "Amplitude",
        "how far the thing was moved along the line from its start to its goal, at time_s",
        tasks=PLACES, source=ISO,
    ),
    Measure(
        "move_error_m", "m", "Endpoint error along the way",
        "signed distance beyond the goal along that line, at time_s",
        tasks=PLACES, source=ISO,
    ),
    Measure(
        "throughput_bit_s", "bit/s", "Effective throughput",
        "effective throughput over the successes that count of this participant with these "
        "levels, 3 or more; the same in all rows of these levels",
        better=HIGH, tasks=PLACES, source=ISO,
    ),
)  # fmt: skip

_NOT_OF_ONE_TRIAL = ("label_truth", "throughput_bit_s")
OF_RULES = ("time_s", *(m.name for m in MEASURES if m.name not in ("time_s", *_NOT_OF_ONE_TRIAL)))
"""Numbers of a trial that an exclusion rule may look at; the first is the default."""

BY_NAME = {measure.name: measure for measure in MEASURES}
