"""`study check` finds each of its mistakes at its line, and nothing in sound designs."""

from __future__ import annotations

import re
import tomllib
from io import StringIO
from itertools import pairwise, product
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from sandbox.cli.main import main
from sandbox.study.design.checks import Finding, findings
from sandbox.study.design.conditions import run_settings
from sandbox.study.design.design_file import load_design
from sandbox.study.design.reading import DesignError, Mistake
from sandbox.study.design.session_plan import BreakStep, TrialStep, session_plan
from tests.support.study_designs import KINDS, STYLES, TEXTS, TURN, changed, sound, written
from tests.support.study_files import SOUND, design

ROOT = Path(__file__).resolve().parents[4]


class Planted(NamedTuple):
    """A mistake in a sound design.

    Attributes:
        changes: What is written in place of the sound values, by place.
        place: Place of the mistake, whose line is told; empty for the first line.
        words: What the message has in it.
        languages: Languages of the design.
        raw: A part of the text, and what stands there.
    """

    changes: dict[str, Any]
    place: str
    words: str
    languages: tuple[str, ...] = ("en",)
    raw: tuple[str, str] = ("", "")


SAME = [{"name": "soft", "contact": "soft"}, {"name": "gentle", "contact": "soft"}]


SEVEN = [{"name": f"{i}", "turn": 90 * (i % 4), "impulse": i + 1} for i in range(7)]


STACK, BOX = {"settings.task": "stack"}, {"settings.task": "box-to-goal"}


ITEM = "questionnaires.0.items.0"


ERRORS = {
    "E1 TOML": Planted({}, "name", "", raw=('"quick"', '"quick')),
    "E1 no end": Planted({}, "name", "", raw=('"quick"', '"""quick')),
    "E2 unknown key": Planted({"settings.contcat": 1}, "settings.contcat", "Did you mean contact"),
    "E3 type": Planted({"trials.time_limit_s": "20"}, "trials.time_limit_s", "without quotation"),
    "E3 range": Planted({"trials.repetitions": 0}, "trials.repetitions", "from 1 to 1000"),
    "E4 value": Planted({"factors.0.order": "latn"}, "factors.0.order", "Did you mean latin"),
    "E5 twice": Planted({"factors.0.levels": ["hard", "hard"]}, "factors.0.levels", "twice"),
    "E6 a column of ours": Planted({"demographics.0.name": "hand"}, "demographics.0.name", "own_"),
    "E7 language missing": Planted(
        {"consent.text": {"en": "Do you agree?"}}, "consent.text", "missing in de", ("en", "de")
    ),
    "E8 tag": Planted({"languages": ["pt_BR"]}, "languages", "not a language tag"),
    "E8 words": Planted({}, "languages.0", "no words in nl", ("nl",)),
    "E9 not built": Planted({"settings.encoder": "mine.npz"}, "settings.encoder", "mine.npz"),
    "E9 a value": Planted(
        {"settings.finger_sets": "thumb+indx"}, "settings.finger_sets", "Did you mean index"
    ),
    "E10 surface": Planted(
        {**STACK, "settings.surface": "1x1in"}, "settings.surface", "too small for this task"
    ),
    "E11 the same": Planted(
        {"factors.0.levels": SAME}, "factors.0.levels.1", "have the same settings in"
    ),
    "E12 nested": Planted(
        {"factors.1": {**TURN, "inside": "contact", "levels": {"hard": [0, 90]}}},
        "factors.1.levels",
        "its own list",
    ),
    "E13 factorial": Planted(
        {"factors.1": {"name": "more", "order": "factorial", "levels": SEVEN}},
        "factors.1.order",
        "too many for order factorial",
    ),
    "E14 a level a session": Planted(
        {"sessions": 3, "factors.0.one_a_session": True},
        "factors.0.one_a_session",
        "Write sessions = 2",
    ),
    "E15 step": Planted({f"{ITEM}.step": 7}, f"{ITEM}.step", "do not reach 100"),
    "E16 choices": Planted(
        {"demographics.0": {"name": "hands", "kind": "choice", "choices": ["a"], "ask": "Which?"}},
        "demographics.0.choices",
        "two or more",
    ),
    "E17 scoring": Planted(
        {
            "questionnaires.0.items.1": {"name": "why", "kind": "text", "ask": "Why?"},
            "questionnaires.0.scales": [{"name": "strain", "items": ["why"]}],
        },
        "questionnaires.0.scales.0.items",
        "not an item of kind scale",
    ),
    "E18 asked once": Planted(
        {"questionnaires.0.at": "end", "analysis": {"primary": ["effort"]}},
        "analysis.primary",
        "asked once",
    ),
    "E19 bounds": Planted(
        {"exclusions.0": {"name": "odd", "measure": "drops", "below": 30, "above": 10}},
        "exclusions.0",
        "exclude every trial",
    ),
    "E19 of two rules": Planted(
        {
            "exclusions.0": {"name": "low", "measure": "drops", "below": 3},
            "exclusions.1": {"name": "high", "measure": "drops", "above": 2},
        },
        "exclusions.1",
        "low and high exclude every trial",
    ),
    "E19 range": Planted(
        {"exclusions.0": {"name": "no", "measure": "success", "below": 1.5}},
        "exclusions.0",
        "from 0 to 1",
    ),
    "E20 file": Planted(
        {"questionnaires.0": {"name": "strain", "file": "strain.toml", "at": "end"}},
        "questionnaires.0.file",
        "strain.toml cannot be read",
    ),
    "E21 no consent": Planted({"consent": None}, "", "not asked for their consent"),
    "E22 template": Planted({"name": "my-study"}, "name", "still my-study"),
    "no limit": Planted(
        {**BOX, "trials.time_limit_s": 0.1, "exclusions": None, "trials.expected_s": 0.05},
        "trials.time_limit_s",
        "no trial can succeed",
    ),
    "never asked": Planted(
        {"factors.1": TURN, "trials.practice": 2, "trials.repeat_inside": "contact"}
        | {"questionnaires.0.at": "turn"},
        "questionnaires.0.at",
        "is never asked",
    ),
}


