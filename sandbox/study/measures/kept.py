"""Rows of the codebook about whole tables, and lines about measures that stay as recorded, because
a replay did not give the recorded states."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

ORDERS = "orders of the design"
"""Row of the codebook that says how many participants a full cycle of orders takes."""
WORDING = "wording of "
"""Begin of the rows of the codebook about questionnaires that have not the published wording."""
DIFFERS = "replay_differs"
"""Column of `trial_results.csv` with what differed in a trial's replay; empty if nothing did."""


def kept_lines(differs: Iterable[str]) -> list[str]:
    """One line for every cause for which measures of trials were kept.

    Args:
        differs: What differed, for every trial; empty if its measures are of the recorded states.
    """
    lines = []
    for cause, trials in Counter(filter(None, differs)).items():
        what = "1 trial stay" if trials == 1 else f"{trials} trials stay"
        lines.append(
            f"Measures of {what} as recorded, and measures added later are empty, because a replay "
            f"did not give the recorded states. What differs: {cause}"
        )
    return lines
