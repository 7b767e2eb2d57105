"""Comparison of a run with its baseline, seed by seed.

Two trials with the same seed, one in the baseline and one in the run, are a pair. Success is
compared by McNemar's test. Time and the other measures are compared by the signed ranks of their
differences. Only success and time decide whether the run passes.

A run has one or two arms: `plain` has the tasks as they are, `hard` has them with a variation that
makes them harder. Success and time are tested for each task in each arm. In an arm with several
tasks, they are also tested for all its tasks together. The p values of all these tests are adjusted
together by Holm's procedure.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from math import expm1, isfinite
from statistics import fmean
from typing import TYPE_CHECKING, Any

from sandbox.recording.versions import differing_parts
from sandbox.regress import statistics
from sandbox.regress.compared_measures import DECIDING, MEASURES, SUCCESS, TIME, pairs
from sandbox.regress.execute import CRASHED, Trial
from sandbox.regress.run_plan import arm_of, row_name, setting_of

if TYPE_CHECKING:
    from sandbox.regress.baseline import Baseline, BaselineTask

TOGETHER = "all tasks"
"""Name in lists of changes for all tasks of the plain arm together."""


def together_name(row: str) -> str:
    """Name of all tasks of a row's arm together: `all tasks`, `all tasks (hard)`."""
    return row_name(TOGETHER, arm_of(row))


@dataclass(frozen=True)
class Change:
    """Change of a measure over the seeds that both runs have; positive changes are worse.

    Attributes:
        measure: Name of the measure.
        pairs: Number of seeds with a value before and now.
        before, now: Means.
        change, low, high: Typical change and its interval (`statistics.typical_change`). For time
            it is a share of the value before. For success it is the mean difference, with its own
            interval (`statistics.mean_change`). For other measures it is a difference.
        p_loss, p_gain: P values of both one-sided tests, adjusted by Holm's procedure.
        most: Seeds with the largest losses, the largest first, with the values before and now.
        margin: Largest change that is not reported as a loss or gain, in the unit of `change`.
        decides: True if a loss makes the run fail.
    """

    measure: str
    pairs: int
    before: float
    now: float
    change: float
    low: float
    high: float
    p_loss: float
    p_gain: float
    most: tuple[tuple[int, float, float], ...] = ()
    margin: float = 0.0
    decides: bool = False

    @property
    def is_loss(self) -> bool:
        """True if a deciding measure is significantly worse, by more than its margin."""
        return self.decides and self.p_loss <= statistics.GATE and self.change > self.margin

    @property
    def is_gain(self) -> bool:
        """True if a deciding measure is significantly better, by more than its margin."""
        return self.decides and self.p_gain <= statistics.GATE and -self.change > self.margin

    @property
    def moved(self) -> bool:
        """True if the measure has changed significantly, in either direction."""
        return min(self.p_loss, self.p_gain) <= statistics.GATE / 2.0

    def text(self) -> str:
        """The change in words, such as `time 12.3 % longer (8.1 to 16.7), p = 0.0004`."""
        p = f"p = {min(self.p_loss, self.p_gain):.2g}"
        worse = self.change > 0
        if self.measure == SUCCESS:
            how = "fewer" if worse else "more"
            now, before = 100.0 * self.now, 100.0 * self.before
            points = f"{abs(100 * self.change):.1f} points"
            return f"{points} {how} succeed ({now:.0f} %, were {before:.0f} %), {p}"
        if self.measure == TIME:
            low, high = (self.low, self.high) if worse else (-self.high, -self.low)
            how = "longer" if worse else "shorter"
            return (
                f"time {abs(100 * self.change):.1f} % {how} "
                f"({100 * low:.1f} to {100 * high:.1f} %), {p}"
            )
        unit = f" {MEASURES[self.measure].unit}" if MEASURES[self.measure].unit else ""
        return f"{self.measure} {self.now:.3g}{unit}, was {self.before:.3g}{unit}"

    def as_json(self) -> dict[str, Any]:
        """JSON values."""
        return {
            "pairs": self.pairs,
            "before": self.before,
            "now": self.now,
            "change": self.change,
            "low": self.low if isfinite(self.low) else None,
            "high": self.high if isfinite(self.high) else None,
            "p_loss": self.p_loss,
            "p_gain": self.p_gain,
            "moved": self.moved,
            "loss": self.is_loss,
            "gain": self.is_gain,
            "most": [
                {"seed": seed, "before": before, "now": now} for seed, before, now in self.most
            ],
        }