WARNINGS = {
    "W1 cycle": Planted({"participants": 25}, "participants", "do not fill the 2 orders"),
    "W2 blocked": Planted({"factors.0.order": "blocked"}, "factors.0.order", "told from practice"),
    "W3 one level": Planted({"factors.0.levels": ["hard"]}, "factors.0.levels", "varies nothing"),
    "W4 practice": Planted(
        {"trials.practice_each": None}, "trials.practice", "before anybody has practised it"
    ),
    "W4 none": Planted(
        {"trials.practice": 0, "trials.practice_each": None}, "trials.practice", "0 practice trials"
    ),
    "W5 after practice": Planted(
        {"breaks": {"every": 3}}, "breaks.every", "participant 1, after trial 5"
    ),
    "W5 never": Planted({"breaks": {"every": 50}}, "breaks.every", "no break ever comes"),
    "W6 stretch": Planted({"trials.repetitions": 60}, "trials.repetitions", "without a break"),
    "W6 session": Planted(
        {"trials.repetitions": 140, "breaks": {"every": 16}}, "trials.repetitions", "weariness"
    ),
    "W7 expected": Planted(
        {**BOX, "trials.time_limit_s": 6, "trials.expected_s": 15},
        "trials.expected_s",
        "more than the limit, 6",
    ),
    "W7 own limit": Planted(
        {**BOX, "trials.time_limit_s": 99}, "trials.time_limit_s", "ends by itself after 30 s"
    ),
    "W8 outcome": Planted(
        {"exclusions.0": {"name": "slow", "measure": "time_s", "above": 1.5}},
        "exclusions.0",
        "which is an outcome",
    ),
    "W10 same text": Planted(
        {"instructions.0.text": {"en": TEXTS["en"][1], "de": TEXTS["en"][1]}},
        "instructions.0.text",
        "the same in en and de",
        ("en", "de"),
    ),
    "W10 choices": Planted(
        {
            "demographics.0": {
                "name": "hands",
                "kind": "choice",
                "choices": ["right", "left"],
                "ask": {"en": "Which?", "de": "Welche?"},
            }
        },
        "demographics.0",
        "read as they are stored",
        ("en", "de"),
    ),
}


def found_in(path: Path) -> list[tuple[Mistake | Finding, bool]]:
    """Mistakes of a design file, each with whether it is an error."""
    try:
        read = load_design(path)
    except DesignError as error:
        return [(mistake, True) for mistake in error.mistakes]
    return [(finding, finding.error) for finding in findings(read)]


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("name", [*ERRORS, *WARNINGS])
def test_each_mistake_is_found_at_its_line_however_the_file_is_written(
    tmp_path: Path, name: str, style: str
) -> None:
    planted = ERRORS.get(name) or WARNINGS[name]
    text, lines = written(changed(sound(*planted.languages), planted.changes), style)
    path = tuple(int(part) if part.isdigit() else part for part in planted.place.split("."))
    file = tmp_path / "design.toml"
    file.write_bytes(text.replace(*planted.raw, 1).encode())
    ((mistake, error),) = found_in(file)
    assert error is (name in ERRORS)
    assert planted.words in str(mistake) and mistake.remedy
    assert mistake.line == (lines[path] if planted.place else 1)


@pytest.mark.parametrize(
    ("kind", "language", "style"),
    [(k, c, STYLES[i % 5]) for i, (k, c) in enumerate(product(KINDS, TEXTS))],
)
def test_twenty_sound_designs_have_no_finding(
    tmp_path: Path, kind: str, language: str, style: str
) -> None:
    changes = KINDS[kind]
    languages = changes.get("languages") or [language]
    file = tmp_path / "design.toml"
    file.write_bytes(written(changed(sound(*languages), changes), style)[0].encode())
    assert found_in(file) == []


