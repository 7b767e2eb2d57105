"""Numbers as people read them."""

from __future__ import annotations

from math import exp, isfinite

from sandbox.study.report.models.intervals import Estimate

UNKNOWN = "–"


def number(value: float, digits: int = 3) -> str:
    """With so many digits that mean something."""
    if not isfinite(value):
        return UNKNOWN
    text = f"{value:.{digits}g}"
    if "e" in text:
        return f"{value:.0f}" if 1.0 <= abs(value) < 1e6 else text
    # 4.50 and 4.5 are equally exact here.
    return text.replace("-", "−")


def percent(share: float) -> str:
    """A share, in per cent; a tenth where it is small or nearly all."""
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
    """Text of a value in the format of journals."""
    if not isfinite(p):
        return UNKNOWN
    return "< 0.001" if p < 0.001 else f"{p:.3f}" if p < 0.1 else f"{p:.2f}"


def interval(low: str, high: str) -> str:
    """Both ends; one sign where neither is known."""
    return UNKNOWN if UNKNOWN in (low, high) else f"{low} to {high}"


def change(log_ratio: float) -> str:
    """A ratio as a change in per cent with a sign."""
    if not isfinite(log_ratio):
        return UNKNOWN
    value = 100.0 * (exp(log_ratio) - 1.0)
    return f"{value:+.0f} %".replace("-", "−")


def less_or_more(e: Estimate, less: str, more: str) -> str:
    """A change in per cent in words: `22 % less`, from logarithms of ratios."""
    value = 100.0 * (exp(e.value) - 1.0)
    return f"{abs(value):.0f} % {less if value < 0 else more}"


def count(n: int, one: str, many: str = "") -> str:
    """A number with its word."""
    return f"{n:,} {one if n == 1 else many or one + 's'}".replace(",", " ")
