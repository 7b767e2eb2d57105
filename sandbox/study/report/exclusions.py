"""The steps from all data to the data that the report uses, and notes on the remaining data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sandbox.study.report.data import StudyData, to_numbers

if TYPE_CHECKING:
    from pandas import DataFrame

MORE = {"real": "", "pilot": "--pilot "}
"""Kinds of data whose sessions `sandbox study run` resumes, with the option for each kind."""


@dataclass(frozen=True)
class FlowStep:
    """A step in the flow from all data to the used data.

    Attributes:
        what: Description of the removed or remaining data.
        participants: Number of removed or remaining participants. A participant is removed with
            their last trial.
        trials: Number of removed or remaining trials.
        remains: True for remaining data, False for removed data.
    """

    what: str
    participants: int
    trials: int
    remains: bool = False


def flow(data: StudyData) -> list[FlowStep]:
    """Steps from all finished attempts to the used trials."""
    trials = data.trials
    steps = [FlowStep("began", len(data.people), 0, True)]
    if refused := len(_without_consent(data)):
        steps.append(FlowStep("did not consent", refused, 0))
    steps += [FlowStep("finished attempts", trials["ppid"].nunique(), len(trials), True)]
    rest = trials
    for what, gone in (
        ("replaced by a later attempt", trials["counted"] != 1),
        ("practice", trials["practice"] == 1),
    ):
        rest = _take(steps, rest, rest[gone.reindex(rest.index)], what)
    steps.append(FlowStep("trials that count", rest["ppid"].nunique(), len(rest), True))
    reasons = rest.get("exclusion_reason")
    excluded = rest["excluded"] == 1
    if reasons is None:
        rest = _take(steps, rest, rest[excluded], "excluded")
    else:
        for reason in dict.fromkeys(rest.loc[excluded, "exclusion_reason"]):
            mine = rest[(rest["excluded"] == 1) & (rest["exclusion_reason"] == reason)]
            rest = _take(steps, rest, mine, f"excluded, {reason or 'without a reason'}")
    rest = _take(steps, rest, rest[~rest["success"].isin([0, 1])], "without a result")
    steps.append(FlowStep("used here", rest["ppid"].nunique(), len(rest), True))
    return steps


def _take(steps: list[FlowStep], rest: DataFrame, gone: DataFrame, what: str) -> DataFrame:
    left = rest.drop(gone.index)
    if len(gone):
        lost = rest["ppid"].nunique() - left["ppid"].nunique()
        steps.append(FlowStep(what, lost, len(gone)))
    return left


def unfinished(data: StudyData) -> list[str]:
    """Participants who did not decline to consent and have not finished all sessions.

    Empty if the table does not have the column `complete`.
    """
    if "complete" not in data.people.columns:
        return []
    done = to_numbers(data.people["complete"])
    without = _without_consent(data)
    return [str(p) for p in data.people.loc[done != 1, "ppid"] if p not in without]


def _without_consent(data: StudyData) -> set[str]:
    """Participants who declined to consent, and thus have no data and no open sessions."""
    if "consent" not in data.people.columns:
        return set()
    return set(data.people.loc[to_numbers(data.people["consent"]) == 0, "ppid"])


def gaps(data: StudyData) -> list[str]:
    """Sentences on sessions that are not finished, and on trials that were skipped."""
    missing, told = unfinished(data), []
    if missing:
        told.append(f"Not finished yet: {', '.join(missing)}. Their finished trials are used.")
        if data.mode in MORE:
            run = f"sandbox study run DESIGN {MORE[data.mode]}--participant {missing[0]}"
            told.append(f"`{run}` resumes the session of that person.")
    counts = ("trials_planned", "trials_done")
    if "complete" in data.people.columns and set(counts) <= set(data.people.columns):
        whole = data.people.loc[to_numbers(data.people["complete"]) == 1]
        planned, done = (to_numbers(whole[name]) for name in counts)
        skipped = [
            f"{person} {int(n)}"
            for person, n in zip(whole["ppid"], planned - done, strict=True)
            if n > 0
        ]
        if skipped:
            told.append(
                f"Trials that were skipped, practice included: {', '.join(skipped)}. They have no "
                "row in trials.csv."
            )
    return told


def unbalanced_states(data: StudyData) -> str:
    """Sentence on conditions that were not run equally often by each version of the simulation.

    Empty if one version ran all trials, or if each version ran all conditions equally often.
    """
    if "states" not in data.used or not len(data.used):
        return ""
    counts = data.used.groupby([to_numbers(data.used["states"]), "condition"]).size().unstack()
    if len(counts) < 2 or (counts.nunique(axis=1, dropna=False) == 1).all():
        return ""
    return (
        f"Trials were run by {len(counts)} versions of the simulation (`states` "
        f"{', '.join(f'{n:g}' for n in counts.index)}), and not all conditions equally often by "
        "each version: a difference between conditions may be one between programs."
    )


def endings(data: StudyData) -> dict[str, dict[str, int]]:
    """Numbers of used trials by condition and status at their end.

    Conditions of the design without used trials are included.
    """
    used = data.used
    if "status" not in used.columns:
        status = used["success"].map({1.0: "success", 0.0: "no success"})
    else:
        status = used["status"].mask(used["success"] == 1, "success")
        status = status.mask((status == "") | (status == "held"), "no success")
    kinds = ["success", *sorted(set(status) - {"success"})]
    table = {name: dict.fromkeys(kinds, 0) for name in (*data.conditions, *data.unused_conditions)}
    for name, kind in zip(used["condition"], status, strict=True):
        table[name][kind] += 1
    return table
