"""JSON from files, other programs and the network, read into msgspec structs.

A struct defines the fields of a value, and their types and ranges. A value that does not fit raises
one of our errors, which names the file, the line or field, the actual and the expected value.
"""

from __future__ import annotations

import json
import re
import reprlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import msgspec

from models.errors import HandSandboxError

T = TypeVar("T")

LARGEST = 1 << 26
"""Bytes of the largest file that is read whole."""

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_LONGEST = 40
"""Characters of a wrong value that a message shows."""

_PLAIN = {
    "int": "a whole number",
    "float": "a number",
    "str": "a text",
    "bool": "true or false",
    "null": "null",
    "array": "a list",
    "object": "an object",
}
"""Words for msgspec's names of types."""

_RELATIONS = {"<=": "at most", ">=": "at least", "<": "below", ">": "above"}

_UNREADABLE = (msgspec.MsgspecError, UnicodeError, RecursionError)
_BYTE = re.compile(r"JSON is malformed: (.*) \(byte (\d+)\)")
_PLACE = re.compile(r"(.*?) - at (`key` in )?`\$(.*)`", re.DOTALL)
_STEP = re.compile(r"\.([^.\[\]]+)|\[(\d+)\]|\[\.\.\.\]")
_EXPECTED = re.compile(r"Expected (.*?)(?:, got .*)?", re.DOTALL)
_LACKING = re.compile(r"Object missing required field `(.*)`", re.DOTALL)
_UNKNOWN = re.compile(r"Object contains unknown field `(.*)`", re.DOTALL)


def read_bytes(
    path: Path,
    error: type[HandSandboxError],
    *,
    what: str,
    largest: int = LARGEST,
    remedy: str | None = None,
) -> bytes:
    """Reads a file of limited size.

    Args:
        path: The file.
        error: The class of the error.
        what: Clause of the message for a file that cannot be read.
        largest: Bytes beyond which a file is refused.
        remedy: Next step in the message.

    Raises:
        HandSandboxError: The file cannot be read, or it is too large. Its class is `error`.
    """
    try:
        with path.open("rb") as file:
            data = file.read(largest + 1)
    except (OSError, ValueError) as problem:
        got = problem.strerror if isinstance(problem, OSError) else str(problem)
        raise error(what, where=str(path), got=got, remedy=remedy) from None
    if len(data) > largest:
        raise error(
            f"{what}: it is too large",
            where=str(path),
            expected=f"at most {largest} bytes",
            remedy=remedy,
        )
    return data


def numbered_lines(path: Path, longest: int) -> Iterator[tuple[int, bytes]]:
    """Yields the lines of a file that are not blank, with their numbers from 1.

    Args:
        path: The file.
        longest: Bytes beyond which a line is split; neither part is then valid JSON.

    Raises:
        OSError: The file cannot be read.
    """
    with path.open("rb") as file:
        number = 0
        while line := file.readline(longest):
            number += 1
            if line.strip():
                yield number, line


def whole_json(data: bytes) -> bool:
    """True if a text is complete JSON. NaN and Infinity, which some programs write, are
    accepted."""
    try:
        any_json(data)
    except _UNREADABLE:
        return False
    return True


def any_json(data: bytes) -> Any:
    """The value of a JSON text, which may deviate from the standard as other programs do.

    NaN and Infinity are numbers, and names that are not UTF-8 are read as Latin-1.

    Raises:
        msgspec.DecodeError: The text is not JSON.
        RecursionError: The text is nested too deeply.
    """
    try:
        return msgspec.json.decode(data)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        try:
            text = data.decode()
        except UnicodeDecodeError:
            text = data.decode("latin-1")
        else:
            if "NaN" not in text and "Infinity" not in text:
                raise
        try:
            return json.loads(text)
        except ValueError:
            raise msgspec.DecodeError(str(error)) from None


def decoded(
    data: bytes,
    form: type[T],
    error: type[HandSandboxError],
    *,
    what: str,
    where: str,
    expected: str | None = None,
    remedy: str | None = None,
) -> T:
    """Decodes JSON and checks it against a type.

    NaN, Infinity, numbers beyond the range of a float and values nested too deeply are refused. Of
    two fields with the same name, the last one is used. A byte order mark is skipped.

    Args:
        data: JSON, UTF-8.
        form: A struct, or another type that msgspec decodes.
        error: The class of the error.
        what: Clause of the message for data that do not fit.
        where: The file. For files with one value per line, also the line.
        expected: Expected form of the whole, for errors that concern no single field.
        remedy: Next step in the message.

    Raises:
        HandSandboxError: The data do not fit. Its class is `error`.
    """
    data = data.removeprefix(_BYTE_ORDER_MARK)
    try:
        return msgspec.json.decode(data, type=form)
    except _UNREADABLE as problem:
        fault = _fault_of_text(data, problem, form)
        raise _error(fault, error, what, where, expected, remedy) from None


