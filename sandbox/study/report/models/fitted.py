"""The models of a study, each of which is fitted when it is first asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sandbox.study.report.models.answers import ScaleAnswers, item_scales, score_scales
from sandbox.study.report.models.censored import (
    Censored,
    censored_differences,
    fit_bounded,
    fit_censored,
)
from sandbox.study.report.models.comparisons import Difference
from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.interactions import (
    Dependence,
    model_dependences,
    share_dependences,
)
from sandbox.study.report.models.mixed import Mixed, fit_mixed, mixed_differences
from sandbox.study.report.models.quantities import (
    SHARE,
    Quantity,
    quantity,
    rows_for_model,
    rows_with,
)
from sandbox.study.report.models.success import ShareDifference, success_differences


@dataclass(frozen=True)
class Compared:
    """Comparisons of one measure.

    Attributes:
        model: The mixed model, or the reason why there is none; empty for shares.
        differences: Differences by the mixed model.
        shares: Differences of shares, for a measure of 0 and 1.
    """

    model: Mixed | str
    differences: list[Difference]
    shares: list[ShareDifference]


class Fitted:
    """Models of a study.

    Args:
        data: Data of the study.
        asked: Measures that are compared besides time and success.
    """

    def __init__(self, data: StudyData, asked: Sequence[Quantity]) -> None:
        self.data, self.asked = data, tuple(asked)
        self._compared: dict[str, Compared] = {}

    @cached_property
    def time(self) -> Quantity | None:
        """Completion time of successful trials; None without one."""
        used = self.data.used
        if not len(used) or not used["time_s"].notna().any():
            return None
        time = quantity(self.data, "time_s")
        return time if len(rows_with(self.data, time)[0]) else None

    @cached_property
    def censored(self) -> Censored | str:
        """The model of completion times that includes trials without success."""
        return fit_censored(self.data) if len(self.data.used) else "no trials are used"

    @cached_property
    def unseen(self) -> list[Difference]:
        """Differences by that model, in log time."""
        if isinstance(self.censored, str):
            return []
        return censored_differences(self.data, self.censored)

    @property
    def with_unseen(self) -> bool:
        """True if completion times are tested by the model that includes trials without success,
        since there are some; otherwise by the mixed model."""
        if not self.data.used["censored"].any():
            return False
        unseen = isinstance(self.censored, Censored) and self.censored.unseen > 0
        return unseen and len(self.unseen) > 0

    @cached_property
    def scores(self) -> list[ScaleAnswers]:
        """Scores of questionnaires."""
        return score_scales(self.data)

    @property
    def scales(self) -> list[ScaleAnswers]:
        """Scores, then single questions."""
        return [*self.scores, *item_scales(self.data)]

    @property
    def outcomes(self) -> list[str]:
        """Names of everything that can be tested: measures, and questionnaires for their scores."""
        measures = ["time_s", "success", *(what.name for what in self.asked)]
        return list(dict.fromkeys([*measures, *(s.questionnaire for s in self.scores if s.main)]))

    def compared(self, what: Quantity) -> Compared:
        """Comparisons of a measure."""
        if what.name not in self._compared:
            self._compared[what.name] = self._compare(what)
        return self._compared[what.name]

    def _compare(self, what: Quantity) -> Compared:
        if what.scale == SHARE:
            return Compared("", [], success_differences(self.data, what.name))
        rows, y = rows_for_model(self.data, what)
        model = fit_mixed(self.data, rows, y)
        some = [] if isinstance(model, str) else mixed_differences(self.data, rows, model)
        return Compared(model, some, [])

    def dependences(self, what: Quantity, factor: ObservedFactor) -> list[Dependence]:
        """Simple effects and interactions of a factor in a measure."""
        if what.scale == SHARE:
            return share_dependences(self.data, what.name, factor)
        if what.name == "time_s":
            model = self.censored
        else:
            rows, y = rows_for_model(self.data, what)
            model = fit_bounded(self.data, rows, y, np.ones(len(y), dtype=bool))
        return [] if isinstance(model, str) else model_dependences(self.data, model, factor)

    def pairs(self, outcome: str) -> Sequence[Difference | ShareDifference]:
        """The comparisons by which an outcome is tested; empty if there are none."""
        if not len(self.data.used):
            return []
        if outcome == "time_s":
            if self.with_unseen:
                return self.unseen
            return self.compared(self.time).differences if self.time else []
        asked = {what.name: what for what in self.asked}
        if outcome == "success" or outcome in asked:
            what = asked.get(outcome) or quantity(self.data, outcome)
            compared = self.compared(what)
            return compared.shares or compared.differences
        scores = (s for s in self.scores if s.main and s.questionnaire == outcome)
        return [difference for s in scores for difference in s.differences]
