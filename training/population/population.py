"""The people of a population: how they are drawn, their captures, and a file of them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b, sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.npz import read_npz, write_npz
from models.errors import CaptureError, InputError
from training.population import posed_people
from training.population.generated_people import first_person, second_person

SCHEMA = 1
"""Version of the file's layout."""

VERSION = 2
"""Version of the people. Every change that draws other people raises it."""

SOURCES = ("first", "second", "posed")
"""Sources of people: both generators, and kinematics alone."""

GROUPS = ("train", "choose", "judge")
"""Purposes of people: to train on, to choose settings on, to judge on. No person has two
purposes."""

PEOPLE = {
    "train": {"first": 200, "second": 160, "posed": 360},
    "choose": {"first": 36, "second": 30, "posed": 0},
    "judge": {"first": 72, "second": 48, "posed": 0},
}
"""Number of people that are drawn, by group and source. Posed people have no movement, so they
cannot be used to judge labels that depend on earlier frames."""

SCRIPT = (120, 100, 60, 60)
"""Numbers of frames of the script in which 2, 3, 4 and 5 fingers touch. More frames of each person
did not improve the models; more people did."""

SCRIPT_RATE = 2.0
"""Rate (Hz) of the script. It is low because successive frames of a movement are nearly equal."""

PLAY = (240, 270, 160, 280)
"""Numbers of frames of free play in which 2, 3, 4 and 5 fingers touch, in the proportions of the
frozen subjects."""

PLAY_RATE = 30.0
"""Rate (Hz) of free play."""

POSTURES = 20
"""Number of postures that are tried for a posed person, for each set of two fingers."""

ORDERLY = 0.75
"""Least share of a person's layouts of four and five fingers in which the touches are in the order
of the fingers. Of real layouts of five fingers, 99 % are in order. Drawn people below this share
are left out: about a fifth of the generators' people, and half of the posed people. For all other
people, only the frames with crossed fingers are left out."""

NEIGHBOURS = ((41, 54, 62), (25, 29, 34), (19, 23, 26), (25, 31, 36))
"""Distances (mm) between neighbouring fingertips, thumb and index first: the 10, 50 and 90 percent
quantiles of 147 layouts that 19 real people put down with five fingers on a tablet."""

BEYOND = 3.0
"""Limit for a person's median distances between neighbouring fingertips, divided by the hand's
size. Their deviations from the medians in `NEIGHBOURS` must be less than this factor times the
deviation of the 10 or 90 percent quantile. All other people are left out."""

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Population:
    """Captures of simulated people, one person after another.

    Attributes:
        people: Captures: the script for people to train on, free play for all others. Their `meta`
            has `source`, `group`, `number`, `size` (relative to the trained hand) and `simulated`.
        meta: Salt and version with which people were drawn.
    """

    people: tuple[Capture, ...]
    meta: dict[str, Any]

    @cached_property
    def digest(self) -> str:
        """Digest (BLAKE2b, hexadecimal) of all people: group, source, number, seed and size, and
        their touches to a micrometre."""
        hash_ = blake2b(digest_size=16)
        for person in self.people:
            hash_.update(json.dumps(_who(person), sort_keys=True).encode())
            # In single precision, as in a file: people have the same digest before they are saved
            # and after they are loaded.
            stored = person.xy.astype(np.float32).astype(float)
            micrometres = np.where(person.down[..., None], np.rint(stored * 1e6), 0.0)
            hash_.update(micrometres.astype(np.int64).tobytes())
        return hash_.hexdigest()

    def of(self, *, group: str | None = None, without: str | None = None) -> Population:
        """The people of a group, and of all sources except `without`."""
        chosen = tuple(
            person
            for person in self.people
            if (group is None or person.meta["group"] == group)
            and (without is None or person.meta["source"] != without)
        )
        return Population(chosen, self.meta)


def simulate_population(
    salt: str = "",
    groups: Mapping[str, Mapping[str, int]] | None = None,
    progress: Progress | None = None,
    first: Mapping[str, int] | None = None,
) -> Population:
    """Simulates people; equal arguments give equal people.

    Args:
        salt: Text from which all seeds are derived. For people of the test, it is the digest of the
            tested models, so that these people cannot be chosen by hand.
        groups: Number of people by group and source; by default `PEOPLE`.
        progress: Called with the share done, 0 to 1.
        first: Number of the first person by source; by default 0. People with other numbers are
            other people.

    Raises:
        InputError: A group or a source is unknown, or all numbers of people are 0.
    """
    wanted = [
        (group, source, number)
        for group, sources in (PEOPLE if groups is None else groups).items()
        for source, count in sources.items()
        for number in range((first or {}).get(source, 0), (first or {}).get(source, 0) + count)
    ]
    if not wanted:
        raise InputError("a population needs people", got=0, expected="one person or more")
    people = []
    for i, (group, source, number) in enumerate(wanted):
        person = _capture(salt, group, source, number)
        if person is not None:
            people.append(person)
        if progress:
            progress((i + 1) / len(wanted))
    return Population(tuple(people), {"salt": salt, "version": VERSION})


