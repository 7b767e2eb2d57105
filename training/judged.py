"""Whom models are judged on: drawn people who stay the same, and the frozen simulated subjects.

People of the test are drawn with the digest of the shipped file of the labeller, so that they
cannot be chosen by hand. After new training, the digest would draw other people, and old and new
models could not be compared. Therefore the digest of the labeller of commit 3f5c89ca is fixed here,
with two groups of people: those on whom this labeller was judged, and the next people, who are not
used before new models are final.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

from encoders.capture import Capture
from encoders.captures.subject.subject import Progress, Subject, first_subject, json_values
from models.errors import EncoderError
from training.population.population import PEOPLE, simulate_population
from training.second_subject import FROZEN, SEED, simulate

SALT = "a3465088dba21f4cdb97f6d0598d0e0a"
"""Digest of the labeller that shipped when the people were fixed."""

JUDGED, NEXT = "judged", "next"
"""Groups of pinned people."""


def pinned_people(
    group: str = JUDGED,
    counts: Mapping[str, int] | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Capture, ...]:
    """Captures of the free play of pinned people.

    Args:
        group: `judged` or `next`.
        counts: Number of people that are drawn, by source; by default all pinned people. Some of
            them are left out, since their fingers touch unlike those of real people.
        progress: Called with the share done, 0 to 1.

    Raises:
        InputError: A source is unknown, or all counts are 0.
    """
    pinned = PEOPLE["judge"]
    counts = {source: n for source, n in (pinned if counts is None else counts).items() if n}
    first = {source: pinned[source] if group == NEXT else 0 for source in counts}
    return simulate_population(SALT, {"judge": counts}, progress, first=first).people


SUBJECTS = ("first", "second")
"""Names of the subjects. The name is a part of the digest that chooses a subject's judged days."""


@cache
def subject(name: str) -> Subject:
    """Finds a subject by name.

    Raises:
        EncoderError: The subject is unknown.
    """
    if name not in SUBJECTS:
        raise EncoderError("no such subject", got=name, expected=", ".join(SUBJECTS))
    return first_subject() if name == "first" else _second_subject()


def _second_subject() -> Subject:
    def day(number: int, progress: Progress | None = None) -> Capture:
        return simulate(FROZEN, SEED, number, progress)

    return Subject("second", SEED, json_values(FROZEN.as_json()), day)
