"""Loading of what other people define: the forms of a place, and errors of one line."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest

from models.errors import DeviceError, InputError
from models.outside import OutsideKind, Place, place_in

KIND = OutsideKind("lamp", "hand_sandbox.lamps", DeviceError, loaded="lit")


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("lab.py", Place("lab.py", None, None, True)),
        ("a b/lab.py:Pad", Place("a b/lab.py", "Pad", None, True)),
        ("lab.py:Pad:", Place("lab.py", "Pad", "", True)),
        ("lab.py:Pad:9:x", Place("lab.py", "Pad", "9:x", True)),
        ("my.lab:Pad", Place("my.lab", "Pad", None, False)),
        ("lab:Pad:9", Place("lab", "Pad", "9", False)),
        ("lab", None),
        ("run.jsonl", None),
        ("my-lab:Pad", None),
        ("lab.:Pad", None),
        ("lab:9", None),
    ],
)
def test_a_place_is_a_file_or_a_module_with_a_class_and_an_argument(
    text: str, place: Place | None
) -> None:
    assert place_in(text) == place


def classes_in(module: ModuleType) -> list[str]:
    return [name for name, value in vars(module).items() if isinstance(value, type)]


@pytest.mark.parametrize(
    ("body", "member", "says"),
    [
        ("1/0", "", "this lamp cannot be lit.*ZeroDivisionError"),
        ("class A: pass\nclass B: pass", "", "unclear which lamp.*A, B.*one lamp, or lab.py:CLASS"),
        ("x = 1", "", "unclear which lamp.*no lamp"),
        ("class A: pass", ":C", "nothing of this name.*'C'.*expected A"),
        ("def __getattr__(name): raise OSError(name)", ":C", "cannot be lit.*OSError: C"),
    ],
)
def test_what_cannot_be_loaded_is_told_in_one_line_by_an_error_of_its_kind(
    tmp_path: Path, body: str, member: str, says: str
) -> None:
    file = tmp_path / "lab.py"
    file.write_text(body)
    with pytest.raises(DeviceError, match=says) as error:
        KIND.load_place(place_in(f"{file}{member}"), classes_in)
    assert "\n" not in str(error.value)


def test_a_class_is_loaded_by_its_name_or_as_the_only_one_of_a_file(tmp_path: Path) -> None:
    file = tmp_path / "lamps.py"
    file.write_text("class Lamp: pass\n")
    for text in (f"{file}", f"{file}:Lamp"):
        thing, _ = KIND.load_place(place_in(text), classes_in)
        assert thing.__name__ == "Lamp"
    assert KIND.load_offered("nobody-offers-this") is None


def test_errors_of_this_project_pass_a_guard_unchanged() -> None:
    with pytest.raises(InputError, match=r"^as it was$"), KIND.guarded("here"):
        raise InputError("as it was")
    with pytest.raises(DeviceError, match="here: too dark"), KIND.guarded("here", "too dark"):
        raise KeyError