def checked(
    value: Any,
    form: type[T],
    error: type[HandSandboxError],
    *,
    what: str,
    where: str,
    expected: str | None = None,
    remedy: str | None = None,
) -> T:
    """Checks a decoded value, such as TOML or a part of a larger file.

    Args:
        value: Dictionaries, lists, strings, numbers, booleans and None.
        form, error, what, where, expected, remedy: See `decoded`.

    Raises:
        HandSandboxError: The value does not fit. Its class is `error`.
    """
    try:
        return _converted(value, form)
    except _UNREADABLE as problem:
        fault = _fault(value, problem, form)
        raise _error(fault, error, what, where, expected, remedy) from None


def loosely_decoded(data: bytes) -> Any:
    """A JSON value; None if the data are not JSON. As in Python's JSON, a number may be NaN or
    infinite; text may consist of any bytes."""
    try:
        return json.loads(data.removeprefix(_BYTE_ORDER_MARK).decode(errors="replace"))
    except (ValueError, RecursionError):
        return None


def converted(value: object, form: type[T]) -> T | None:
    """A decoded value, converted to a type; None if it does not fit the type."""
    try:
        return msgspec.convert(value, form)
    except (msgspec.ValidationError, OverflowError):
        return None


def check_layout(
    data: bytes,
    kind: str | None,
    schema: int,
    error: type[HandSandboxError],
    *,
    what: str,
    where: str,
    remedy: str | None = None,
) -> None:
    """Checks that a file has the expected kind and version, and no key twice in one object.

    Args:
        data: JSON, UTF-8: an object with `kind` and `schema`.
        kind: Expected value of `kind`; None for files without it.
        schema: Expected version.
        error: The class of the error.
        what: Clause of the message for a file of another kind.
        where, remedy: See `decoded`.

    Raises:
        HandSandboxError: The file is of another kind or version. Its class is `error`.
    """
    expected = f'"kind": "{kind}"' if kind is not None else None
    if twice := _twice(data):
        raise error(
            "an object contains a key twice, with different values",
            where=where,
            got=twice,
            remedy=f"Two versions were merged. {remedy}" if remedy else "Two versions were merged",
        )
    head = decoded(data, _Head, error, what=what, where=where, expected=expected, remedy=remedy)
    if kind is not None and head.kind != kind:
        raise error(what, where=where, expected=expected, remedy=remedy)
    if head.schema != schema:
        raise error(
            "the file has another version",
            where=f"{where}, schema",
            got=_shortened(head.schema),
            expected=f"version {schema}",
            remedy=remedy,
        )


def _twice(data: bytes) -> str:
    """A key that an object contains twice with different values; empty without such a key, and for
    data that are not JSON."""
    found: list[str] = []

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for key, value in pairs:
            if key in values and values[key] != value:
                found.append(key)
            values[key] = value
        return values

    try:
        json.loads(data, object_pairs_hook=unique)
    except (ValueError, RecursionError):
        return ""
    return found[0] if found else ""


class _Head(msgspec.Struct):
    """The fields that identify a file, with values of any type."""

    kind: Any = None
    schema: Any = None


def decoded_record(
    data: bytes, error: type[HandSandboxError], *, what: str, where: str, remedy: str | None = None
) -> dict[str, Any]:
    """Decodes an object with arbitrary fields that this program has written.

    It uses `json` instead of msgspec, because a measure of a custom task may be NaN. `json` writes
    and reads NaN although the JSON standard does not allow it.

    Args:
        data: JSON, UTF-8.
        error, what, where, remedy: See `decoded`.

    Raises:
        HandSandboxError: The data are not a JSON object. Its class is `error`.
    """
    try:
        value = json.loads(data)
    except (ValueError, RecursionError) as problem:
        fault = _fault_of_text(data, problem, dict[str, Any])
        raise _error(fault, error, what, where, None, remedy) from None
    return checked(value, dict[str, Any], error, what=what, where=where, remedy=remedy)


class _Fault(NamedTuple):
    """Describes the error in a value.

    Attributes:
        clause: Clause to add to the message; may be empty.
        place: Line or field; empty for the whole value.
        got: The actual value.
        expected: The expected value.
    """

    clause: str = ""
    place: str = ""
    got: object = None
    expected: str | None = None


def _error(
    fault: _Fault,
    error: type[HandSandboxError],
    what: str,
    where: str,
    expected: str | None,
    remedy: str | None,
) -> HandSandboxError:
    return error(
        f"{what}: {fault.clause}" if fault.clause else what,
        where=f"{where}, {fault.place}" if fault.place else where,
        got=fault.got,
        expected=fault.expected or expected,
        remedy=remedy,
    )


def _converted(value: Any, form: type[T]) -> T:
    return msgspec.convert(value, form, str_keys=True)


