"""`python -m training strangers`: measures models on people who took no part in the training.

Poses, finger labels and the labels' probabilities are measured. Every take of a person is judged
from its beginning. The pose is estimated with true labels. Intervals are from a bootstrap over
people (or over days of one person), since frames and takes of one person do not show how much
people differ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from cyclopts import Parameter
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from encoders.capture import Capture
from encoders.captures.subject.subject import TRAINING_DAY
from encoders.evaluation.labels import takes
from encoders.evaluation.person_model import estimated
from encoders.evaluation.pose_errors import pose_errors
from encoders.evaluation.result_values import block_interval, plain
from encoders.labels.belief import BeliefLabels, builtin_population_belief
from encoders.person.rest_posture import MOST, knowing_rest, rest_samples
from encoders.regression.trained import POPULATION, TrainedModel, builtin
from models.arithmetic import Array
from models.errors import InputError
from models.person import RestSamples
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, refuse_replacing, write_json
from training.cli.people import bar, bars
from training.judged import JUDGED, pinned_people, subject
from training.names import train_names
from training.population import Population, load_population, simulate_population
from training.population.population import PEOPLE
from training.pose import at_trained_size, train_population

SCHEMA = 1
"""Version of the JSON."""

BINS = 10
"""Number of bins of the reliability curve, equally wide from 0 to 1."""

SURE = 0.99
"""Least probability of a sure answer."""

Maker = Callable[[], BeliefLabels]


@dataclass(frozen=True, kw_only=True)
class StrangersOptions:
    """Measures pose and finger labels of people who took no part in the training. The pose is
    estimated with true labels, and the labels from this and earlier frames. The calibration of the
    labels' probabilities is measured as well. Intervals are over people.

    --people judges the pinned people, half of them from each generator; they are the same for all
    models. --hold-out judges the frozen subject of one generator. For this, the models are trained
    again on people of all other sources, which takes minutes.
    All people are SIMULATED. Their hand size is known.

    Try:

        python -m training strangers --people 12
        python -m training strangers --hold-out second --rest 12
    """

    hold_out: Literal["first", "second"] | None = None
    """Generator that is left out of the training, and whose frozen subject is judged."""

    people: int | None = None
    """Number of drawn people to judge. People whose fingers touch unlike those of real people are
    left out. Default: 12, or none with --hold-out."""

    days: int = 12
    """With --hold-out: number of judged days of the frozen subject."""

    day_seed: int = 0
    """Seed that chooses the days."""

    population: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """People to train on, written by `python -m training people`. Default: simulate them again."""

    rest: int = 0
    """Largest number of poses of each hand that are known beforehand, 0 to 12, as with --rest of
    `sandbox run`. They are from the ends of other takes, of which there may be fewer."""

    names: Annotated[bool, Parameter(negative="--no-names")] = True
    """Judge finger labels as well, which takes most of the time."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """File for all numbers as JSON; - is the terminal."""


def main(argv: list[str]) -> int:
    """Runs `python -m training strangers ...`."""
    options = parse(StrangersOptions, "python -m training strangers", argv)
    _check(options)
    console = Console()
    with bars() as progress:
        rows = _rows(options, progress)
    document = {
        "schema": SCHEMA,
        "simulated": True,
        "configuration": {
            "hold_out": options.hold_out,
            "people": _people(options),
            "days": options.days if options.hold_out else 0,
            "day_seed": options.day_seed,
            "rest": options.rest,
        },
        "strangers": plain({name: summary(scores) for name, scores in rows.items()}),
    }
    Console(width=max(console.width, 120)).print(_table(document["strangers"]))
    write_json(options.json, document, sort_keys=True)
    return 0


def _people(options: StrangersOptions) -> int:
    if options.people is not None:
        return options.people
    return 0 if options.hold_out else 12


def _check(options: StrangersOptions) -> None:
    for name, value, least, most in (
        ("--people", _people(options), 0, 2 * PEOPLE["judge"]["first"]),
        ("--days", options.days, 1, 1000),
        ("--day-seed", options.day_seed, 0, 2**31),
        ("--rest", options.rest, 0, MOST),
    ):
        if not least <= value <= most:
            raise InputError(
                "the number is out of range",
                where=name,
                got=value,
                expected=f"{least} to {most:,}",
            )
    if not _people(options) and options.hold_out is None:
        raise InputError("no people to judge", where="--people", got=0, expected="1 or more")
    check_output(options.json)
    refuse_replacing(options.json, {"--population": options.population}, "--json")


def _rows(options: StrangersOptions, progress: Progress) -> dict[str, list[StrangerResult]]:
    rows: dict[str, list[StrangerResult]] = {}
    if options.hold_out:
        name = f"{options.hold_out} subject"
        model, make = _trained(options, progress)
        one = subject(options.hold_out)
        numbers = one.judged_days(options.days, options.day_seed)
        show = bar(progress, name)
        samples = rest_samples(one.day(TRAINING_DAY, None), options.rest) if options.rest else ()
        for i, number in enumerate(numbers, start=1):
            day = one.day(number, None)
            _judge(rows, f"{name}, generator held out", day, model, make, samples)
            show(i / len(numbers))
    if count := _people(options):
        shipped: tuple[TrainedModel, Maker | None]
        shipped = builtin(POPULATION), builtin_population_belief if options.names else None
        groups = {"first": (count + 1) // 2, "second": count // 2}
        show = bar(progress, "judged people")
        judged = pinned_people(JUDGED, groups, lambda share: show(0.5 * share))
        if not judged:
            raise InputError(
                "all judged people are left out: their fingers touch unlike real people's",
                where=f"--people {count}",
                expected="more people",
            )
        for i, person in enumerate(judged):
            sized = at_trained_size(person, float(person.meta["size"]))
            samples, rest = _seen(sized, options.rest)
            _judge(rows, "judged people, population", rest, *shipped, samples)
            show(0.5 + 0.5 * (i + 1) / len(judged))
    return rows


def _judge(
    rows: dict[str, list[StrangerResult]],
    name: str,
    capture: Capture,
    model: TrainedModel,
    make: Maker | None,
    samples: RestSamples,
) -> None:
    """Judges a person; if there are samples of the hand's rest, also with these samples."""
    judgement = judge_stranger(capture, model, make() if make else None)
    rows.setdefault(name, []).append(judgement)
    if samples:
        known = knowing_rest(model, samples, 1.0)
        rows.setdefault(f"{name}, hand seen", []).append(judge_stranger(capture, known, None))


