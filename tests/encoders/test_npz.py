"""A file of arrays comes back as it was, or is refused in one error, whatever befell it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from encoders.npz import read_npz, write_npz
from models.errors import CaptureError
from tests.support.npz_files import claiming_too_much, header_of, rewritten, with_pickle

HEADER = {"schema": 1, "who": "nobody"}
RNG = np.random.default_rng(0)
ARRAYS: dict[str, NDArray[Any]] = {
    "q": RNG.normal(size=(40, 48)),
    "u": RNG.normal(size=(40, 15)).astype(np.float32),
}


def read(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    return read_npz(path, ARRAYS, CaptureError, "a capture", "Make it anew")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_npz(tmp_path / "c.npz", HEADER, ARRAYS)
    return tmp_path / "c.npz"


def assert_as_it_was(found: tuple[dict[str, Any], dict[str, Any]]) -> None:
    assert found[0] == HEADER
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(found[1][name], array)


def test_equal_contents_are_equal_files_and_come_back_to_the_bit(path: Path) -> None:
    assert_as_it_was(read(path))
    write_npz(path.with_name("again.npz"), HEADER, ARRAYS)
    assert path.with_name("again.npz").read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    "changes",
    [
        *({"header": header} for header in (None, header_of(""), header_of("{"), header_of("[1]"))),
        {"u": None},
    ],
)
def test_a_file_that_lacks_a_part_and_what_is_no_file_are_refused(
    path: Path, changes: dict[str, Any]
) -> None:
    rewritten(path, **changes)
    for each in (path, path.parent, path.with_name("none.npz")):
        with pytest.raises(CaptureError):
            read(each)


def test_nothing_is_unpickled(path: Path) -> None:
    with_pickle(path, "q")
    with pytest.raises(CaptureError, match="pickle"):
        read(path)


def test_a_file_that_would_fill_the_memory_is_refused_before_it_is_unpacked(path: Path) -> None:
    claiming_too_much(path)
    with pytest.raises(CaptureError, match="too large"):
        read(path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(share=st.floats(0, 0.999))
def test_a_truncated_file_is_refused(path: Path, share: float) -> None:
    whole = path.read_bytes()
    cut = path.with_name("cut.npz")
    cut.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(CaptureError):
        read(cut)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=250)
@given(where=st.floats(0, 1), value=st.binary(min_size=1, max_size=8))
def test_a_damaged_file_is_refused_or_reads_as_it_was(
    path: Path, where: float, value: bytes
) -> None:
    """The checksum of every part sees damage to it; zip's own fields may be immaterial."""
    data = bytearray(path.read_bytes())
    at = int(where * (len(data) - len(value)))
    data[at : at + len(value)] = value
    damaged = path.with_name("damaged.npz")
    damaged.write_bytes(data)
    try:
        found = read(damaged)
    except CaptureError as error:
        assert "damaged.npz" in str(error)
    else:
        assert_as_it_was(found)
