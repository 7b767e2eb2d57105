"""People who come several times: other orders, nothing mixed, and nobody begins in the middle."""

from __future__ import annotations

import io
import shutil
from collections import Counter
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.study.design.balance import balanced_latin_square
from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import (
    ConsentStep,
    FormStep,
    TrialStep,
    session_plan,
    trials_of,
)
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.record.trial_files import find_recordings
from sandbox.study.report.data import load_study
from sandbox.study.run.simulated_study import run_simulated, simulate
from sandbox.study.tables.tables import make_tables
from tests.support.study_files import FIRST, SECOND, TWICE, design, pilot, quiet, rows_of

CROSSED = """
name = "crossed"
seed = 5
sessions = SESSIONS
[[factors]]
name = "contact"
order = "latin"
levels = ["hard", "soft"]
[[factors]]
name = "task"
order = "ORDER"
levels = ["box-to-goal", "stack", "wrench-turn"]
[trials]
repetitions = 2
seeds = "SEEDS"
"""


def crossed(sessions: int, order: str = "latin", seeds: str = "own", more: str = "") -> Design:
    text = CROSSED.replace("SESSIONS", str(sessions)).replace("ORDER", order)
    return design(
        text.replace("SEEDS", seeds).replace('order = "latin"', 'order = "latin"' + more, 1)
    )


def trials(plan: Design, person: int, session: int) -> list[TrialStep]:
    return trials_of(session_plan(plan, person, session))


def order(steps: list[TrialStep], factor: str) -> list[str]:
    levels = [step.levels[factor] for step in steps]
    return [x for i, x in enumerate(levels) if i == 0 or x != levels[i - 1]]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made")
    simulate(StudyFolder(out, design(TWICE), SIMULATED), 2, False, quiet)
    return out


@pytest.fixture
def study(made: Path, tmp_path: Path) -> StudyFolder:
    shutil.copytree(made, tmp_path / "a")
    return StudyFolder(tmp_path / "a", design(TWICE), SIMULATED)


@pytest.mark.parametrize("rule", ["latin", "random", "blocked", "factorial", "between"])
def test_the_first_of_several_sessions_is_the_one_of_people_who_come_once(rule: str) -> None:
    once, twice = crossed(1, rule), crossed(2, rule)
    assert all(session_plan(once, n) == session_plan(twice, n, 1) for n in range(1, 7))


def test_in_a_later_session_every_factor_has_the_next_one_of_its_orders() -> None:
    plan, squares = crossed(3), {"contact": 2, "task": 3}
    for person in range(1, 7):
        for factor, count in squares.items():
            names = [x.name for f in plan.factors if f.name == factor for x in f.levels]
            orders = [[names[i] for i in row] for row in balanced_latin_square(count)]
            first, *later = (
                orders.index(order(trials(plan, person, session), factor)[:count])
                for session in (1, 2, 3)
            )
            assert later == [(first + 1) % len(orders), (first + 2) % len(orders)]


def test_one_level_a_session_spreads_a_factor_over_sessions_in_balanced_order() -> None:
    plan = crossed(2, more="\none_a_session = true")
    of = {
        (n, s): {t.levels["contact"] for t in trials(plan, n, s)}
        for n in range(1, 7)
        for s in (1, 2)
    }
    assert all(len(levels) == 1 for levels in of.values())
    assert all(of[n, 1] | of[n, 2] == {"hard", "soft"} for n in range(1, 7))
    assert Counter(*[[min(of[n, 1]) for n in range(1, 7)]]) == {"hard": 3, "soft": 3}


def test_consent_and_questions_about_the_person_come_once_and_the_rest_where_it_was_asked() -> None:
    text = TWICE.replace('at = "contact"\n', 'at = "contact"\nsessions = [2]\n')
    plans = [session_plan(design(text), 1, s) for s in (1, 2)]
    asked = [[s.form.name for s in plan if isinstance(s, FormStep)] for plan in plans]
    assert asked == [["demographics"], ["effort", "effort"]]
    assert [any(isinstance(s, ConsentStep) for s in plan) for plan in plans] == [True, False]
    assert [sum(t.practice for t in trials_of(plan)) for plan in plans] == [2, 0]


def test_both_sessions_have_folders_and_rows_of_their_own(study: StudyFolder) -> None:
    rows = rows_of(study.path / "tables/trials.csv")
    for person in study.participants():
        mine = [r for r in rows if r["participant"] == person.ppid]
        assert Counter(r["session"] for r in mine) == {"1": FIRST, "2": SECOND}
        assert len({(r["session"], r["trial"]) for r in mine}) == FIRST + SECOND
        for row in mine:
            where = f"{person.ppid}/S00{row['session']}/"
            assert row["recording"].startswith(where)
            assert (study.path / row["recording"]).exists()
        assert len(find_recordings(person.ppid, study.path)) == FIRST + SECOND
        assert len({r["state_hash"] for r in mine}) == len({r["seed"] for r in mine})
    people = rows_of(study.path / "tables/participants.csv")
    assert [
        (r["sessions_done"], r["trials_done"], r["trials_planned"], r["complete"], r["consent"])
        for r in people
    ] == 2 * [("2", "6", "6", "1", "1")]
    assert all(r["age"] for r in people)


