"""Intervals and p values of 200 random studies are those of R, to 1e-8."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.study.report.numbers import (
    EXACT,
    holm,
    interval,
    mann_whitney,
    paired_t,
    sign_flips,
    welch,
    wilcoxon,
)
from tests.sandbox.study.report.reference import FOUND, STUDIES, in_r, read, study

CLOSE = 1e-8
FROZEN = read(FOUND)


@pytest.mark.parametrize("seed", range(STUDIES))
def test_a_random_study_has_the_numbers_of_r(seed: int) -> None:
    drawn, row = study(seed), {k: float(v) for k, v in FROZEN[seed].items() if v}
    if drawn.kind == "groups":
        estimate, p = welch(drawn.first, drawn.second)
        ranked = mann_whitney(drawn.first, drawn.second)
    else:
        own = drawn.second - drawn.first
        estimate, p, ranked = interval(own), paired_t(own), wilcoxon(own)
        if len(own) <= EXACT:
            assert sign_flips(own) == pytest.approx(row["flips"], abs=CLOSE)
    wanted = [row[name] for name in ("estimate", "low", "high")]
    assert [estimate.value, estimate.low, estimate.high] == pytest.approx(wanted, abs=CLOSE)
    assert p == pytest.approx(row["t"], abs=CLOSE)
    if drawn.kind != "times" or len(set(np.abs(drawn.second - drawn.first))) == len(drawn.first):
        assert ranked == pytest.approx(row["ranks"], abs=CLOSE)
    if drawn.kind == "times":
        # The restricted mean of a survival curve is the mean of times cut at the limit.
        assert float(np.mean(drawn.second)) == pytest.approx(row["rmean"], abs=CLOSE)


def test_p_values_of_ten_studies_are_adjusted_as_by_r() -> None:
    for first in range(0, STUDIES, 10):
        rows = FROZEN[first : first + 10]
        adjusted = holm([float(row["t"]) for row in rows])
        assert adjusted == pytest.approx([float(row["holm"]) for row in rows], abs=CLOSE)


@pytest.mark.needs("r")
def test_r_computes_now_what_it_computed() -> None:
    for now, before in zip(in_r(), FROZEN, strict=True):
        assert list(now) == list(before)
        assert [float(x or "nan") for x in now.values()] == pytest.approx(
            [float(x or "nan") for x in before.values()], abs=CLOSE, nan_ok=True
        )
