"""A measure declared in one place is in the tables, the codebook, the rules and the report."""

from __future__ import annotations

import csv
import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from models.errors import InputError, StudyError
from sandbox.recording.versions import package_digest
from sandbox.study.measures.columns import Columns
from sandbox.study.measures.measure import TrialMeasure
from sandbox.study.measures.registry import find_measure, register, rule_measures, unregister
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.report.make import make_report
from sandbox.study.run.simulate import run_simulated
from tests.support.study_files import DESIGN, design, open_study

HEIGHT = TrialMeasure(
    "palm_height_m",
    "m",
    "Height of the palm",
    "largest height of the commanded palm above the table",
    better="low",
    of_trial=lambda trial: trial.table.numbers("q_position_z").max(),
)
BROKEN = TrialMeasure("broken", "m", "Broken", "always fails", of_trial=lambda trial: 1 / 0)
NOTHING = TrialMeasure("nothing", "m", "Nothing", "never applies", of_trial=lambda trial: None)
ENDLESS = TrialMeasure(
    "endless", "s", "Endless", "not finite", of_result=lambda result: float("inf")
)
SEVERAL = TrialMeasure(
    "several", "", "Several", "fails over trials", of_trials=lambda rows: rows[99]["time_s"]
)
WINS = TrialMeasure("wins", "", "Wins", "successes with these levels", of_trials=len)
OWN = (HEIGHT, BROKEN, NOTHING, ENDLESS, SEVERAL, WINS)


@pytest.fixture(scope="module", autouse=True)
def registered() -> Iterator[None]:
    for measure in OWN:
        register(measure)
    yield
    for measure in OWN:
        unregister(measure.name)


@pytest.fixture(scope="module")
def said() -> list[str]:
    return []


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory, said: list[str]) -> StudyFolder:
    found = open_study(tmp_path_factory.mktemp("own"))
    for number in range(2):
        run_simulated(found, number, said.append)
    return found


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_it_is_a_column_of_all_results_with_a_row_in_the_codebook(study: StudyFolder) -> None:
    session = session_path(study.path, study.participants()[0].ppid)
    for folder in (study.path, session):
        values = [float(row["palm_height_m"]) for row in rows(folder / "trial_results.csv")]
        assert len(values) >= 6 and min(values) > 0.0
        described = [r for r in rows(folder / "codebook.csv") if r["column"] == "palm_height_m"]
        assert [(r["table"], r["unit"], r["meaning"]) for r in described] == [
            ("trial_results.csv", "m", HEIGHT.means)
        ]


def test_it_is_in_the_report_with_its_unit_and_meaning(study: StudyFolder, tmp_path: Path) -> None:
    make_report(study.path, tmp_path)
    assert all(float(row["palm_height_m"]) > 0.0 for row in rows(tmp_path / "trials.csv"))
    described = [r for r in rows(tmp_path / "codebook.csv") if r["column"] == "palm_height_m"]
    assert [(r["file"], r["unit"], r["meaning"]) for r in described] == [
        ("trials.csv", "m", HEIGHT.means)
    ]
    assert any(row["measure"] == "palm_height_m" for row in rows(tmp_path / "means.csv"))
    assert HEIGHT.title in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_measure_that_fails_or_has_no_value_costs_no_trial_and_its_reason_is_said(
    study: StudyFolder, said: list[str]
) -> None:
    table = rows(study.path / "trial_results.csv")
    assert len(table) == 12 and all(row["counted"] == "1" for row in table)
    for name in ("broken", "nothing", "endless", "several"):
        assert {row[name] for row in table} == {""}
    session = session_path(study.path, study.participants()[0].ppid)
    reasons = json.loads((session / "trackers" / "measures_T001.json").read_bytes())["reasons"]
    assert (
        "ZeroDivisionError" in reasons["broken"] and reasons["nothing"] == "it does not apply here"
    )
    assert "inf" in reasons["endless"]
    for name, error in (("broken", "ZeroDivisionError"), ("endless", "inf"), ("several", "Index")):
        assert any(f"measure {name} is empty" in line and error in line for line in said)


def test_a_measure_of_several_trials_is_the_same_in_all_rows_with_the_same_levels(
    study: StudyFolder,
) -> None:
    cells: dict[tuple[str, str], set[str]] = {}
    for row in rows(study.path / "trial_results.csv"):
        cells.setdefault((row["ppid"], row["factor_contact"]), set()).add(row["wins"])
    assert all(len(values) == 1 and int(min(values)) >= 0 for values in cells.values())


def test_a_rule_may_look_at_it_but_not_at_one_of_several_trials() -> None:
    assert "palm_height_m" in rule_measures() and rule_measures()[0] == "time_s"
    assert not {"wins", "label_truth", "throughput_bit_s"} & set(rule_measures())


