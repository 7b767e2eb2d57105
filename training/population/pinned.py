"""People to judge on who stay the same when models are trained anew.

People to judge on are drawn with the digest of the names that ship, so that nobody can choose them.
After new training that digest draws others, and old and new models would meet different people.
So the digest of the names of commit 3f5c89ca is pinned, with two groups of its people: those that
these names were judged on, and the next ones, whom nobody looks at before new models are frozen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from encoders.capture import Capture
from training.population.population import PEOPLE, simulate_population

SALT = "a3465088dba21f4cdb97f6d0598d0e0a"
"""Digest of the names that shipped when the people were pinned."""

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
        counts: People that are drawn, by source; by default as many as were pinned. Some are left
            out, as their fingers touch unlike real people's.
        progress: Called with the share done, 0 to 1.

    Raises:
        InputError: A source is unknown, or nobody is drawn.
    """
    pinned = PEOPLE["judge"]
    counts = {source: n for source, n in (pinned if counts is None else counts).items() if n}
    first = {source: pinned[source] if group == NEXT else 0 for source in counts}
    return simulate_population(SALT, {"judge": counts}, progress, first=first).people