def _fault_of_text(data: bytes, problem: Exception, form: Any) -> _Fault:
    """The fault of a text that could not be decoded."""
    if isinstance(problem, msgspec.ValidationError):
        try:
            value = msgspec.json.decode(data)
        except msgspec.ValidationError:
            # A number is too large for any decoded value, so there is no value to inspect.
            return _fault(None, problem, form)
        except _UNREADABLE as other:
            return _fault_of_text(data, other, form)
        return _fault(value, problem, form)
    if isinstance(problem, UnicodeError):
        return _Fault("it is not UTF-8")
    if isinstance(problem, RecursionError):
        return _Fault("it is nested too deep")
    malformed = _BYTE.fullmatch(str(problem))
    if isinstance(problem, json.JSONDecodeError):
        reason, byte = problem.msg, len(problem.doc[: problem.pos].encode(errors="replace"))
    elif malformed is not None:
        reason, byte = malformed[1], int(malformed[2])
    else:
        got = data[-_LONGEST:].decode(errors="replace") or None
        return _Fault("it is not JSON, or it is cut short", got=got)
    line = data.count(b"\n", 0, byte) + 1
    return _Fault(
        f"it is not JSON, {reason[0].lower()}{reason[1:]}",
        f"line {line}" if b"\n" in data.strip() else "",
        data[byte : byte + _LONGEST].decode(errors="replace") or None,
    )


def _fault(value: Any, problem: Exception, form: Any) -> _Fault:
    """The fault of a decoded value that does not fit its type."""
    if isinstance(problem, RecursionError):
        return _Fault("it is nested too deep")
    text = str(problem)
    place = _PLACE.fullmatch(text)
    message, path = (place[1], place[3]) if place else (text, "")
    field, actual = _field_at(value, path, text, form, place is not None and place[2] is not None)
    if lacking := _LACKING.fullmatch(message):
        return _Fault(f"{_name(lacking[1])} is missing", field)
    if unknown := _UNKNOWN.fullmatch(message):
        return _Fault(f"{_name(unknown[1])} is not known here", field)
    if wanted := _EXPECTED.fullmatch(message):
        return _Fault("", field, _shortened(actual), in_plain_words(wanted[1]))
    if message.startswith("Invalid enum value"):
        return _Fault("this value is not known here", field, _shortened(actual))
    if message.endswith("out of range"):
        return _Fault("the number is too large", field)
    # This message comes from a struct's own check.
    return _Fault(" ".join(message.split())[:200], field)


def _field_at(value: Any, path: str, text: str, form: Any, key: bool) -> tuple[str, Any]:
    """Name and value of the field at a path in an error of msgspec.

    msgspec writes `[...]` for a field of an object with arbitrary fields. Such a field is found by
    trial: with this field alone, the object must give the same error.

    Args:
        value: The whole value; it is modified temporarily.
        path: Path in msgspec's error, without `$`.
        text: Text of msgspec's error.
        form: The type that the value does not fit.
        key: True if the name of a field is wrong, not its value.
    """
    steps = [match.group(1, 2) for match in _STEP.finditer(path)]
    if key:
        steps.append((None, None))
    current, name, tried = value, "", ""
    emptied: list[tuple[dict[str, Any], dict[str, Any]]] = []
    try:
        for field, index in steps:
            if field is not None and isinstance(current, dict) and field in current:
                current, name = current[field], f"{name}.{field}" if name else field
            elif (
                index is not None
                and isinstance(current, list | tuple)
                and int(index) < len(current)
            ):
                current, name = current[int(index)], f"{name}[{index}]"
            elif field is None and index is None and isinstance(current, dict):
                emptied.append((current, dict(current)))
                tried = _culprit(current, lambda: _msgspec_error(value, form) == _without_got(text))
                current, name = current.get(tried), f"{name}[{tried[:_LONGEST]!r}]"
            else:
                # The value itself could not be decoded.
                return path.lstrip("."), None
    finally:
        for container, items in reversed(emptied):
            container.clear()
            container.update(items)
    return name, tried if key else current


def _culprit(items: dict[str, Any], same: Callable[[], bool]) -> str:
    """First field that alone gives the same error; the object is left with this field only."""
    for name, inner in list(items.items()):
        items.clear()
        items[name] = inner
        if same():
            return name
    return "..."


def _msgspec_error(value: Any, form: Any) -> str:
    """Error of msgspec for a value; empty if the value fits."""
    try:
        _converted(value, form)
    except _UNREADABLE as problem:
        return _without_got(str(problem))
    return ""


def _without_got(text: str) -> str:
    """An error of msgspec without the actual value, which it phrases in two ways."""
    return re.sub(r", got .*?(?= - at |$)", "", text)


def in_plain_words(expected: str) -> str:
    """Expected type in an error of msgspec, in plain words."""

    def words(match: re.Match[str]) -> str:
        return " or ".join(_PLAIN.get(name, name) for name in match[1].split(" | "))

    plain = re.sub(r"`([^`]*)`", words, expected)
    for sign, word in _RELATIONS.items():
        plain = plain.replace(f" {sign} ", f" {word} ")
    return plain


def _name(field: str) -> str:
    """The name of a field in an error, quoted unless it is a plain word."""
    return field[:_LONGEST] if field.isidentifier() else repr(field[:_LONGEST])


def _shortened(value: Any) -> object:
    """A wrong value for a message, shortened."""
    if isinstance(value, str):
        return value[:_LONGEST]
    if value is None or isinstance(value, bool):
        return json.dumps(value)
    if isinstance(value, int | float):
        return value if abs(value) < 1e15 else repr(value)[:_LONGEST]
    return reprlib.repr(value)[:_LONGEST]