def test_nobody_begins_with_the_second_session_or_comes_too_often(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path, design(TWICE), SIMULATED)
    person = study.add()
    with pytest.raises(StudyError, match="session 1 comes first"):
        SessionFolder(study, person, 2)
    SessionFolder(study, person).close()
    with pytest.raises(StudyError, match="session 1 comes first"):
        SessionFolder(study, person, 2)
    for number in (0, 3):
        with pytest.raises(StudyError, match="no session of this number"):
            SessionFolder(study, person, number)
    assert not session_path(study.path, person.ppid, 2).exists()


def test_a_first_session_in_the_place_of_a_second_is_refused(study: StudyFolder) -> None:
    person = study.participants()[0]
    shutil.rmtree(session_path(study.path, person.ppid, 2))
    shutil.copytree(session_path(study.path, person.ppid), session_path(study.path, person.ppid, 2))
    with pytest.raises(StudyError, match="another study, participant or session"):
        SessionFolder(study, person, 2)


def test_who_is_excluded_in_one_session_is_left_out_in_all(study: StudyFolder) -> None:
    first, second = study.participants()
    with SessionFolder(study, first, 2) as session:
        session.command("exclude", durable=True, trial=None, reason="fell asleep")
    make_tables(study)
    for row in rows_of(study.path / "tables/trials.csv"):
        gone = row["participant"] == first.ppid
        assert row["excluded"] == str(int(gone))
        assert row["exclusion_reason"] == ("participant: fell asleep" if gone else "")
    assert [r["excluded"] for r in rows_of(study.path / "tables/participants.csv")] == ["1", "0"]
    assert second.ppid != first.ppid


def test_a_rule_about_people_waits_for_their_last_session(tmp_path: Path) -> None:
    rule = '[[exclusions]]\nname = "all"\nof = "participant"\nmeasure = "time_s"\nabove = 0.0\n'
    study = StudyFolder(tmp_path, design(TWICE + rule), SIMULATED)
    run_simulated(study, 1, quiet)
    reasons = {r["exclusion_reason"] for r in rows_of(study.path / "tables/trials.csv")}
    assert reasons == {"participant: rule all"}
    shutil.rmtree(session_path(study.path, study.participants()[0].ppid, 2))
    make_tables(study)
    assert {r["excluded"] for r in rows_of(study.path / "tables/trials.csv")} == {"0"}


def test_places_of_a_questionnaire_count_on_over_all_sessions(tmp_path: Path) -> None:
    used = {"sus": "sus", "nasa-tlx-raw": "workload-raw"}  # questionnaires and their scores
    asked = (f'[[questionnaires]]\nuse = "{use}"\nat = "contact"\n' for use in used)
    text = "\n".join((TWICE, *asked))
    study = StudyFolder(tmp_path, design(text), SIMULATED)
    simulate(study, 2, False, quiet)
    rows = rows_of(study.path / "tables/scores.csv")
    people = {r["participant"] for r in rows}
    assert len(people) == 2
    for person in people:
        for use, scale in used.items():
            mine = [
                (r["place"], r["session"])
                for r in rows
                if (r["participant"], r["instrument"], r["scale"]) == (person, use, scale)
            ]
            assert mine == [("1", "1"), ("2", "1"), ("3", "2"), ("4", "2")]


def test_a_report_compares_sessions_where_people_did_the_same_in_both(made: Path) -> None:
    data = load_study(made / "quick-simulated")
    assert [f.name for f in data.factors] == ["session", "contact"]
    assert data.factor("session").levels == ("session 1", "session 2")
    assert data.factor("session").within and len(data.conditions) == 4
    # What was learned from the first session to the second is the difference between them.
    assert list(data.used.groupby("ppid")["position"].max()) == [2, 2]


def test_a_report_does_not_compare_sessions_that_had_levels_of_their_own(tmp_path: Path) -> None:
    text = TWICE.replace('order = "latin"', 'order = "latin"\none_a_session = true')
    study = StudyFolder(tmp_path, design(text), SIMULATED)
    simulate(study, 2, False, quiet)
    data = load_study(study.path)
    assert [f.name for f in data.factors] == ["contact"] and data.factors[0].within


def test_the_command_begins_the_next_session_and_refuses_what_is_not_its_turn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "design.toml").write_text(TWICE)
    monkeypatch.chdir(Path(__file__).parents[3])
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    run = [*pilot(tmp_path / "design.toml"), "--forms", "page", "--participant"]
    assert main([*run, "new", "--session", "2"]) == 2
    assert "begins with session 1" in capsys.readouterr().err
    study = StudyFolder(tmp_path, design(TWICE), "pilot")
    assert not study.participants()
    run_simulated(study, 1, quiet)
    person = study.participants()[0].ppid
    # What is complete has nothing left to do.
    assert main([*run, person, "--session", "2"]) == 0
    assert f"{person}, session 2 of 2: complete" in capsys.readouterr().out
    assert study.participants()[0].hand == "right"
    for wrong, told in (
        (["--session", "3"], "no session of this number"),
        (["--hand", "left"], "stays for all sessions"),
        (["--hand", "right", "--hand-size", "1.25"], "Leave out --hand-size"),
    ):
        assert main([*run, person, *wrong]) == 2
        assert told in capsys.readouterr().err
    records = read_journal(session_path(study.path, person, 2) / "session.jsonl")
    assert sum(r["kind"] == "trial_end" for r in records) == SECOND
