"""Models of earlier releases: an index that leads to what it says, or one clear error."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import encoders.earlier.encoders
import encoders.kept
from encoders.earlier.encoders import kept_encoder
from encoders.kept import INDEX, kept_model, kept_models
from encoders.regression.trained import builtin, builtin_folder
from models.errors import EncoderError


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of kept models with `population`, which brings its training data."""
    shutil.copy(builtin_folder() / "population.npz", tmp_path)
    values = {"kind": "encoder", "name": "population", "file": "population.npz"}
    index = {builtin("population").digest: values, "0" * 32: values}
    (tmp_path / INDEX).write_text(json.dumps(index))
    for module in (encoders.kept, encoders.earlier.encoders):
        monkeypatch.setattr(module, "kept_folder", lambda: tmp_path)
    kept_encoder.cache_clear()
    return tmp_path


def test_a_kept_encoder_is_found_by_its_digest(folder: Path) -> None:
    digest = builtin("population").digest
    assert kept_encoder(digest).digest == digest


def test_a_file_that_is_not_what_the_index_says_is_refused(folder: Path) -> None:
    with pytest.raises(EncoderError, match="damaged"):
        kept_encoder("0" * 32)


def test_what_is_not_kept_is_one_error_that_names_the_index(folder: Path) -> None:
    for digest, kind in (("1" * 32, "encoder"), ("0" * 32, "population")):
        with pytest.raises(EncoderError, match=INDEX):
            kept_model(digest, kind)


@pytest.mark.parametrize("text", ["", "[]", '{"a": 1}', '{"a": {"colour": "red"}}', "{"])
def test_a_damaged_index_is_one_clear_error(folder: Path, text: str) -> None:
    (folder / INDEX).write_text(text)
    with pytest.raises(EncoderError, match="index of kept models is damaged"):
        kept_models()