def test_a_measure_that_is_added_later_is_computed_when_the_session_is_opened_again(
    tmp_path: Path,
) -> None:
    unregister("palm_height_m")
    study = open_study(tmp_path)
    run_simulated(study, 0, lambda text: None)
    assert "palm_height_m" not in rows(study.path / "trial_results.csv")[0]
    register(HEIGHT)
    run_simulated(study, 0, lambda text: None)
    values = [float(row["palm_height_m"]) for row in rows(study.path / "trial_results.csv")]
    assert len(values) == 6 and min(values) > 0.0


LAB = """
from sandbox.study.measures.measure import TrialMeasure

def touched(trial):
    return {value}

TOUCHED = TrialMeasure("lab_touched", "{unit}", "Touched", "of a laboratory", of_trial=touched)
"""


def lab_measure(folder: Path, value: str, unit: str) -> TrialMeasure:
    """The measure of a laboratory's module, as it is written now."""
    (folder / "lab_measures.py").write_text(LAB.format(value=value, unit=unit))
    sys.modules.pop("lab_measures", None)
    importlib.invalidate_caches()
    package_digest.cache_clear()
    measure: TrialMeasure = importlib.import_module("lab_measures").TOUCHED
    return measure


def test_a_measure_whose_code_or_unit_changes_is_computed_again_and_one_that_failed_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    study = open_study(tmp_path)
    for value, unit, expected in (("1 / 0", "s", ""), ("2.0", "s", "2"), ("2000.0", "ms", "2000")):
        register(lab_measure(tmp_path, value, unit))
        try:
            run_simulated(study, 0, lambda text: None)
            table = rows(study.path / "trial_results.csv")
            assert {
                float(row["lab_touched"]) if expected else row["lab_touched"] for row in table
            } == {float(expected) if expected else ""}
            (described,) = [
                row for row in rows(study.path / "codebook.csv") if row["column"] == "lab_touched"
            ]
            assert described["unit"] == unit
        finally:
            unregister("lab_touched")


def test_a_study_says_which_measures_of_packages_have_changed_or_are_gone_and_is_locked_to_rules(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    rule = '[[exclusions]]\nname = "none"\nmeasure = "lab_touched"\nbelow = 1e9\n'
    register(lab_measure(tmp_path, "1.0", "s"))
    free, ruled = design(), design(DESIGN + rule)
    StudyFolder(tmp_path / "free", free, SIMULATED)
    StudyFolder(tmp_path / "ruled", ruled, SIMULATED).add()
    unregister("lab_touched")
    register(lab_measure(tmp_path, "2.0", "s"))
    (noted,) = StudyFolder(tmp_path / "free", free, SIMULATED).noted
    assert "lab_touched has changed" in noted
    with pytest.raises(StudyError, match="lab_touched has changed"):
        StudyFolder(tmp_path / "ruled", ruled, SIMULATED)
    unregister("lab_touched")
    (noted,) = StudyFolder(tmp_path / "free", free, SIMULATED).noted
    assert "lab_touched" in noted and "not installed here" in noted


def test_a_measure_is_registered_by_its_place_too(tmp_path: Path) -> None:
    file = tmp_path / "lab_places.py"
    file.write_text(LAB.format(value="1.0", unit="s"))
    register(f"{file}:TOUCHED")
    try:
        found = find_measure("lab_touched")
        assert found is not None and found.title == "Touched"
    finally:
        unregister("lab_touched")
    with pytest.raises(InputError, match=r"FILE\.py:NAME"):
        register("lab_touched")
    with pytest.raises(InputError, match=r"lab_places.py:touched: expected a measure"):
        register(f"{file}:touched")


@pytest.mark.parametrize(
    "measure",
    [
        TrialMeasure("drops", "", "Drops", "again", of_trial=lambda trial: 1),
        TrialMeasure("no way", "", "No way", "not a column", of_trial=lambda trial: 1),
        TrialMeasure("unmade", "", "Unmade", "not computed"),
    ],
)
def test_a_measure_with_a_name_that_is_taken_or_without_a_value_is_refused(
    measure: TrialMeasure,
) -> None:
    with pytest.raises(InputError):
        register(measure)
    assert find_measure(measure.name) is not measure


def test_a_column_that_is_not_there_is_named_with_the_nearest_one() -> None:
    columns = Columns({"time": ["0"], "q_x": ["1"]})
    for ask in (columns.words, columns.numbers, columns.whole):
        with pytest.raises(KeyError, match="there is no column q_y; did you mean q_x"):
            ask("q_y")