def _seen(person: Capture, count: int) -> tuple[RestSamples, Capture]:
    """Samples of the hand's rest from the first half of the person's takes, and the other takes.

    If `count` is 0, there are no samples, and all takes are returned.
    """
    if not count:
        return (), person
    numbers = np.unique(person.trial)
    first = np.isin(person.trial, numbers[: len(numbers) // 2])
    return rest_samples(person.select(first), count), person.select(~first)


def _trained(options: StrangersOptions, progress: Progress) -> tuple[TrainedModel, Maker | None]:
    """Pose model and labeller, trained without people of the generator that is held out."""
    people = _training_people(options, progress).of(without=options.hold_out)
    about = {"digest": people.digest, **people.meta}
    show = bar(progress, "training the pose")
    model = train_population(people.people, about, progress=show)
    if not options.names:
        return model, None
    show = bar(progress, "training names")
    belief = train_names(people.people, people.digest, lambda share, loss: show(share))
    return model, lambda: BeliefLabels(belief, None, learns=True)


def _training_people(options: StrangersOptions, progress: Progress) -> Population:
    if options.population is not None:
        return load_population(options.population).of(group="train")
    train = {s: n for s, n in PEOPLE["train"].items() if s != options.hold_out}
    return simulate_population("", {"train": train}, bar(progress, "people to train on"))


def _table(rows: dict[str, dict[str, Any]]) -> Table:
    table = Table(
        title="Strangers: SIMULATED people on whom nothing was trained; brackets: 95 % over people "
        "or days",
        title_justify="left",
    )
    table.add_column("judged, and trained on")
    for column in ("wrist cm", "joints deg", "named right, %: 2 / 3 / 4 / 5", "all"):
        table.add_column(column, justify="right")
    table.add_column("sure:\nright", justify="right")
    table.add_column("error\nof p", justify="right")
    for name, row in rows.items():
        cells = [_interval(row, "wrist_cm", 2), _interval(row, "angle_deg", 1)]
        if "labels_percent" in row:
            shares = row["labels_percent"]
            cells.append(" / ".join(_number(shares[str(k)], 1) for k in range(2, 6)))
            cells.append(_within(shares["all"], row["labels_percent_interval"]["all"], 1))
            cells.append(_number(row["sure"]["right_percent"], 1))
            cells.append(_number(row["calibration_error_percent"], 1))
        table.add_row(f"{name} ({row['people']})", *cells)
    return table


def _interval(row: dict[str, Any], key: str, digits: int) -> str:
    return _within(row[key], row[f"{key}_interval"], digits)


def _within(value: float, ends: Sequence[float | None], digits: int) -> str:
    """A value with its interval; without an interval for a single person or day."""
    low, high = ends
    if low is None or high is None:
        return f"{value:.{digits}f}"
    return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


@dataclass(frozen=True)
class StrangerResult:
    """Results of one person or day, T frames.

    Attributes:
        fingers: (T,) number of contacts.
        wrist: (T,) cm, error of the wrist's position with true labels.
        angle: (T,) degrees, mean error of the ball joints with true labels.
        right: (T,) true for frames in which all contacts have correct labels.
        claimed: (T,) probability of the labels according to the labeller; NaN for frames without
            labels.
    """

    fingers: NDArray[np.int64]
    wrist: Array
    angle: Array
    right: NDArray[np.bool_]
    claimed: Array


def judge_stranger(
    capture: Capture, model: TrainedModel, labeller: BeliefLabels | None
) -> StrangerResult:
    """Judges a model and a labeller on a person.

    Args:
        capture: The person, at the trained hand's size.
        model: Encoder with its correction.
        labeller: Labels the contacts, with the help of earlier frames; None judges no labels.
    """
    frames = len(capture)
    right, claimed = np.zeros(frames, bool), np.full(frames, np.nan)
    if labeller is not None:
        _name(capture, labeller, right, claimed)
    errors = pose_errors(estimated(model, capture), capture.q)
    fingers = capture.down.sum(axis=1)
    return StrangerResult(fingers, errors.wrist, errors.angle, right, claimed)


def _name(
    capture: Capture, labeller: BeliefLabels, right: NDArray[np.bool_], claimed: Array
) -> None:
    rng = np.random.default_rng(0)
    for _, frames in takes(capture):
        labeller.restart()
        for t in frames:
            fingers = rng.permutation(np.flatnonzero(capture.down[t]))
            places = {
                int(capture.ids[t, f]): (float(capture.xy[t, f, 0]), float(capture.xy[t, f, 1]))
                for f in fingers
            }
            labelling = labeller.assign(places, {})
            truth = {int(capture.ids[t, f]): int(f) for f in fingers}
            right[t] = labelling.labels == truth
            claimed[t] = labelling.probability


def summary(people: Sequence[StrangerResult]) -> dict[str, Any]:
    """Means over all frames, with intervals from a bootstrap over people, as JSON values."""
    person = np.repeat(np.arange(len(people)), [len(p.fingers) for p in people])
    wrist, angle, right, claimed, fingers = (
        np.concatenate([getattr(p, name) for p in people])
        for name in ("wrist", "angle", "right", "claimed", "fingers")
    )
    out: dict[str, Any] = {"people": len(people), "frames": len(person)}
    for name, values in (("wrist_cm", wrist), ("angle_deg", angle)):
        out[name] = float(values.mean())
        out[f"{name}_interval"] = block_interval(values, person)
    named = ~np.isnan(claimed)
    if not named.any():
        return out
    share = 100.0 * right
    parts = {str(k): fingers == k for k in range(2, 6)} | {"all": fingers > 1}
    out["labels_percent"] = {k: _mean(share[frames]) for k, frames in parts.items()}
    out["labels_percent_interval"] = {
        k: block_interval(share[frames], person[frames]) for k, frames in parts.items()
    }
    sure = claimed >= SURE
    out["sure"] = {
        "right_percent": _mean(share[sure]),
        "share_percent": 100.0 * float(sure.mean()),
        "share_of_three_and_more_percent": 100.0 * _mean(sure[fingers > 2].astype(float)),
    }
    curve = reliability(claimed[named], right[named])
    out["reliability"] = curve
    out["calibration_error_percent"] = calibration_error(curve)
    return out


def reliability(claimed: Array, right: NDArray[np.bool_]) -> list[dict[str, float]]:
    """Reliability curve: mean claimed probability and share of correct frames, for each bin of the
    claimed probability.

    A frame is correct if all its fingers have correct labels. Bins without frames are left out.

    Args:
        claimed: (n,) claimed probabilities, 0 to 1.
        right: (n,) true for correct frames.
    """
    bins = np.minimum((BINS * claimed).astype(int), BINS - 1)
    return [
        {
            "from": b / BINS,
            "to": (b + 1) / BINS,
            "share": float((bins == b).mean()),
            "claimed": float(claimed[bins == b].mean()),
            "right": float(right[bins == b].mean()),
        }
        for b in np.unique(bins).tolist()
    ]


def calibration_error(curve: Sequence[dict[str, float]]) -> float:
    """Mean difference (percent) between claimed probability and share of correct frames over the
    bins, weighted by frames."""
    return 100.0 * sum(b["share"] * abs(b["claimed"] - b["right"]) for b in curve)


def _mean(values: Array) -> float:
    return float(values.mean()) if len(values) else float("nan")
