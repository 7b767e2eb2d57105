"""The report says what a full cycle takes, and which interactions a shorter one confounds."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from sandbox.study.design.design import Design
from sandbox.study.design.plan import session_plan, trials_of
from sandbox.study.report.models.data import StudyData, load_study
from sandbox.study.report.models.joint_order import confounded_pairs, design_orders
from sandbox.study.tables.codebook import codebook
from sandbox.study.tables.column import csv_bytes
from tests.support.study_files import DESIGN, design

SECOND = '\n[[factors]]\nname = "servo"\norder = "latin"\nlevels = ["orientation", "position"]\n'


@cache
def crossed() -> Design:
    """The design with a second factor."""
    return design(DESIGN.replace("[trials]", SECOND + "[trials]"))


def study(folder: Path, people: int) -> StudyData:
    """Tables of a study in which everybody did what the plan says."""
    rows = [
        {
            "ppid": f"P{number:02}",
            "trial_num": trial.number,
            "counted": 1,
            "practice": int(trial.practice),
            "excluded": 0,
            "success": 1,
            "time_s": 2.0,
            **{f"factor_{name}": level for name, level in trial.levels.items()},
        }
        for number in range(people)
        for trial in trials_of(session_plan(crossed(), number))
    ]
    (folder / "trial_results.csv").write_bytes(csv_bytes(rows, list(rows[0])))
    (folder / "codebook.csv").write_bytes(codebook(crossed()))
    return load_study(folder)


@pytest.mark.parametrize(("people", "even"), [(2, False), (3, False), (4, True), (8, True)])
def test_only_full_cycles_leave_no_interaction_confounded(
    tmp_path: Path, people: int, even: bool
) -> None:
    data = study(tmp_path, people)
    assert confounded_pairs(data) == ([] if even else [("contact", "servo")])
    assert design_orders(data).startswith("a full cycle of orders takes 4 participants")