@dataclass(frozen=True)
class Comparison:
    """Comparison of a task with its baseline, seed by seed.

    Attributes:
        both, lost, won, neither: Seeds that succeeded in both runs, only before, only now, and in
            neither run.
        changed: Seeds with different states although the fingerprints are equal.
        same_machine: Number of pairs with equal fingerprints. Their states are compared. 0 if
            states are not compared, because the baseline was made with another number `STATES` or
            with other models.
        elsewhere: For pairs with different fingerprints, the differing parts, in words.
        crashed: Number of pairs whose trial crashed now.
        unpaired: Seeds of the run that are not in the baseline.
        progress: Mean progress now minus mean progress before.
        changes: Changes of the measures, by name.
    """

    both: list[int] = field(default_factory=list)
    lost: list[int] = field(default_factory=list)
    won: list[int] = field(default_factory=list)
    neither: list[int] = field(default_factory=list)
    changed: list[int] = field(default_factory=list)
    same_machine: int = 0
    elsewhere: tuple[str, ...] = ()
    crashed: int = 0
    unpaired: list[int] = field(default_factory=list)
    progress: float = 0.0
    changes: Mapping[str, Change] = field(default_factory=dict)

    @property
    def pairs(self) -> int:
        """Seeds that both runs have."""
        return len(self.both) + len(self.lost) + len(self.won) + len(self.neither)

    @property
    def significant(self) -> bool:
        """True if success or time is significantly worse, by more than its margin."""
        return any(change.is_loss for change in self.changes.values())

    def as_json(self, level: float) -> dict[str, Any]:
        """JSON values, with the smallest drop of success that this number of pairs can detect.

        The drop is computed twice: as if no seed were won, and with the share of won seeds in this
        comparison.

        Args:
            level: Largest p value that counts as a loss; see `level_of`.
        """
        churn = len(self.won) / self.pairs if self.pairs else 0.0
        return {
            "pairs": self.pairs,
            "both": len(self.both),
            "lost": self.lost,
            "won": self.won,
            "neither": len(self.neither),
            "without_baseline": self.unpaired,
            "measures": {name: change.as_json() for name, change in self.changes.items()},
            "significant_loss": self.significant,
            "progress_change": self.progress,
            "same_machine": self.same_machine,
            "elsewhere": list(self.elsewhere),
            "changed_states": self.changed,
            "fewest_losses": statistics.fewest_losses(level),
            "noticeable_drop": statistics.noticeable_drop(self.pairs, 0.0, level),
            "noticeable_drop_with_this_churn": statistics.noticeable_drop(self.pairs, churn, level),
        }


def compared(
    tasks: Mapping[str, Sequence[Trial]],
    baseline: Baseline,
    limits: Mapping[str, float],
    margins: Mapping[str, float],
    states: bool,
) -> tuple[dict[str, Comparison], dict[str, dict[str, Change]]]:
    """Compares a run with a baseline.

    Returns:
        Comparisons by task; and for each arm with several tasks, the changes over all its tasks, by
        the arm's name.

    Args:
        tasks: Trials of the run by task.
        baseline: The baseline. A task is left out if it is missing in the baseline, or if its
            variation in the hard arm has changed since.
        limits: s, time limits by task.
        margins: For each deciding measure, the largest change, as a share, that is not reported as
            a loss or gain.
        states: True compares states.
    """
    found: dict[str, Comparison] = {}
    rows: dict[str, dict[str, list[tuple[int, float, float]]]] = {}
    for name, trials in tasks.items():
        if name not in baseline.tasks or baseline.tasks[name].vary != setting_of(name):
            continue
        comparison = _paired(trials, baseline.tasks[name], states)
        if not comparison.pairs:
            continue
        before = {seed: trial.values() for seed, trial in baseline.tasks[name].trials.items()}
        now = {trial["seed"]: {"measures": {}, **trial} for trial in trials}
        rows[name] = {m: list(pairs(m, before, now, limits[name])) for m in MEASURES}
        changes = {m: _change(m, [some], margins) for m, some in rows[name].items() if some}
        found[name] = replace(comparison, changes=changes)
    together = {
        name: {m: _change(m, [rows[row][m] for row in own], margins) for m in DECIDING}
        for name, own in groups(found).items()
    }
    return _adjusted(found, together)


def groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Rows of each arm with several rows, by the arm's name. They are also tested together."""
    found: dict[str, list[str]] = {}
    for name in names:
        found.setdefault(together_name(name), []).append(name)
    return {name: own for name, own in found.items() if len(own) > 1}


def level_of(names: Collection[str]) -> float:
    """Largest p value that counts as a loss at the strictest step of Holm's procedure.

    Args:
        names: Names of the rows. Deciding measures are tested in each row, and in each arm with
            several rows.
    """
    return statistics.GATE / (len(DECIDING) * max(len(names) + len(groups(names)), 1))


