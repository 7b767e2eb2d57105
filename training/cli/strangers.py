"""`python -m training strangers`: measures models on people who took no part in the training."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from encoders.capture import Capture
from encoders.evaluation.result_values import plain
from encoders.evaluation.subjects import TRAINING_DAY
from encoders.labels.belief import BeliefLabels, builtin_population_belief
from encoders.person.rest_posture import MOST, knowing_rest, rest_samples
from encoders.regression.trained import POPULATION, TrainedModel, builtin
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
from training.strangers import StrangerResult, judge_stranger, summary

SCHEMA = 1
"""Version of the JSON."""

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
