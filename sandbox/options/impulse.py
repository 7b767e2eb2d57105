"""Option `--impulse`: the limit of every servo, as a profile's name or a number."""

from __future__ import annotations

from models.errors import unknown_name
from models.hand import IMPULSE_PROFILES


def impulse_limit(text: str) -> float:
    """Returns the impulse limit in N s per 1/60 s.

    Raises:
        InputError: The text is neither a profile nor a positive number.
    """
    if text in IMPULSE_PROFILES:
        return IMPULSE_PROFILES[text]
    try:
        value = float(text)
        if not 0 < value < float("inf"):
            raise ValueError
    except ValueError:
        others = "a positive number of N s per 1/60 s"
        raise unknown_name(
            "not an impulse limit", text, IMPULSE_PROFILES, where="--impulse", others=others
        ) from None
    return value
