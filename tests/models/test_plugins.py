"""Plug-ins are imported when they are named; errors of their code are one line."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import pytest

from models.errors import DeviceError, InputError
from models.plugins import Place, PluginKind, Registry, place_file, place_in


def is_class(value: object) -> bool:
    return isinstance(value, type)


BUILT_IN: Registry[type] = Registry({"desk": "decimal:Decimal", "none": "nobody_has_this:Lamp"})
KIND: PluginKind[type] = PluginKind(
    "lamp", "hand_sandbox.lamps", DeviceError, BUILT_IN, is_class, verb="lit"
)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("lab.py", Place("lab.py", None, None, True)),
        ("a b/lab.py:Pad", Place("a b/lab.py", "Pad", None, True)),
        ("lab.py:Pad:9:x", Place("lab.py", "Pad", "9:x", True)),
        ("my.lab:Pad", Place("my.lab", "Pad", None, False)),
        ("lab:Pad:9", Place("lab", "Pad", "9", False)),
        ("lab", None),
        ("my-lab:Pad", None),
        ("lab:9", None),
    ],
)
def test_a_place_is_a_file_or_a_module_with_a_class_and_an_argument(
    text: str, place: Place | None
) -> None:
    assert place_in(text) == place


@pytest.mark.parametrize(
    ("body", "member", "says"),
    [
        ("1/0", "", "this lamp cannot be lit.*ZeroDivisionError"),
        ("import sys; sys.exit()", "", "this lamp cannot be lit.*SystemExit"),
        (
            "class A: pass\nclass B: pass",
            "",
            "not define exactly one lamp.*A, B.*one lamp, or lab.py:CLASS",
        ),
        ("x = 1", "", "not define exactly one lamp.*no lamp"),
        ("class A: pass", ":C", "nothing of this name.*'C'.*expected A"),
        ("def __getattr__(name): raise OSError(name)", ":C", "cannot be lit.*OSError: C"),
    ],
)
def test_a_plugin_that_cannot_be_loaded_is_one_line_of_an_error_of_its_kind(
    tmp_path: Path, body: str, member: str, says: str
) -> None:
    file = tmp_path / "lab.py"
    file.write_text(body)
    with pytest.raises(DeviceError, match=says) as error:
        KIND.find(f"{file}{member}")
    assert "\n" not in str(error.value)


def test_a_class_is_loaded_from_a_file_a_module_or_a_registry(tmp_path: Path) -> None:
    file = tmp_path / "lamps.py"
    file.write_text("class Lamp: pass\n")
    for text in (f"{file}", f"{file}:Lamp"):
        lamp = KIND.find(text)
        assert lamp is not None and lamp.value.__name__ == "Lamp"
        assert place_file(text) == file and KIND.member_at(text) == "Lamp"
    for text in ("desk", "decimal:Decimal"):
        found = KIND.find(text)
        assert found is not None and found.value is Decimal and place_file(text) is None
    assert KIND.find("nobody-offers-this") is KIND.find("lamps.txt") is None


def test_a_registry_imports_what_is_looked_up_and_nothing_else() -> None:
    assert list(BUILT_IN) == ["desk", "none"] and "none" in BUILT_IN and len(BUILT_IN) == 2
    assert BUILT_IN["desk"] is Decimal
    with pytest.raises(ModuleNotFoundError):
        BUILT_IN["none"]
    BUILT_IN["own"] = int
    assert BUILT_IN["own"] is int
    del BUILT_IN["own"]
    assert "own" not in BUILT_IN


def test_an_argument_follows_a_name_or_a_place_where_the_kind_takes_one(tmp_path: Path) -> None:
    kind: PluginKind[type] = PluginKind(
        "lamp", "hand_sandbox.lamps", DeviceError, BUILT_IN, takes_argument=True
    )
    file = tmp_path / "lamps.py"
    file.write_text("class Lamp: pass\n")
    for text, argument in (("desk:9:x", "9:x"), (f"{file}:Lamp:red", "red"), ("desk", "")):
        found = kind.find(text)
        assert found is not None and found.argument == argument
    # What follows a built-in name is no class.
    assert kind.find("lamp:left") is kind.find(str(file)) is None
    assert KIND.find(f"{file}:Lamp:red") is None


def test_errors_of_this_project_pass_a_guard_unchanged() -> None:
    with pytest.raises(InputError, match=r"^as it was$"), KIND.guarded("here"):
        raise InputError("as it was")
    with pytest.raises(DeviceError, match="here: too dark"), KIND.guarded("here", "too dark"):
        raise KeyError
