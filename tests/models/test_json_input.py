"""JSON from outside fits a struct, or one error of ours in one line says where it does not."""

from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Annotated, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import Meta, Struct

from models.errors import EncoderError, InputError
from models.json_input import checked, decoded, decoded_record, read_bytes
from tests.support.json_values import VALUES, damaged


class Mark(Struct, forbid_unknown_fields=True):
    """A struct inside another one."""

    id: int
    place: tuple[float, float]
    name: str | None = None


class Sheet(Struct):
    """A struct with one field of every kind that readers use."""

    marks: list[Mark]
    share: Annotated[float, Meta(ge=0, le=1)] = 0.0
    rows: dict[str, dict[int, tuple[bool, float]]] = {}

    def __post_init__(self) -> None:
        if self.share == 0.5:
            raise ValueError("a half is not allowed")


SOUND: dict[str, Any] = {
    "marks": [{"id": 1, "place": [0.5, 2]}, {"id": 2, "place": [1, 1], "name": "b"}],
    "share": 1,
    "rows": {"one": {"3": [True, 1.5]}, "two": {"4": [False, 2], "5": [True, 0]}},
    "more": None,
}


def read(text: str | bytes) -> Sheet:
    data = text.encode() if isinstance(text, str) else text
    return decoded(
        data,
        Sheet,
        EncoderError,
        what="the sheet is damaged",
        where="s.json",
        expected="marks",
        remedy="Make it anew",
    )


def test_values_that_fit_are_read() -> None:
    sheet = read(json.dumps(SOUND))
    assert sheet.marks[0] == Mark(1, (0.5, 2.0))
    assert sheet.rows["two"][5] == (True, 0.0)
    assert read(b"\xef\xbb\xbf" + json.dumps(SOUND).encode()) == sheet
    assert checked(SOUND, Sheet, EncoderError, what="x", where="y") == sheet


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("", "s.json"),
        ("[]", "s.json"),
        ('{"marks": [{"id": true}]}', "s.json, marks[0].id"),
        ('{"marks": [{"id": 1}]}', "s.json, marks[0]"),
        ('{"marks": [{"id": 1, "place": [1]}]}', "s.json, marks[0].place"),
        ('{"marks": [], "share": 2}', "s.json, share"),
        ('{"marks": [], "share": 0.5}', "s.json"),
        ('{"marks": [], "share": 1e999}', "s.json, share"),
        ('{"marks": [],\n\n "share": 1,}', "s.json, line 3"),
        (
            '{"marks": [], "rows": {"b": {"1": [true, 1], "2": [1, 1]}}}',
            "s.json, rows['b']['2'][0]",
        ),
        ('{"marks": [], "rows": {"b\\n": {"x": [true, 1]}}}', "s.json, rows['b\\n']['x']"),
        ('{"more": ' + "[" * 100_000, "s.json"),
    ],
)
def test_values_that_do_not_fit_are_reported_with_their_place(text: str, where: str) -> None:
    with pytest.raises(EncoderError) as caught:
        read(text)
    assert str(caught.value).startswith(f"{where}:") and "Make it anew" in str(caught.value)


def clear(error: InputError, where: str) -> bool:
    text = str(error)
    return where in text and len(text.splitlines()) == 1 and len(text) < 900


@given(VALUES)
def test_any_json_is_read_or_refused_with_one_clear_error(value: Any) -> None:
    was = deepcopy(value)
    for attempt in (
        lambda: read(json.dumps(value)),
        lambda: checked(value, Sheet, EncoderError, what="w", where="s.json"),
        lambda: decoded_record(json.dumps(value).encode(), EncoderError, what="w", where="s.json"),
    ):
        try:
            attempt()
        except EncoderError as error:
            assert clear(error, "s.json")
    assert repr(value) == repr(was)


@given(st.data())
def test_a_damaged_text_is_read_or_refused_with_one_clear_error(data: st.DataObject) -> None:
    text = data.draw(damaged(json.dumps(SOUND).encode()))
    for attempt in (
        lambda: read(text),
        lambda: decoded_record(text, EncoderError, what="w", where="s.json"),
    ):
        try:
            attempt()
        except EncoderError as error:
            assert clear(error, "s.json")


@given(VALUES, st.sampled_from(["one", "two", "three\n"]))
def test_one_wrong_field_of_many_is_found_and_the_value_stays_unchanged(
    value: Any, name: str
) -> None:
    sheet = {**SOUND, "rows": {**SOUND["rows"], name: value}}
    was = repr(sheet)
    try:
        checked(sheet, Sheet, EncoderError, what="w", where="s.json")
    except EncoderError as error:
        assert f"rows[{name!r}]" in str(error) and clear(error, "s.json")
    assert repr(sheet) == was


def test_records_of_this_program_may_hold_nan() -> None:
    assert repr(decoded_record(b'{"a": NaN}', InputError, what="w", where="x")) == "{'a': nan}"
    for data in (b"[]", b"{", b"\xff", b"[" * 100_000, b"1" * 5000):
        with pytest.raises(InputError, match="x: w"):
            decoded_record(data, InputError, what="w", where="x")


def test_a_file_is_read_up_to_a_size(tmp_path: Path) -> None:
    path = tmp_path / "f"
    path.write_bytes(b"12345")
    assert read_bytes(path, EncoderError, what="w", largest=5) == b"12345"
    for place, most in ((path, 4), (tmp_path, 5), (tmp_path / "none", 5), (Path("a\0b"), 5)):
        with pytest.raises(EncoderError, match="w"):
            read_bytes(place, EncoderError, what="w", largest=most)
