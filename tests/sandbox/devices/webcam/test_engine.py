"""Fetching the engine: by version and SHA-256, whole or not at all. No network is used here."""

from __future__ import annotations

import gzip
import io
import os
import tarfile
import zipfile
from hashlib import sha256
from pathlib import Path

import pytest

from models.errors import DeviceError
from sandbox.cli.main import main
from sandbox.devices.webcam import engine

PARTS = ("hand_detector.tflite", "hand_landmarks_detector.tflite")


def archive() -> bytes:
    """An archive like npm's, with other contents, and the same bytes at any time of day."""
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w") as tar:
        for name in engine.FILES:
            if name not in (engine.MODEL, engine.LICENCE):
                entry = tarfile.TarInfo(f"package/{name}")
                entry.size = len(name)
                tar.addfile(entry, io.BytesIO(name.encode()))
    return gzip.compress(data.getvalue(), mtime=0)


def wheel() -> bytes:
    """A wheel like PyPI's, with other contents, and the same bytes at any time of day."""
    contents = {
        "mediapipe/modules/palm_detection/palm_detection_full.tflite": b"palm" * 99,
        "mediapipe/modules/hand_landmark/hand_landmark_full.tflite": b"hand" * 99,
        "mediapipe-0.10.21.dist-info/LICENSE": b"Apache",
    }
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as made:
        for name, content in contents.items():
            # A ZipInfo without a time has the year 1980.
            made.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return data.getvalue()


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user without anything installed."""
    monkeypatch.setattr(engine, "data_folder", lambda: tmp_path / "data")
    return tmp_path / "data"


@pytest.fixture
def index(monkeypatch: pytest.MonkeyPatch) -> None:
    """Indexes that have the archives above, which then are the right ones."""
    files = engine.engine_files(archive()) | engine.model_files(wheel())
    monkeypatch.setattr(
        engine, "FILES", {name: sha256(data).hexdigest() for name, data in files.items()}
    )
    monkeypatch.setattr(engine, "_from_npm", lambda place: archive())
    monkeypatch.setattr(engine, "_from_pypi", lambda place: wheel())
    monkeypatch.setattr(engine, "WHEEL_SHA256", sha256(wheel()).hexdigest())
    monkeypatch.setattr(engine, "ARCHIVE_SHA256", sha256(archive()).hexdigest())


def programs(folder: Path, **scripts: str) -> str:
    """A PATH with nothing but these programs."""
    folder.mkdir()
    for name, script in scripts.items():
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)
    return str(folder)


def test_the_model_is_a_zip_without_compression_and_the_same_bytes_every_time() -> None:
    files = engine.model_files(wheel())
    assert files == engine.model_files(wheel())
    with zipfile.ZipFile(io.BytesIO(files[engine.MODEL])) as model:
        assert tuple(model.namelist()) == PARTS
        assert {i.compress_type for i in model.infolist()} == {zipfile.ZIP_STORED}
        assert model.read(PARTS[0]) == b"palm" * 99


def test_another_package_of_the_same_version_is_refused(
    home: Path, index: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine, "_from_npm", lambda place: archive() + b"!")
    with pytest.raises(DeviceError, match="not as published"):
        engine.install(lambda line: None)
    assert not home.exists()


def test_what_is_fetched_is_kept_whole_and_not_fetched_again(
    home: Path, index: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = engine.install(lambda line: None)
    assert engine.installed_engine() == folder
    monkeypatch.setattr(engine, "_from_npm", lambda place: pytest.fail("it is there"))
    told: list[str] = []
    engine.install(told.append)
    assert told == [f"already there: {folder}"]


def test_a_damaged_file_is_noticed_and_mended(home: Path, index: None) -> None:
    folder = engine.install(lambda line: None)
    (folder / engine.MODEL).write_bytes(b"damaged")
    with pytest.raises(DeviceError, match="damaged"):
        engine.installed_engine()
    engine.install(lambda line: None)
    assert engine.installed_engine() == folder


def test_files_that_cannot_be_written_leave_what_was_there(home: Path, index: None) -> None:
    home.parent.joinpath("data").write_text("a file in the way")
    with pytest.raises(DeviceError, match="cannot be stored"):
        engine.install(lambda line: None)
    assert home.read_text() == "a file in the way"


def test_without_network_one_line_says_so(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = programs(tmp_path / "bin", npm='echo "npm error network unreachable" >&2; exit 1')
    monkeypatch.setenv("PATH", path + os.pathsep + "/usr/bin" + os.pathsep + "/bin")
    assert main(["devices", "webcam", "install"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "cannot be downloaded" in line and "network unreachable" in line
    assert not home.exists()


@pytest.mark.parametrize(
    ("index", "said"),
    [("http://127.0.0.1:1/", "only https"), ("https://127.0.0.1:1", "cannot be downloaded")],
)
def test_without_npm_an_index_must_be_asked_by_https_and_must_answer(
    index: str, said: str, home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", programs(tmp_path / "bin"))
    monkeypatch.setenv("NPM_CONFIG_REGISTRY", index)
    with pytest.raises(DeviceError, match=said):
        engine.install(lambda line: None)
