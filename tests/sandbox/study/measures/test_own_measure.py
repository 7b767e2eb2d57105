"""A study's own measure, in a file beside its design, is in the tables, the codebook, the rules and
the report."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import load_design
from sandbox.study.design.reading import DesignError
from sandbox.study.measures.measures import MEASURES, REMOVED
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.tables.tables import make_tables
from tests.support.study_files import DESIGN, design, quiet, rows_of

OWN = """
from sandbox.study.measures.measures import Measure

def height(trial, result):
    return {value}

HEIGHT = Measure("{name}", "m", "Height of the palm", "largest height of the palm", height, "low")
NOTHING = Measure("nothing", "m", "Nothing", "it has no function")
NUMBER = 3
"""


HIGHEST = "trial.hands[0].palm[:, 2].max()"


NAMED = '\n[analysis]\nown_measure = "palm.py:{member}"\n'


RULE = '[[exclusions]]\nname = "low"\nmeasure = "palm_height_m"\nabove = 1e9\n'


def own_design(
    folder: Path, value: str = HIGHEST, name: str = "palm_height_m", member: str = "HEIGHT"
) -> Design:
    """A design with a measure of its own, in a folder."""
    folder.mkdir(exist_ok=True)
    (folder / "palm.py").write_text(OWN.format(value=value, name=name))
    path = folder / "design.toml"
    path.write_text(DESIGN + RULE * (name == "palm_height_m") + NAMED.format(member=member))
    return load_design(path)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    folder = tmp_path_factory.mktemp("own")
    found = StudyFolder(folder / "studies", own_design(folder), SIMULATED)
    for number in (1, 2):
        run_simulated(found, number, quiet, tables=number > 1)
    return found


def test_it_is_a_column_of_all_results_with_a_row_in_the_codebook(study: StudyFolder) -> None:
    values = [float(row["palm_height_m"]) for row in rows_of(study.path / "tables/trials.csv")]
    assert len(values) == 12 and min(values) > 0.0
    codebook = rows_of(study.path / "tables/codebook.csv")
    (row,) = [row for row in codebook if row["column"] == "palm_height_m"]
    assert (row["unit"], row["better"], row["type"]) == ("m", "low", "number")


def test_its_file_goes_with_the_study(study: StudyFolder, tmp_path: Path) -> None:
    before = (study.path / "tables/trials.csv").read_bytes()
    copy = tmp_path / study.path.name
    shutil.copytree(study.path, copy)
    make_tables(StudyFolder.at(copy))
    assert (copy / "palm.py").exists()
    assert (copy / "tables/trials.csv").read_bytes() == before


@pytest.mark.parametrize(
    ("value", "reason"),
    [("1 / 0", "ZeroDivisionError"), ("float('inf')", "it returned inf"), ("[1]", "a list")],
)
def test_one_that_fails_costs_no_trial_and_its_reason_is_said(
    value: str, reason: str, tmp_path: Path
) -> None:
    study = StudyFolder(tmp_path / "studies", own_design(tmp_path, value), SIMULATED)
    said: list[str] = []
    run_simulated(study, 1, said.append)
    rows = rows_of(study.path / "tables/trials.csv")
    assert len(rows) == 6 and "palm_height_m" not in rows[0]
    assert any(
        line.startswith("empty in 6 trials: measure palm_height_m: ") and reason in line
        for line in said
    )


def test_a_study_whose_measure_has_changed_is_not_continued_in_silence(tmp_path: Path) -> None:
    StudyFolder(tmp_path / "studies", own_design(tmp_path), SIMULATED).add()
    with pytest.raises(StudyError, match="design"):
        StudyFolder(tmp_path / "studies", own_design(tmp_path, "0.0"), SIMULATED)


@pytest.mark.parametrize(
    ("name", "member", "reason"),
    [
        ("drops", "HEIGHT", "the program has a measure of this name"),
        ("away", "HEIGHT", "the program has a measure of this name"),
        ("no way", "HEIGHT", "cannot be the name of a column"),
        ("other_m", "NOTHING", "no function that computes it"),
        ("other_m", "NUMBER", "expected a measure"),
        ("other_m", "GONE", "nothing of this name"),
    ],
)
def test_one_that_is_not_valid_is_refused(
    name: str, member: str, reason: str, tmp_path: Path
) -> None:
    with pytest.raises(DesignError, match=reason):
        own_design(tmp_path, name=name, member=member)


@pytest.mark.parametrize("name", REMOVED)
def test_a_measure_of_an_earlier_version_is_refused_by_name(name: str) -> None:
    rule = f'[[exclusions]]\nname = "old"\nmeasure = "{name}"\nabove = 1.0\n'
    with pytest.raises(DesignError, match=f"{REMOVED[name]} takes its place"):
        design(DESIGN + rule)
    with pytest.raises(DesignError, match=f"{REMOVED[name]} takes its place"):
        design(DESIGN + f'[analysis]\nprimary = ["{name}"]\n')
    assert name not in {measure.name for measure in MEASURES}