def _capture(salt: str, group: str, source: str, number: int) -> Capture | None:
    """Capture of a person; None for a person who is left out (`ORDERLY`, `BEYOND`)."""
    for what, value, known in (("group", group, GROUPS), ("source", source, SOURCES)):
        if value not in known:
            raise InputError(f"no such {what} of people", got=value, expected=", ".join(known))
    drawn = sha256(f"{VERSION} {salt} {group} {source} {number}".encode()).digest()
    seed = [int.from_bytes(drawn[k : k + 4], "big") for k in range(0, 16, 4)]
    capture = _of_source(seed, source, script=group == "train")
    if not _usual(capture):
        return None
    crossed = _crossed(capture)
    if crossed.mean() > (1.0 - ORDERLY) * (capture.down.sum(axis=1) > 3).mean():
        return None
    capture = capture.select(~crossed)
    who = {"group": group, "source": source, "number": number, "seed": seed}
    meta = {"simulated": True, "size": capture.meta["size"], "rate_hz": capture.meta["rate_hz"]}
    return Capture(capture.time, capture.trial, capture.ids, capture.xy, capture.q, {**who, **meta})


def _of_source(seed: list[int], source: str, *, script: bool) -> Capture:
    frames, rate = (SCRIPT, SCRIPT_RATE) if script else (PLAY, PLAY_RATE)
    day = 0 if script else 1
    if source == "first":
        return first_person(seed, frames, day, rate)
    if source == "second":
        return second_person(seed, frames, day, rate)
    return posed_people.capture_person(seed, POSTURES)


def _crossed(capture: Capture) -> NDArray[np.bool_]:
    """True (T,) for frames whose four or five touches are not in the fingers' order."""
    crossed = np.zeros(len(capture), bool)
    for count in (4, 5):
        frames = np.flatnonzero(capture.down.sum(axis=1) == count)
        xy = capture.xy[frames][capture.down[frames]].reshape(-1, count, 2)
        off = xy - xy.mean(axis=1, keepdims=True)
        angle = np.arctan2(off[..., 1], off[..., 0])
        # If the touches lie around their middle in the order of the fingers, the angle grows from
        # each finger to the next, except at one step.
        steps = np.roll(angle, -1, axis=1) > angle
        crossed[frames] = steps.sum(axis=1) != count - 1
    return crossed


def _usual(capture: Capture) -> bool:
    """True if a person's median distances between neighbouring fingers are like those of real
    people."""
    five = capture.xy[capture.down.all(axis=1)]
    if not len(five):
        return False
    apart = np.linalg.norm(np.diff(five, axis=1), axis=-1) / capture.meta["size"]
    least, middle, most = 1e-3 * np.array(NEIGHBOURS).T
    off = np.median(apart, axis=0) - middle
    return bool((np.abs(off) < BEYOND * np.where(off < 0, middle - least, most - middle)).all())


def _who(person: Capture) -> dict[str, Any]:
    return {key: person.meta[key] for key in ("group", "source", "number", "seed", "size")}


def save_population(population: Population, path: Path) -> None:
    """Writes a population as npz, in single precision."""
    people = population.people
    header = {
        "schema": SCHEMA,
        **population.meta,
        "digest": population.digest,
        "people": [person.meta for person in people],
    }
    arrays: dict[str, NDArray[Any]] = {
        "frames": np.array([len(person) for person in people]),
        "time": np.concatenate([p.time for p in people]).astype(np.float32),
        "trial": np.concatenate([p.trial for p in people]).astype(np.int32),
        "ids": np.concatenate([p.ids for p in people]).astype(np.int32),
        "xy": np.concatenate([p.xy for p in people]).astype(np.float32),
        "q": np.concatenate([p.q for p in people]).astype(np.float32),
    }
    write_npz(path, header, arrays)


def load_population(path: Path) -> Population:
    """Reads a population.

    Raises:
        CaptureError: The file is missing, cut short, damaged or of another version.
    """
    names = ("frames", "time", "trial", "ids", "xy", "q")
    remedy = "`python -m training people --out FILE` makes a valid one"
    header, arrays = read_npz(path, names, CaptureError, "a population", remedy)
    if header.get("schema") != SCHEMA or header.get("version") != VERSION:
        raise CaptureError(
            "the population has another version",
            where=str(path),
            got=f"schema {header.get('schema')}, version {header.get('version')}",
            expected=f"schema {SCHEMA}, version {VERSION}",
            remedy=remedy,
        )
    try:
        edges = np.cumsum(arrays["frames"])[:-1]
        parts = [np.split(arrays[name], edges) for name in names[1:]]
        people = tuple(
            Capture(
                time.astype(float),
                trial.astype(np.int64),
                ids.astype(np.int64),
                xy.astype(float),
                q.astype(float),
                dict(meta),
            )
            for time, trial, ids, xy, q, meta in zip(*parts, header["people"], strict=True)
        )
        population = Population(people, {"salt": str(header["salt"]), "version": VERSION})
        whole = population.digest == header["digest"]
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise CaptureError(
            "the population is damaged",
            where=str(path),
            got=f"{type(error).__name__}: {error}",
            remedy=remedy,
        ) from error
    if not whole:
        raise CaptureError(
            "the population's digest does not match its people", where=str(path), remedy=remedy
        )
    return population
