"""The report says what a full cycle takes, and counts the places of levels in their orders."""

from __future__ import annotations

from collections import Counter
from functools import cache
from pathlib import Path

from sandbox.study.design.balance import confounded
from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import session_plan, trials_of
from sandbox.study.report.data import StudyData, load_study
from sandbox.study.tables.codebook import codebook, columns_by_table
from sandbox.study.tables.column import csv_bytes
from tests.support.study_files import DESIGN, design

SECOND = '\n[[factors]]\nname = "servo"\norder = "latin"\nlevels = ["orientation", "position"]\n'


@cache
def crossed() -> Design:
    """The design with a second factor."""
    return design(DESIGN.replace("[trials]", SECOND + "[trials]"))


def study(
    folder: Path, people: int, made: Design | None = None, left_out: tuple[str, int] | None = None
) -> StudyData:
    """Tables of a study in which everybody did what the plan says; `left_out` excludes trials of
    the person with this number at this level of `contact`."""
    made = made or crossed()
    rows = [
        {
            "ppid": f"P{number:02}",
            "trial_num": trial.number,
            "counted": 1,
            "practice": int(trial.practice),
            "excluded": int((trial.levels["contact"], number) == left_out),
            "repetition": trial.repetition,
            "success": 1,
            "time_s": 2.0,
            **{f"factor_{name}": level for name, level in trial.levels.items()},
        }
        for number in range(1, people + 1)
        for trial in trials_of(session_plan(made, number))
    ]
    (folder / "tables").mkdir(parents=True, exist_ok=True)
    (folder / "tables/trials.csv").write_bytes(csv_bytes(rows, list(rows[0])))
    (folder / "tables/codebook.csv").write_bytes(codebook(made, columns_by_table(made)))
    return load_study(folder)


def test_a_report_says_what_a_full_cycle_takes(tmp_path: Path) -> None:
    assert study(tmp_path, 2).orders.startswith("a full cycle of orders takes 4 participants")


def often(data: StudyData, name: str) -> dict[tuple[str, int], int]:
    """How often each level of a factor was at each place of an order of its own."""
    factor = data.factor(name)
    outer = [f.column for f in data.factors[: data.factors.index(factor)]]
    columns = ["ppid", *outer, factor.round, factor.column, factor.place]
    seen = data.used[columns].drop_duplicates()
    return dict(Counter(zip(seen[factor.column], seen[factor.place], strict=True)))


def test_levels_that_come_back_in_rounds_have_a_place_in_every_round(tmp_path: Path) -> None:
    text = DESIGN.replace("[trials]", SECOND + '[trials]\nrepeat_inside = "contact"')
    rounds = design(text)
    data = study(tmp_path, 3, rounds)
    both = "orientation", "position"
    assert often(data, "servo") == {(level, place): 6 for level in both for place in (1, 2)}
    # Orders of `contact` are not even among three people, those of `servo` inside are.
    assert [line.split(":")[0] for line in confounded(rounds, 3)] == ["contact with practice"]


def test_an_excluded_level_was_practice_for_the_one_after_it(tmp_path: Path) -> None:
    whole = often(study(tmp_path, 4), "contact")
    assert set(whole.values()) == {2}
    data = study(tmp_path, 4, left_out=("hard", 1))
    lost = {key: whole[key] - n for key, n in often(data, "contact").items()}
    # Level `soft` stays at its place, which is the second one for this person.
    assert lost == {("hard", 1): 1, ("hard", 2): 0, ("soft", 1): 0, ("soft", 2): 0}
