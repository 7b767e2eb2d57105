"""People of the test who remain the same when models are trained again.

People of the test are drawn with the digest of the shipped file of the labeller, so that they
cannot be chosen by hand. After new training, the digest would draw other people, and old and new
models could not be compared. Therefore the digest of the labeller of commit 3f5c89ca is fixed here,
with two groups of people: those on whom this labeller was judged, and the next people, who are not
used before new models are final.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from encoders.capture import Capture
from training.population.population import PEOPLE, simulate_population

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
