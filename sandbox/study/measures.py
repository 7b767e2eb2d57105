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


@dataclass(frozen=True)
class Measure:
    """A measure of a trial.

    Attributes:
        name: Column of `trial_results.csv`.
        unit: Of its numbers; `0/1` for yes or no; empty for a word.
        means: Its definition in a line, for the codebook.
        source: Whose definition it is; `ours` where nobody's.
        tasks: Where it applies; elsewhere its cell is empty.
        better: `high`, `low`, or empty where neither is.
        title: For plots.
        at_end: It is known from the trial's result, and not from its 60 Hz tables.
    """

    name: str
    unit: str
    means: str
    source: str
    tasks: str
    better: str
    title: str
    at_end: bool = False


BALASUBRAMANIAN = "Balasubramanian, Melendez-Calderon, Roby-Brami and Burdet 2015"
ISO = "ISO 9241-411; Soukoreff and MacKenzie 2004"

MEASURES: tuple[Measure, ...] = (
    Measure("success", "0/1", "the goal was held for the task's hold time; the same as held",
            "ours", ALL, "high", "Success", True),
    Measure("instant", "0/1", "the goal was reached at some moment",
            "ours", ALL, "high", "Reached for an instant", True),
    Measure("held", "0/1", "the goal was reached for the hold time without a break",
            "ours", ALL, "high", "Held", True),
    Measure("final", "0/1", "the goal was still reached when the trial ended, 1 s after success",
            "ours", ALL, "high", "Still there at the end", True),
    Measure("progress", "0 to 1", "how near the goal was at the end",
            "ours", ALL, "high", "Progress", True),
    Measure("time_s", "s", "simulated time until the goal was held, or until the trial ended",
            "ours", ALL, "low", "Time", True),
    Measure("first_attempt_success", "0/1", "success without a regrasp, a drop, or a thing that "
            "left the workspace", "ours", HANDLING, "high", "Success at the first attempt"),
    Measure("completion_s", "s", "time_s of a success; empty without one",
            "ours", ALL, "low", "Completion time"),
    Measure("first_contact_s", "s", "simulated time of the first touch",
            "ours", ALL, "low", "Time to first touch"),
    Measure("first_push_s", "s", "simulated time at which the hand first pushed a thing",
            "ours", HANDLING, "low", "Time to first contact"),
    Measure("grasps", "", "stretches of pushing a thing in which two digits or more did at once",
            "ours", HANDLING, "low", "Grasps"),
    Measure("regrasps", "", "grasps, up to time_s, of a thing that had been grasped and let go for "
            "0.1 s or longer", "ours", HANDLING, "low", "Regrasps"),
    Measure("drops", "", "times that a thing touched nothing and fell by more than 10 mm",
            "ours", HANDLING, "low", "Drops"),
    Measure("palm_path_m", "m", "length of the commanded palm's path while the hand was down",
            "ours", ALL, "low", "Path of the palm"),
    Measure("palm_efficiency", "0 to 1", "distance between the ends of that path over its length",
            "ours", ALL, "high", "Path efficiency of the palm"),
    Measure("object_path_m", "m", "length of the paths of all things that have a goal",
            "ours", GOALS, "low", "Path of the object"),
    Measure("object_efficiency", "0 to 1", "distances between the ends of those paths, added up, "
            "over object_path_m", "ours", GOALS, "high", "Path efficiency of the object"),
    Measure("placement_error_m", "m", "distance of a thing from its goal at time_s; mean over "
            "goals", "ours", GOALS, "low", "Placement error"),
    Measure("placement_error_deg", "deg", "angle about the vertical of a thing against its goal at "
            "time_s, look-alike turns being equal; mean over goals", "ours", GOALS, "low",
            "Placement error (turn)"),
    Measure("palm_peak_m_s", "m/s", "largest speed of the commanded palm while the hand was down",
            "ours", ALL, "", "Peak speed of the palm"),
    Measure("object_peak_m_s", "m/s", "largest speed of a thing that has a goal",
            "ours", GOALS, "low", "Peak speed of the object"),
    Measure("palm_sparc", "", "spectral arc length of the palm's speed in its longest stay down; "
            "negative, nearer 0 is smoother", BALASUBRAMANIAN, ALL, "high",
            "Smoothness of the palm"),
    Measure("object_sparc", "", "the same of the thing with a goal that went farthest, from "
            "first_push_s to time_s", BALASUBRAMANIAN, GOALS, "high", "Smoothness of the object"),
    Measure("label_switches", "", "times that a touch that had a finger got another one",
            "ours", ALL, "low", "Label switches"),
    Measure("label_truth", "", "who knows the fingers: `simulated user`, `device`, or nobody",
            "ours", LABELS, "", "Who knows the fingers"),
    Measure("label_accuracy", "0 to 1", "share of the time of named touches in which the finger "
            "was right", "ours", LABELS, "high", "Label accuracy"),
    Measure("label_errors", "", "times that a touch got a wrong finger",
            "ours", LABELS, "low", "Wrong labels"),
    Measure("label_recovery_s", "s", "from a wrong finger to the right one of the same touch; mean "
            "over those that were put right", "ours", LABELS, "low", "Time to the right label"),
    Measure("label_unrecovered", "", "wrong fingers that were never put right",
            "ours", LABELS, "low", "Labels never put right"),
    Measure("lost_s", "s", "real time by which the machine fell behind; 0 for a fast one",
            "ours", ALL, "low", "Lost time", True),
    Measure("waited_s", "s", "real time from the scene being seen to the first touch, with which "
            "simulated time begins; 0 where it begins at once",
            "ours", PAGE, "low", "Time before the first touch", True),
    Measure("away_s", "s", "real time for which nothing was heard of the page; stretches above 1 s",
            "ours", PAGE, "low", "Page gone", True),
    Measure("away", "", "number of such stretches",
            "ours", PAGE, "low", "Times that the page was gone", True),
    Measure("latency_p50_ms", "ms", "touch received to the step that it took effect in: median",
            "ours", LIVE, "low", "Latency (median)", True),
    Measure("latency_p95_ms", "ms", "95th percentile of the same",
            "ours", LIVE, "low", "Latency (95th percentile)", True),
    Measure("latency_p99_ms", "ms", "99th percentile of the same",
            "ours", LIVE, "low", "Latency (99th percentile)", True),
    Measure("move_amplitude_m", "m", "how far the thing was moved along the line from its start to "
            "its goal, at time_s", ISO, PLACES, "", "Amplitude"),
    Measure("move_error_m", "m", "signed distance beyond the goal along that line, at time_s",
            ISO, PLACES, "", "Endpoint error along the way"),
    Measure("throughput_bit_s", "bit/s", "effective throughput over the successes that count of "
            "this participant with these levels, 3 or more; the same in all rows of these levels",
            ISO, PLACES, "high", "Effective throughput"),
)  # fmt: skip

_NOT_OF_ONE_TRIAL = ("label_truth", "throughput_bit_s")
OF_RULES = ("time_s", *(m.name for m in MEASURES if m.name not in ("time_s", *_NOT_OF_ONE_TRIAL)))
"""Numbers of a trial that an exclusion rule may look at; the first is the default."""

BY_NAME = {measure.name: measure for measure in MEASURES}
