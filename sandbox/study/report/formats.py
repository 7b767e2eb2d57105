"""Formats numbers as text for readers of the report."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from sandbox.study.report.numbers import Estimate

UNKNOWN = "–"


def number(value: float, digits: int = 3) -> str:
    """A number with a given number of significant digits."""
    if not isfinite(value):
        return UNKNOWN
    text = f"{value:.{digits}g}"
    if "e" in text:
        return f"{value:.0f}" if 1.0 <= abs(value) < 1e6 else text
    return text.replace("-", "−")


def percent(share: float) -> str:
    """A share in percent, without the sign %, with one decimal near 0 and 100."""
    if not isfinite(share):
        return UNKNOWN
    value = 100.0 * share
    near = 0.0 < abs(value) < 5.0 or 95.0 < abs(value) < 100.0
    return f"{value:.1f}" if near else f"{value:.0f}"


def points(difference: float) -> str:
    """A difference of shares in percentage points, with a plus or minus sign."""
    if not isfinite(difference):
        return UNKNOWN
    return f"{100.0 * difference:+.1f}".replace("-", "−")


def p_value(p: float) -> str:
    """A p value in the format of scientific journals."""
    if not isfinite(p):
        return UNKNOWN
    return "< 0.001" if p < 0.001 else f"{p:.3f}" if p < 0.1 else f"{p:.2f}"


def estimate(e: Estimate, show: Callable[[float], str] = number, unit: str = "") -> str:
    """A value with its unit and its interval, such as `3.1 s (2.8 to 3.4)`."""
    value = show(e.value)
    told = value if value == UNKNOWN or not unit else f"{value} {unit}"
    return f"{told} ({show(e.low)} to {show(e.high)})" if e.is_known else told