@pytest.mark.parametrize(
    ("factors", "settings", "wanted"),
    [
        # What the inner factor sets wins, so that the outer one does nothing.
        ([["contact", ["hard", "soft"]], ["again", [*SAME[:1], {**SAME[1], "impulse": 2}]]], {}, 1),
        # Only touches go through an encoder.
        ([["encoder", ["paper", "population"]]], {"device": "leap"}, 1),
        ([["encoder", ["paper", "population"]]], {"device": "touch"}, 0),
        # One level sets what is so by default.
        ([["contact", ["hard", {"name": "usual", "solid": "fingertips"}]]], {}, 1),
    ],
)
def test_levels_are_compared_by_all_that_they_set_of_a_trial(
    tmp_path: Path, factors: list[Any], settings: dict[str, str], wanted: int
) -> None:
    some = changed(
        sound("en"),
        {
            "settings": {"task": "box-to-goal", **settings},
            "factors": [{"name": n, "order": "latin", "levels": x} for n, x in factors],
            "trials": {"practice": 4},
            "questionnaires": None,
        },
    )
    (tmp_path / "design.toml").write_text(written(some, "tables")[0])
    told = [str(mistake) for mistake, _ in found_in(tmp_path / "design.toml")]
    assert sum("have the same settings" in what for what in told) == wanted, told


@pytest.mark.parametrize("repetitions", [2, 3, 6])
def test_a_break_after_practice_is_found_and_the_remedy_s_number_avoids_it(
    repetitions: int,
) -> None:
    text = SOUND.replace("repetitions = 2", f"repetitions = {repetitions}")
    (found,) = findings(design(f"{text}\n[breaks]\nevery = {repetitions}\n"))
    assert "between practice and its trials" in found.what
    better = int(re.findall(r"Write (\d+)", found.remedy)[0])
    plan = session_plan(design(f"{text}\n[breaks]\nevery = {better}\n"), 1)
    after = [a for a, b in pairwise(plan) if isinstance(b, BreakStep)]
    assert after and all(isinstance(step, TrialStep) and not step.practice for step in after)


@pytest.mark.parametrize("place", ["settings.vary", "factors.0.levels.1.vary"])
def test_a_table_of_what_is_varied_is_refused_with_a_text_that_means_the_same(
    tmp_path: Path, place: str
) -> None:
    levels = [{"name": "near", "impulse": 1}, {"name": "far", "impulse": 2}]
    some = changed(sound("en"), {"factors.0.levels": levels})
    file = tmp_path / "design.toml"
    wrong = changed(some, {place: {"size": 0.7, "latency": 50}})
    file.write_text(written(wrong, "inline")[0])
    ((mistake, _),) = found_in(file)
    better = tomllib.loads(mistake.remedy.removeprefix("Write "))["vary"]
    file.write_text(written(changed(some, {place: better}), "inline")[0])
    assert found_in(file) == []
    varied = run_settings({"task": "box-to-goal", "vary": better}, 0).variation
    assert (
        varied == run_settings({"task": "box-to-goal", "vary": "size=0.7,latency=50"}, 0).variation
    )
    assert not varied.neutral


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("trials", "sessions"),
    [
        ({"practice": 2}, 1),
        ({"practice": 0}, 1),
        ({"practice": 1, "practice_each": "contact"}, 1),
        ({"practice": 2, "practice_sessions": [2]}, 2),
    ],
)
def test_each_remedy_for_a_level_that_was_not_practised_practises_all_levels(
    tmp_path: Path, seed: int, trials: dict[str, Any], sessions: int
) -> None:
    some = changed(sound("en"), {"factors.1": TURN, "sessions": sessions, "seed": seed})
    some["trials"] = {"repetitions": 1, **trials}
    file = tmp_path / "design.toml"
    file.write_text(written(some, "tables")[0])
    remedies = [found.remedy for found, _ in found_in(file) if found.where == "trials.practice"]
    for remedy in remedies:
        way, _, also = remedy.removeprefix("Write ").partition(", and ")
        some["trials"] |= tomllib.loads(way.replace(" and ", "\n"))
        if also == "remove practice_sessions":
            del some["trials"]["practice_sessions"]
        file.write_text(written(some, "tables")[0])
        assert not any(found.where == "trials.practice" for found, _ in found_in(file))
    # Without practice, and where practice is late, levels are measured unpractised by any seed.
    assert remedies or (trials["practice"] and sessions == 1)


def test_real_participants_are_refused_with_an_error_and_a_pilot_is_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", StringIO())
    file = tmp_path / "design.toml"
    file.write_text(SOUND.replace('"quick"', '"my-study"'))
    run = ["study", "run", str(file), "--out", str(tmp_path), "--participant", "ZZZZZZ"]
    for more, told in (([], "not for real participants yet"), (["--pilot"], "ZZZZZZ")):
        assert main([*run, *more, "--tablet"]) == 2
        assert told in capsys.readouterr().err
    assert not (tmp_path / "my-study").exists()


def test_our_example_has_no_finding_and_the_template_those_of_a_template() -> None:
    assert found_in(ROOT / "examples/study/design.toml") == []
    told = found_in(ROOT / "sandbox/study/design/template.toml")
    assert [mistake.where for mistake, _ in told] == ["name", "consent.text"]
