"""Designs of studies as test data: sound ones in four languages, written in several styles of TOML,
with the line of every key."""

from __future__ import annotations

import json
from collections.abc import Mapping
from copy import deepcopy
from typing import Any

Path = tuple[str | int, ...]

TEXTS = {
    "en": (
        "We record your touches under a random code. You may stop at any time. Do you agree?",
        "Move each thing onto its twin and let go.",
        "How much effort was it?",
        "How old are you?",
        "About the last trials",
        ("none", "very much"),
    ),
    "de": (
        "Wir zeichnen Berührungen unter einem Code auf. Sie können jederzeit aufhören.",
        "Bringen Sie jedes Ding auf seinen Zwilling und lassen Sie los.",
        "Wie anstrengend war es?",
        "Wie alt sind Sie?",
        "Zu den letzten Durchgängen",
        ("gar nicht", "sehr"),
    ),
    "fr": (
        "Vos touches sont enregistrées sous un code. Vous pouvez arrêter à tout moment.",
        "Posez chaque objet sur son double, puis lâchez-le.",
        "Quel effort était-ce ?",
        "Quel âge avez-vous ?",
        "Sur les derniers essais",
        ("aucun", "beaucoup"),
    ),
    "ja": (
        "タッチを無作為な記号のもとに記録します。いつでもやめることができます。",
        "それぞれの物を薄い影の上に動かして、手を離してください。",
        "どのくらい大変でしたか。",
        "何歳ですか。",
        "いまの課題について",
        ("まったく", "とても"),
    ),
}
"""Consent, instruction, two questions, a title and two ends, by language."""


def sound(*languages: str) -> dict[str, Any]:
    """A sound design with texts in some languages, as the values of its file."""

    def text(which: int, part: int | None = None) -> Any:
        own = {code: TEXTS.get(code, TEXTS["en"])[which] for code in languages}
        words = {code: t if part is None else t[part] for code, t in own.items()}
        return words if len(words) > 1 else next(iter(words.values()))

    return {
        "name": "quick",
        "seed": 3,
        "participants": 24,
        "languages": list(languages),
        "settings": {"task": "tests/support/regress_tasks.py:Quick", "encoder": "linear"},
        "factors": [{"name": "contact", "order": "latin", "levels": ["hard", "soft"]}],
        "trials": {"repetitions": 3, "practice": 1, "practice_each": "contact"},
        "consent": {"text": text(0)},
        "instructions": [{"at": "start", "text": text(1)}],
        "demographics": [{"name": "age", "kind": "number", "low": 18, "ask": text(3)}],
        "questionnaires": [
            {
                "name": "effort",
                "at": "contact",
                "title": text(4),
                "items": [
                    {
                        "name": "effort",
                        "kind": "scale",
                        "step": 5,
                        "low_means": text(5, 0),
                        "high_means": text(5, 1),
                        "ask": text(2),
                    }
                ],
            }
        ],
        "exclusions": [{"name": "too-fast", "measure": "time_s", "below": 0.5}],
    }


TURN = {"name": "turn", "order": "random", "levels": [0, 90]}
KINDS: dict[str, dict[str, Any]] = {
    "one factor": {},
    "two factors": {"factors.1": TURN, "trials.practice": 2, "breaks": {"every": 4}},
    "groups": {"factors.0.order": "between", "analysis": {"primary": ["time_s", "effort"]}},
    "a level a session": {
        "sessions": 2,
        "factors.0.one_a_session": True,
        "questionnaires.1": {"use": "ueq-s", "at": "end"},
        "languages": ["en"],
    },
    "nested, in rounds": {
        "factors.1": {**TURN, "inside": "contact", "levels": {"hard": [0, 90], "soft": [90, 0]}},
        "trials.repeat_inside": "contact",
        "trials.practice": 2,
        "exclusions.1": {"name": "gone", "measure": "away_s", "above": 5},
    },
}
"""Kinds of sound designs: what each changes, by place."""


def changed(values: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A design with other values at some places, such as `factors.0.order`; None removes."""
    whole = deepcopy(dict(values))
    for place, value in changes.items():
        *parents, last = place.split(".")
        at: Any = whole
        for part in parents:
            at = at[int(part)] if isinstance(at, list) else at.setdefault(part, {})
        if isinstance(at, list):
            at[int(last) :] = [value]
        elif value is None:
            del at[last]
        else:
            at[last] = value
    return whole


COMMENT = '# """ \'\'\' [[factors]] { "name" = [ "x'
"""What a comment may have in it."""


def written(values: Mapping[str, Any], style: str) -> tuple[str, dict[Path, int]]:
    """The text of a design, and the line of each key and list item of a list of tables.

    Args:
        values: The values of the file.
        style: `tables`; `comments` with quotes and brackets in them; `inline` tables; `windows`
            with its line breaks; `marked` by a byte order mark.
    """
    lines: list[str] = []
    at: dict[Path, int] = {}

    def line(text: str, *paths: Path) -> None:
        if style == "comments":
            lines.append(COMMENT)
        lines.append(f"{text} {COMMENT}" if style == "comments" else text)
        at.update({path: len(lines) for path in paths if path not in at})

    def table(own: Mapping[str, Any], path: Path, heading: str) -> None:
        later = []
        for key, value in own.items():
            several = isinstance(value, list) and value and isinstance(value[0], dict)
            plain = style == "inline" or key in ("levels", "means")
            if several and style == "inline" and not path:
                line(f"{key} = [", (*path, key))
                for i, item in enumerate(value):
                    line(f"  {_inline(item)},", *_paths(item, (*path, key, i)))
                line("]")
            elif plain or not (several or isinstance(value, dict)):
                line(f"{_key(key)} = {_inline(value)}", *_paths(value, (*path, key)))
            else:
                later.append((key, value, several))
        for key, value, several in later:
            for i, item in enumerate(value if several else [value]):
                inner = (*path, key, i) if several else (*path, key)
                name = f"{heading}{_key(key)}"
                line(f"[[{name}]]" if several else f"[{name}]", (*path, key), inner)
                table(item, inner, f"{name}.")

    table(values, (), "")
    text = "\n".join(lines) + "\n"
    if style == "windows":
        text = text.replace("\n", "\r\n")
    return ("\ufeff" if style == "marked" else "") + text, at


STYLES = ("tables", "comments", "inline", "windows", "marked")


def _key(name: str) -> str:
    return name if name.replace("-", "").replace("_", "").isalnum() else json.dumps(name)


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def _paths(value: Any, path: Path) -> list[Path]:
    """Places within a value that is written on one line."""
    found = [path]
    inner: Any = value.items() if isinstance(value, dict) else ()
    if isinstance(value, list):
        inner = enumerate(value)
    for key, each in inner:
        found += _paths(each, (*path, key))
    return found
