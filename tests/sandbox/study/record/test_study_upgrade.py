"""What a design that is changed in the middle of a study does, and what it leaves as it is."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import DifferentPlanError
from sandbox.study.design.session_plan import trials_of
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.report.data import load_study
from sandbox.study.report.make import make_report
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.simulated_study import run_simulated, simulate, simulated_person
from sandbox.study.share.shared_folder import Masking, share_study
from sandbox.study.share.verify import verify
from tests.support.study_files import DESIGN, design, open_study, quiet, rows_of, simulated_runner


def with_lag(vary: str) -> str:
    levels = f'[{{name = "hard", contact = "hard"}}, {{name = "soft", vary = "latency={vary}"}}]'
    return DESIGN.replace('levels = ["hard", "soft"]', f"levels = {levels}")


def begun(study: StudyFolder) -> SessionFolder:
    """A session in which every trial but the last has been begun."""
    person = study.add(1, **simulated_person(study.design, 1))
    session = SessionFolder(study, person)
    for trial in trials_of(session.steps)[:-1]:
        session.begin(trial)
    return session


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (with_lag("50").replace("repetitions = 2", "repetitions = 3"), "another trial"),
        (with_lag("250"), "vary latency=50, now latency=250"),
        # What no level sets any more is another meaning, too.
        (DESIGN, "vary latency=50, now "),
    ],
)
def test_a_session_does_not_go_on_by_the_plan_of_another_design(
    tmp_path: Path, other: str, says: str
) -> None:
    study = open_study(tmp_path, with_lag("50"))
    begun(study).close()
    before = next(study.path.glob("*/S001/session.jsonl")).read_bytes()
    changed = StudyFolder(tmp_path, design(other), SIMULATED, "it was better")
    with pytest.raises(DifferentPlanError, match="another plan") as error:
        run_simulated(changed, 1, quiet)
    assert says in str(error.value)
    assert next(study.path.glob("*/S001/session.jsonl")).read_bytes() == before
    # Others take part, and the tables are those of the new design.
    said: list[str] = []
    assert simulate(changed, 2, True, said.append)["participants"] == 2
    assert any("participant 1 of 2: left as it is" in line for line in said)
    assert any("participant 2 of 2: complete" in line for line in said)
    assert verify(changed.path, replays=False).sound


def test_a_person_stays_in_their_group_under_another_design(tmp_path: Path) -> None:
    groups = DESIGN.replace('order = "latin"', 'order = "between"').replace(
        "seed = 3", "seed = 3\nsessions = 2"
    )
    study = open_study(tmp_path, groups)
    person = study.add(1, **simulated_person(study.design, 1))
    with SessionFolder(study, person) as first:
        level = trials_of(first.steps)[0].levels["contact"]
        simulated_runner(first, person, SimulatedForms(1)).run()
    turned = groups.replace('["hard", "soft"]', '["soft", "hard"]')
    assert level == "hard"
    changed = StudyFolder(tmp_path, design(turned), SIMULATED, "the other way round")
    with pytest.raises(DifferentPlanError, match="another group"):
        SessionFolder(changed, person, 2)


def test_answers_are_scored_by_the_form_as_it_was_asked(tmp_path: Path) -> None:
    scale = '[[questionnaires.scales]]\nname = "total"\nrule = "mean"\nitems = ["effort"]\n'
    study = open_study(tmp_path, DESIGN + scale)
    run_simulated(study, 1, quiet)
    table = study.path / "tables/scores.csv"
    before = [(r["score"], r["score_high"]) for r in rows_of(table)]
    other = DESIGN.replace("step = 5", "high = 5") + scale
    changed = StudyFolder(tmp_path, design(other), SIMULATED, "a shorter scale")
    simulate(changed, 2, True, quiet)
    after = [(r["score"], float(r["score_high"])) for r in rows_of(table)]
    assert after[: len(before)] == [(s, float(h)) for s, h in before]
    assert {high for _, high in after[len(before) :]} == {5.0}


def test_the_report_says_what_was_changed_by_force_and_what_it_means_for_results(
    tmp_path: Path,
) -> None:
    primary = '[analysis]\nprimary = ["time_s"]\n'
    study = open_study(tmp_path, with_lag("50") + primary)
    simulate(study, 1, False, quiet)
    assert load_study(study.path).upgrades == ()
    other = with_lag("250") + primary.replace("time_s", "success")
    changed = StudyFolder(tmp_path, design(other), SIMULATED, "the lag was too short")
    simulate(changed, 2, True, quiet)
    (told,) = load_study(study.path).upgrades
    assert (
        "After 1 participant had begun, the study was changed" in told
        and "the lag was too short." in told
    )
    assert "Primary outcomes were time_s before and are success." in told
    assert "contact soft had vary latency=50 before and latency=250 after" in told
    page = make_report(study.path, tmp_path / "report").read_text(encoding="utf-8")
    assert "was changed after people had begun" in page and "too short" in page
    # A copy without names tells what it means, and neither when it was nor why.
    share_study(changed, tmp_path / "copy", Masking(), quiet)
    (told,) = load_study(tmp_path / "copy").upgrades
    assert "contact soft had vary latency=50 before" in told and "too short" not in told
