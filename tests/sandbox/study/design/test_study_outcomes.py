"""`study check` looks at outcomes, numbers of people, practice, and when forms are asked."""

from __future__ import annotations

import pytest

from sandbox.study.design.checks import findings
from tests.support.study_files import SOUND, design

TASKS = '\n[[factors]]\nname = "turn"\norder = "latin"\nlevels = [0, 90, 180]\n'
RULE = '\n[[exclusions]]\nname = "rule"\nof = "trial"\n'
SUS = '\n[[questionnaires]]\nuse = "sus"\n'


def changed(old: str, new: str) -> str:
    assert old in SOUND
    return SOUND.replace(old, new, 1)


def primary(*names: str) -> str:
    return "\n[analysis]\nprimary = [" + ", ".join(f'"{name}"' for name in names) + "]\n"


APART = changed("seed = 3", "seed = 3\nsessions = 2").replace(
    'levels = ["hard", "soft"]', 'levels = ["hard", "soft"]\none_a_session = true'
)


MANY = ("time_s", "success", "grasps", "palm_path_m", "palm_sparc", "away_s", "object_path_m")
BUILT_IN = changed('"tests/support/regress_tasks.py:Quick"', '"box-to-goal"')


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (changed("participants = 24", "participants = 4"), "4 people can find even a large effect"),
        (changed("participants = 24", "participants = 8") + primary("time_s"), ""),
        (
            changed("participants = 24", "participants = 8").replace('"latin"', '"between"'),
            "with probability",
        ),
        (SOUND + primary("time_s", "completion_s"), "say nearly the same"),
        (SOUND + primary("time_s", "success"), ""),
        (SOUND + primary("label_accuracy"), "is empty for people on a touch screen"),
        (SOUND + primary("throughput_bit_s"), "it takes 3 successful trials"),
        (changed("practice = 1", 'practice = 1\nwhen_gone = "mark"'), "while the page is gone"),
        (
            changed("practice = 1", 'practice = 1\nwhen_gone = "mark"')
            + RULE
            + 'measure = "away_s"\nabove = 1\n',
            "",
        ),
        (
            changed("practice = 1", 'practice = 1\nwhen_gone = "mark"') + primary("success"),
            "",
        ),
        (SOUND + RULE + 'measure = "drops"\nabove = 3\n' + primary("drops"), "is confirmatory"),
        (
            changed("practice = 1", "practice = 1\nexpected_s = 0.2\ntime_limit_s = 1")
            + RULE
            + 'measure = "time_s"\nbelow = 0.15\n',
            "leaves out good trials",
        ),
        (
            changed("repetitions = 2", "repetitions = 2\nexpected_s = 15"),
            "tasks end by their own limits",
        ),
        (changed("repetitions = 2", "repetitions = 2\nexpected_s = 0.05"), "must be held"),
        (changed("[consent]", "[breaks]\nevery = 3\nleast_s = 1\n[consent]"), "no rest"),
        (
            changed("[consent]", "[breaks]\nevery = 3\nleast_s = 3000\n[consent]"),
            "longer than people wait",
        ),
        (changed("[trials]", TASKS + "[trials]"), "of turn is measured before anybody"),
        (
            changed("[trials]", TASKS + "[trials]").replace("practice = 1", "practice = 3"),
            "",
        ),
        (APART, ""),
        (
            APART.replace("practice = 1", "practice = 1\npractice_sessions = [1]"),
            "in session 2",
        ),
        (
            APART.replace('title = "About', 'sessions = [1]\ntitle = "About'),
            "about some levels of contact only",
        ),
        (
            APART + '\n[[instructions]]\nat = "contact"\nsessions = [2]\ntext = "Now!"\n',
            "only some levels of contact are announced",
        ),
        (SOUND + RULE + 'measure = "away_s"\nbelow = 5\n', "away_s is small in them"),
        (SOUND + RULE + 'measure = "latency_p95_ms"\nbelow = 80\n', "leaves out good trials"),
        (SOUND + RULE + 'measure = "waited_s"\nbelow = 0.1\n', ""),
        (changed("repetitions = 2", "repetitions = 1"), "one trial with a level of contact"),
        (changed("repetitions = 2", "repetitions = 2") + primary("time_s"), ""),
        (BUILT_IN, ""),
        (BUILT_IN + primary("move_error_m"), ""),
        (
            BUILT_IN.replace('"box-to-goal"', '"stack-three"') + primary("move_error_m"),
            "move_error_m is empty in stack-three, which has 2 goals",
        ),
        (BUILT_IN.replace('["hard", "soft"]', '["hard", "none"]'), "no trial of none can succeed"),
        (
            BUILT_IN.replace('"contact"', '"encoder"')
            .replace('["hard", "soft"]', '["paper", "population"]')
            .replace('encoder = "linear"', 'contact = "none"'),
            "the hand passes through everything",
        ),
        (
            SOUND
            + RULE.replace('"rule"', '"low"')
            + 'measure = "drops"\nbelow = 3\n'
            + RULE
            + 'measure = "drops"\nabove = 2\n',
            "low and rule exclude everything together",
        ),
        (
            SOUND
            + RULE.replace('"rule"', '"low"')
            + 'measure = "drops"\nbelow = 1\n'
            + RULE
            + 'measure = "drops"\nabove = 2\n',
            "",
        ),
        (SOUND + primary(*MANY), "7 outcomes are confirmatory"),
        (SOUND + primary(*MANY[:3]), ""),
        (changed("[consent]", "[breaks]\nevery = 2\n[consent]"), "between the practice of a level"),
        (changed("[consent]", "[breaks]\nevery = 3\n[consent]"), ""),
        (SOUND + SUS + 'at = "start"\n', "before anything was done"),
        (SOUND + SUS + 'at = "end"\n', ""),
        (changed("practice = 1", "practice = 1\nshows = []"), "nobody is told what to do"),
    ],
)
def test_it_is_one_line_with_its_remedy(text: str, wanted: str) -> None:
    found = [finding.mistake for finding in findings(design(text))]
    assert len(found) == bool(wanted), found
    assert all(wanted in mistake.what and mistake.remedy for mistake in found)
