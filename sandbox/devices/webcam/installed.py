"""The engine that finds hands: which files it has, and where this user keeps them.

`sandbox devices webcam install` brings them (`sandbox.devices.webcam.install`). Nothing of it comes
with this program. All of it is Google's MediaPipe, under the Apache licence 2.0. Later versions of
both packages report their use to Google, and are therefore not for studies.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

from models.errors import DeviceError
from sandbox.system.files import home

ENGINE_VERSION, MODEL_VERSION = "0.10.35", "0.10.21"
"""Versions of npm's @mediapipe/tasks-vision, and of PyPI's mediapipe, whose model is used."""

MODEL = "hand_landmarker.task"
LICENCE = "LICENSE"
FILES: Mapping[str, str] = {
    "vision_bundle.mjs": "55d7ab624fbb70dcc5adc4ae6d7ea9cfcb569139d3dbfbf2b1deafcb966bc0fe",
    "wasm/vision_wasm_internal.js": "e7fd9858e8e8f221d9b96eddc11f8e077f263e0b7bbd79d3cbe882b134274f8c",  # noqa: E501
    "wasm/vision_wasm_internal.wasm": "6a5c64584c2ab61c763b6e204afbdbc7ce1caf7f5216187322bca8df94f646bc",  # noqa: E501
    "wasm/vision_wasm_nosimd_internal.js": "438d1fe8ff7f4d946025bc211c291543c037d8a3785ed4eee60f1f521b236296",  # noqa: E501
    "wasm/vision_wasm_nosimd_internal.wasm": "8a3092d34c79d3f57e6ba8592105e8a90f6b07c27891ffecd14cca428bfd3e31",  # noqa: E501
    "package.json": "5c96247445e57a2d087758114b116fed7d46eb401342aee19b1acc56d36fe707",
    MODEL: "ef3f184fa8d5e6905ea4770282627d6937975119af763054312d05985c059bda",
    LICENCE: "8707eef0533987efc5b155d64761eeb6e20793f50b9bd1a68dad1cf4719d0ed8",
}
"""Name of each file that is kept -> its SHA-256."""

INSTALL = "`sandbox devices webcam install` brings it, once, with the network"


def data_folder() -> Path:
    """The folder for this user's data, in the system's place for such folders."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = str(home() / "Library" / "Application Support")
    else:
        base = os.environ.get("XDG_DATA_HOME") or str(home() / ".local" / "share")
    return Path(base) / "hand-sandbox"


def engine_folder() -> Path:
    """Where the engine is kept, installed or not."""
    return data_folder() / f"webcam-{ENGINE_VERSION}-{MODEL_VERSION}"


def digest(path: Path) -> str:
    """SHA-256 of a file; empty if it cannot be read."""
    try:
        return sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


def missing(folder: Path) -> list[str]:
    """Files of the engine that a folder lacks."""
    return [name for name in FILES if not (folder / name).is_file()]


def damaged(folder: Path) -> list[str]:
    """Files of the engine that a folder lacks, or whose contents are not as published."""
    return [name for name, wanted in FILES.items() if digest(folder / name) != wanted]


def installed_engine() -> Path:
    """The folder of the installed engine.

    Raises:
        DeviceError: It is not installed, or damaged.
    """
    folder = engine_folder()
    if lacking := missing(folder):
        raise DeviceError(
            "what finds hands in pictures is not installed",
            where="--device webcam",
            got=f"no {lacking[0]} in {folder}",
            remedy=INSTALL,
        )
    if wrong := damaged(folder):
        raise DeviceError(
            "what finds hands in pictures is damaged",
            where=str(folder / wrong[0]),
            got="another SHA-256",
            remedy=INSTALL,
        )
    return folder