def lacking_measures(
    tasks: Mapping[str, Sequence[Trial]], baseline: Baseline, comparisons: Iterable[str]
) -> bool:
    """True if a run has measures that the compared trials of the baseline do not have."""
    return any(
        any(trial.get("measures") for trial in tasks[name])
        and not any(trial.measures for trial in baseline.tasks[name].trials.values())
        for name in comparisons
    )


def _change(
    measure: str,
    samples: Sequence[Sequence[tuple[int, float, float]]],
    margins: Mapping[str, float],
) -> Change:
    """Change of a measure over the pairs of one or more tasks; p values are not adjusted."""
    kind = MEASURES[measure]
    by_task = [[kind.change(before, now) for _, before, now in rows] for rows in samples]
    rows, worse = list(chain(*samples)), list(chain(*by_task))
    change, low, high = statistics.typical_change(*by_task)
    if measure == SUCCESS:
        change, low, high = statistics.mean_change(worse)
        lost, won = sum(w > 0 for w in worse), sum(w < 0 for w in worse)
        p_loss, p_gain = statistics.mcnemar(lost, won), statistics.mcnemar(won, lost)
    else:
        p_loss = statistics.signed_rank(*by_task)
        p_gain = statistics.signed_rank(*([-w for w in some] for some in by_task))
    if kind.relative:
        change, low, high = expm1(change), expm1(low), expm1(high) if isfinite(high) else high
    order = sorted(range(len(rows)), key=lambda i: -worse[i])
    return Change(
        measure,
        len(rows),
        fmean(before for _, before, _ in rows),
        fmean(now for _, _, now in rows),
        change,
        low,
        high,
        p_loss,
        p_gain,
        tuple(rows[i] for i in order[:_MOST] if worse[i] > 0.0),
        margins.get(measure, 0.0),
        measure in DECIDING,
    )


_MOST = 5
"""Largest number of seeds that are listed for a change."""


def _adjusted(
    found: dict[str, Comparison], together: dict[str, dict[str, Change]]
) -> tuple[dict[str, Comparison], dict[str, dict[str, Change]]]:
    """The same changes with p values adjusted by Holm's procedure.

    All tests of deciding measures are adjusted together. The tests of each other measure are
    adjusted separately.
    """
    places = {(name, m): c for name, f in found.items() for m, c in f.changes.items()}
    places |= {(name, m): c for name, some in together.items() for m, c in some.items()}
    families: list[list[tuple[str, str]]] = [[at for at in places if at[1] in DECIDING]]
    families += [[at for at in places if at[1] == m] for m in MEASURES if m not in DECIDING]
    new: dict[tuple[str, str], Change] = {}
    for family in families:
        loss = statistics.holm({at: places[at].p_loss for at in family})
        gain = statistics.holm({at: places[at].p_gain for at in family})
        new |= {at: replace(places[at], p_loss=loss[at], p_gain=gain[at]) for at in family}
    return (
        {
            name: replace(f, changes={m: new[name, m] for m in f.changes})
            for name, f in found.items()
        },
        {name: {m: new[name, m] for m in some} for name, some in together.items()},
    )


def _paired(trials: Iterable[Trial], task: BaselineTask, states: bool) -> Comparison:
    """Comparison of a task's trials with the baseline, without changes of measures.

    Args:
        trials: Trials of the run.
        task: The task in the baseline.
        states: True compares states.
    """
    c = Comparison()
    same, crashed, changes = 0, 0, []
    elsewhere: dict[str, None] = {}
    for trial in trials:
        seed = trial["seed"]
        before = task.trials.get(seed)
        if before is None:
            c.unpaired.append(seed)
            continue
        kinds = {(True, True): c.both, (True, False): c.lost, (False, True): c.won}
        kinds.get((before.success, trial["success"]), c.neither).append(seed)
        changes.append(trial["progress"] - before.progress)
        crashed += trial["status"] == CRASHED
        if not states:
            continue
        if task.fingerprint and trial["fingerprint"] == task.fingerprint:
            same += 1
            if trial["state_hash"] != before.state_hash:
                c.changed.append(seed)
        elif trial["status"] != CRASHED and task.depends_on:
            elsewhere |= dict.fromkeys(differing_parts(task.depends_on, trial["depends_on"]))
    return replace(
        c,
        same_machine=same,
        elsewhere=tuple(elsewhere),
        crashed=crashed,
        progress=fmean(changes) if changes else 0.0,
    )
