"""Formats numbers as text for people."""

from __future__ import annotations

from math import exp, isfinite

from sandbox.study.report.models.intervals import Estimate

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
    """A share in per cent, with one decimal near 0 and 100 %."""
    if not isfinite(share):
        return UNKNOWN
    value = 100.0 * share
    near = 0.0 < abs(value) < 5.0 or 95.0 < abs(value) < 100.0
    return f"{value:.1f} %" if near else f"{value:.0f} %"


def points(difference: float) -> str:
    """A difference of shares, in percentage points with a sign."""
    if not isfinite(difference):
        return UNKNOWN
    return f"{100.0 * difference:+.1f}".replace("-", "−")


def p_value(p: float) -> str:
    """A p value in the format of scientific journals."""
    if not isfinite(p):
        return UNKNOWN
    return "< 0.001" if p < 0.001 else f"{p:.3f}" if p < 0.1 else f"{p:.2f}"


def interval(low: str, high: str) -> str:
    """Both ends of an interval; a dash if one of them is unknown."""
    return UNKNOWN if UNKNOWN in (low, high) else f"{low} to {high}"


def change(log_ratio: float) -> str:
    """The logarithm of a ratio as a signed change in per cent."""
    if not isfinite(log_ratio):
        return UNKNOWN
    value = 100.0 * (exp(log_ratio) - 1.0)
    return f"{value:+.0f} %".replace("-", "−")


def less_or_more(e: Estimate, less: str, more: str) -> str:
    """The logarithm of a ratio as a change in words, such as `22 % less`."""
    value = 100.0 * (exp(e.value) - 1.0)
    return f"{abs(value):.0f} % {less if value < 0 else more}"


def count(n: int, one: str, many: str = "") -> str:
    """A number with its noun, in singular or plural."""
    return f"{n:,} {one if n == 1 else many or one + 's'}".replace(",", " ")
