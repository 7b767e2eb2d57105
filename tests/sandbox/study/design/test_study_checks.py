"""`study check` finds designs that are right in form and mislead, one line a cause."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.design.checks import findings
from sandbox.study.design.design_file import read_draft
from sandbox.study.design.plan import BreakStep, TrialStep, session_plan
from sandbox.study.design.reading import DesignError
from tests.support.study_files import SOUND as DESIGN
from tests.support.study_files import design

ROOT = Path(__file__).resolve().parents[4]
CONSENT = DESIGN[DESIGN.index("[consent]") : DESIGN.index("[[demographics]]")]
RULE = '\n[[exclusions]]\nname = "rule"\n'
TWICE_SET = (
    '\n[[factors]]\nname = "again"\norder = "random"\n'
    'levels = [{name = "a", contact = "hard"}, {name = "b", contact = "soft"}]\n'
)


def changed(old: str, new: str) -> str:
    assert old in DESIGN
    return DESIGN.replace(old, new, 1)


@pytest.mark.parametrize(
    ("text", "error", "told"),
    [
        (DESIGN + RULE + 'measure = "time_s"\nbelow = 9\nabove = 2\n', True, "excludes everything"),
        (DESIGN + RULE + 'measure = "success"\nbelow = 1.5\n', True, "is from 0 to 1"),
        (DESIGN + RULE + 'measure = "time_s"\nbelow = 601\n', True, "is from 0 to 600"),
        (DESIGN + RULE + 'measure = "success"\nbelow = 1\n', False, "selects on the outcome"),
        (DESIGN + RULE + 'measure = "time_s"\nabove = 9\n', False, "what takes long"),
        (
            changed("repetitions = 2", "repetitions = 2\ntime_limit_s = 0.05\nexpected_s = 0.05"),
            True,
            "no trial can succeed",
        ),
        (
            changed("repetitions = 2", "repetitions = 2\ntime_limit_s = 9"),
            False,
            "more than the time limit",
        ),
        (changed('order = "latin"', 'order = "blocked"'), False, "told from practice"),
        (changed(CONSENT, ""), False, "consent"),
        (DESIGN + "\n[breaks]\nevery = 4\n", False, "no break ever comes"),
        (changed('["hard", "soft"]', '["hard"]'), False, "one level"),
        (changed("participants = 24", "participants = 25"), False, "contact with practice"),
        (DESIGN + RULE + 'measure = "time_s"\nabove = 600\n', False, "excludes nothing"),
        (
            DESIGN + RULE + 'of = "participant"\nmeasure = "success"\nbelow = 0.1\n',
            False,
            "leaves out people because of success",
        ),
        (
            changed("repetitions = 2", "repetitions = 2\ntime_limit_s = 10\nexpected_s = 9"),
            False,
            "cut off",
        ),
        (changed("practice = 1", "practice = 0"), False, "nobody practises"),
        (changed("practice = 1", "practice = 2") + TWICE_SET, True, "the inner factor wins"),
        (changed('"latin"', '"between"').replace("= 24", "= 25"), False, "groups differ in size"),
        (
            changed('"latin"', '"random"').replace("= 24", "= 8").replace("seed = 3", "seed = 11"),
            False,
            "orders, so that contact is confounded with practice",
        ),
        (
            changed("seed = 3", "seed = 3\nsessions = 2").replace(
                "practice = 1", 'practice = 1\nseeds = "shared"'
            ),
            False,
            "what is remembered of them",
        ),
        (
            changed("seed = 3", "seed = 3\nsessions = 2").replace(
                'order = "latin"', 'order = "blocked"\none_a_session = true'
            ),
            False,
            "told from the session in which it comes",
        ),
        (
            changed("practice = 1", 'practice = 1\nrepeat_inside = "turn"').replace(
                "[[factors]]",
                '[[factors]]\nname = "turn"\norder = "latin"\nlevels = [0, 90]\n[[factors]]',
                1,
            ),
            True,
            "effort is never asked",
        ),
        (
            changed("repetitions = 2", "repetitions = 60"),
            False,
            "min come without a break",
        ),
        (
            DESIGN + '\n[[instructions]]\nat = "contact"\nlevel = "soft"\ntext = "Now!"\n',
            False,
            "only soft is announced, not hard",
        ),
    ],
)
def test_what_misleads_is_one_line_with_its_remedy(text: str, error: bool, told: str) -> None:
    (found,) = findings(design(text))
    assert found.error is error and told in found.mistake.what and found.mistake.remedy
    assert 1 <= found.mistake.line <= text.count("\n") + 1


@pytest.mark.parametrize("repetitions", [2, 3, 6])
def test_a_break_after_practice_is_found_and_the_remedy_s_number_avoids_it(
    repetitions: int,
) -> None:
    text = DESIGN.replace("repetitions = 2", f"repetitions = {repetitions}")
    (found,) = findings(design(f"{text}\n[breaks]\nevery = {repetitions}\n"))
    assert "a break comes between the practice of a level of contact and" in found.mistake.what
    better = int(re.findall(r"Write (\d+)", found.mistake.remedy)[0])
    plan = session_plan(design(f"{text}\n[breaks]\nevery = {better}\n"), 0)
    after = [a for a, b in pairwise(plan) if isinstance(b, BreakStep)]
    assert after and all(isinstance(step, TrialStep) and not step.practice for step in after)
    at_once = text.replace('practice_each = "contact"\n', "").replace(
        "practice = 1", "practice = 2"
    )
    assert findings(design(f"{at_once}\n[breaks]\nevery = {repetitions}\n")) == []


def test_a_sound_design_has_none() -> None:
    assert findings(design(DESIGN)) == []
    assert findings(design(DESIGN + "\n[breaks]\nevery = 3\n")) == []
    assert findings(design(DESIGN + RULE + 'measure = "time_s"\nbelow = 0.5\n')) == []
    asked = '\n[[demographics]]\nname = "glasses"\nkind = "text"\nask = "Do you wear glasses?"\n'
    assert findings(design(DESIGN + asked)) == []


def test_a_language_that_instruments_lack_is_one_line_each() -> None:
    text = changed("seed = 3", 'seed = 3\nlanguages = ["fi"]')
    text += '\n[[questionnaires]]\nuse = "nasa-tlx"\nat = "end"\n'
    with pytest.raises(DesignError) as caught:
        design(text)
    (mistake,) = caught.value.mistakes
    assert "nasa-tlx" in mistake.what and "missing in fi in" in mistake.what
    assert "translate it there" in mistake.remedy


def test_check_prints_them_and_fails_on_errors_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(changed("participants = 24", "participants = 25"))
    assert main(["study", "check", str(file)]) == 0
    assert "warning, line 4: participants: 25 people" in capsys.readouterr().out
    file.write_text(DESIGN + RULE + 'measure = "success"\nbelow = 1.5\n')
    assert main(["study", "check", str(file)]) == 2
    said = capsys.readouterr().out
    assert "error, line" in said and "exclusions[1]" in said and "no mistakes" not in said


@pytest.mark.parametrize(
    "name", ["examples/study/design.toml", "sandbox/study/design/template.toml"]
)
def test_our_own_designs_have_none(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert findings(design(text)) == []


def test_simulate_shows_them_before_it_begins(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(changed('order = "latin"', 'order = "blocked"'))
    assert main(["study", "check", str(file)]) == 0
    warning = capsys.readouterr().out.splitlines()[0]
    (tmp_path / "quick-simulated").write_text("in the way")
    assert main(["study", "simulate", str(file), "--out", str(tmp_path)]) == 2
    assert warning.startswith("warning, line 10") and warning in capsys.readouterr().out


def test_a_mistake_in_the_outcomes_hides_no_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = changed("participants = 24", "participants = 25")
    file = tmp_path / "design.toml"
    file.write_text(text + '\n[analysis]\nprimary = ["opinions"]\n')
    assert main(["study", "check", str(file)]) == 2
    told = "".join(capsys.readouterr())
    assert "contact with practice" in told and "unknown outcome 'opinions'" in told
    file.write_text(text)
    assert read_draft(file) is None


def test_a_text_that_lacks_a_language_hides_no_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = DESIGN[: DESIGN.index("[consent]")].replace("participants = 24", "participants = 25")
    text = text.replace("seed = 3", 'seed = 3\nlanguages = ["en", "fr"]')
    text += '[consent]\ntext = {en = "Do you agree?"}\n'
    file = tmp_path / "design.toml"
    file.write_text(text)
    assert main(["study", "check", str(file)]) == 2
    told = "".join(capsys.readouterr())
    assert "contact with practice" in told and "the text is missing in fr" in told
