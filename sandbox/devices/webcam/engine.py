"""The engine that finds hands in pictures (MediaPipe): its folder and its installation."""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from hashlib import sha256
from html import unescape
from importlib.util import find_spec
from pathlib import Path
from urllib.error import URLError
from urllib.parse import urljoin
from urllib.request import Request, urlopen

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
"""Name of each required file -> its SHA-256."""

INSTALL = "`sandbox devices webcam install` installs it; this needs the network once"


def data_folder() -> Path:
    """Returns the folder for this user's data, as usual on this system."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = str(home() / "Library" / "Application Support")
    else:
        base = os.environ.get("XDG_DATA_HOME") or str(home() / ".local" / "share")
    return Path(base) / "hand-sandbox"


def engine_folder() -> Path:
    """Returns the engine's folder, whether it is installed or not."""
    return data_folder() / f"webcam-{ENGINE_VERSION}-{MODEL_VERSION}"


def digest(path: Path) -> str:
    """Returns the SHA-256 of a file; empty if it cannot be read."""
    try:
        return sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


def missing(folder: Path) -> list[str]:
    """Returns the engine's files that are missing in a folder."""
    return [name for name in FILES if not (folder / name).is_file()]


def damaged(folder: Path) -> list[str]:
    """Returns the engine's files that are missing in a folder, or not as published."""
    return [name for name, wanted in FILES.items() if digest(folder / name) != wanted]


def installed_engine() -> Path:
    """Returns the folder of the installed engine.

    Raises:
        DeviceError: The engine is not installed, or damaged.
    """
    folder = engine_folder()
    if lacking := missing(folder):
        raise DeviceError(
            "the engine that finds hands in pictures (MediaPipe) is not installed",
            where="--device webcam",
            got=f"no {lacking[0]} in {folder}",
            remedy=INSTALL,
        )
    if wrong := damaged(folder):
        raise DeviceError(
            "the engine that finds hands in pictures (MediaPipe) is damaged",
            where=str(folder / wrong[0]),
            got="another SHA-256 than published",
            remedy=INSTALL,
        )
    return folder


PACKAGE = "@mediapipe/tasks-vision"
ARCHIVE = f"mediapipe-tasks-vision-{ENGINE_VERSION}.tgz"
ARCHIVE_SHA256 = "84597a25e13d123b5f4cbe768bb72e97a2c28c7a465f0ace287d8cbe5246bff0"
WHEEL = f"mediapipe-{MODEL_VERSION}-cp311-cp311-manylinux_2_28_x86_64.whl"
WHEEL_SHA256 = "05dc4a9e593655a79558d05d6227d31018c2537a4bd3362b51e230cf22aecfe3"
"""The wheel that is used on all machines. Only its model is needed, and all wheels have the same.
"""

_IN_MODEL = {
    "hand_detector.tflite": "mediapipe/modules/palm_detection/palm_detection_full.tflite",
    "hand_landmarks_detector.tflite": "mediapipe/modules/hand_landmark/hand_landmark_full.tflite",
}
"""Name in the model's file -> name in the wheel."""
_LICENCE_IN_WHEEL = f"mediapipe-{MODEL_VERSION}.dist-info/LICENSE"

_LONGEST = 600.0
"""Timeout of a download, s."""
_LARGEST = 1 << 27
"""Largest number of bytes that is read of a download."""
_NPM, _PYPI = "https://registry.npmjs.org/", "https://pypi.org/simple/"
_LINK = re.compile(r'href="([^"]+)"')

Say = Callable[[str], None]


def install(say: Say) -> Path:
    """Downloads, checks and stores the engine; returns its folder.

    Args:
        say: Called with each line about the progress.

    Raises:
        DeviceError: A package cannot be downloaded or stored, or is not as published.
    """
    folder = engine_folder()
    if not damaged(folder):
        say(f"already there: {folder}")
        return folder
    with tempfile.TemporaryDirectory() as place:
        say(f"npm: {PACKAGE} {ENGINE_VERSION} (10 MB)")
        archive = checked(_from_npm(Path(place)), ARCHIVE_SHA256, PACKAGE)
        say(f"PyPI: mediapipe {MODEL_VERSION}, for its model (36 MB)")
        wheel = checked(_from_pypi(Path(place)), WHEEL_SHA256, "mediapipe")
    keep(engine_files(archive) | model_files(wheel), folder)
    if wrong := damaged(folder):
        raise DeviceError(
            "the stored engine is damaged",
            where=str(folder / wrong[0]),
            got="another SHA-256 than published",
            remedy="Check the disk, and install again",
        )
    return folder


def checked(data: bytes, wanted: str, name: str) -> bytes:
    """Returns the data after a check of its SHA-256.

    Raises:
        DeviceError: The SHA-256 is not `wanted`.
    """
    digest = sha256(data).hexdigest()
    if digest != wanted:
        raise DeviceError(
            "the package in the index is not as published",
            where=name,
            got=f"SHA-256 {digest[:16]}...",
            expected=f"{wanted[:16]}...",
            remedy="Nothing was installed. Ask the operator of the package index that npm or pip "
            "uses",
        )
    return data


def engine_files(archive: bytes) -> dict[str, bytes]:
    """Returns the required files of npm's archive, by the names under which they are stored."""
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        names = [name for name in FILES if name not in (MODEL, LICENCE)]
        files = {}
        for name in names:
            member = tar.extractfile(f"package/{name}")
            if member is None:
                raise DeviceError("the package lacks a file", where=PACKAGE, got=name)
            files[name] = member.read()
    return files


def model_files(wheel: bytes) -> dict[str, bytes]:
    """Returns the model, made from two files of PyPI's wheel, and the licence."""
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(wheel)) as source:
        with zipfile.ZipFile(made, "w", zipfile.ZIP_STORED) as model:
            for name, inside in _IN_MODEL.items():
                entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
                entry.create_system = 3  # the same bytes on every system
                model.writestr(entry, source.read(inside))
        licence = source.read(_LICENCE_IN_WHEEL)
    return {MODEL: made.getvalue(), LICENCE: licence}


def keep(files: dict[str, bytes], folder: Path) -> None:
    """Replaces a folder by one with these files; after an error, the folder is unchanged.

    Raises:
        DeviceError: The files cannot be written.
    """
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as place:
            fresh = Path(place) / "engine"
            for name, data in files.items():
                path = fresh / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
            if folder.exists():
                shutil.rmtree(folder)
            fresh.rename(folder)
    except OSError as error:
        raise DeviceError(
            "the engine cannot be stored",
            where=str(folder),
            got=error.strerror or str(error),
            remedy="Check the permissions of the folder, and free space on the disk",
        ) from None


def _from_npm(place: Path) -> bytes:
    if npm := shutil.which("npm"):
        _run([npm, "pack", f"{PACKAGE}@{ENGINE_VERSION}", "--silent"], place, "npm")
        return (place / ARCHIVE).read_bytes()
    index = os.environ.get("NPM_CONFIG_REGISTRY") or _NPM
    name = f"{PACKAGE}/-/{PACKAGE.partition('/')[2]}-{ENGINE_VERSION}.tgz"
    return _fetched(urljoin(_folder(index), name))


def _from_pypi(place: Path) -> bytes:
    if find_spec("pip") is not None:
        tags = WHEEL.removesuffix(".whl").split("-")[2:]
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary=:all:", "--platform", tags[2], "--implementation", "cp"]
        command += ["--python-version", tags[0].removeprefix("cp"), "--abi", tags[1]]
        _run([*command, f"mediapipe=={MODEL_VERSION}"], place, "pip")
        return (place / WHEEL).read_bytes()
    index = urljoin(_folder(os.environ.get("PIP_INDEX_URL") or _PYPI), "mediapipe/")
    for link in _LINK.findall(_fetched(index).decode(errors="replace")):
        address = urljoin(index, unescape(link)).partition("#")[0]
        if address.endswith(f"/{WHEEL}"):
            return _fetched(address)
    raise DeviceError(
        "the package index does not have the model's package",
        where=index,
        expected=WHEEL,
        remedy="Install pip, or set PIP_INDEX_URL to an index that has it",
    )


def _folder(address: str) -> str:
    return address if address.endswith("/") else f"{address}/"


def _run(command: list[str], place: Path, name: str) -> None:
    """Runs npm or pip in a folder."""
    try:
        done = subprocess.run(
            command,
            cwd=place,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_LONGEST,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise _unfetched(name, type(error).__name__) from None
    if done.returncode:
        # Show the first line that mentions an error.
        lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        told = [line for line in lines if "error" in line.lower()] or lines
        raise _unfetched(name, told[0][:160] if told else f"exit status {done.returncode}")


def _fetched(address: str) -> bytes:
    if not address.startswith("https://"):
        raise DeviceError(
            "only https addresses of a package index are used",
            where=address,
            expected="https://...",
        )
    try:
        asked = Request(address, headers={"User-Agent": "hand-sandbox"})
        with urlopen(asked, timeout=_LONGEST) as answer:
            data: bytes = answer.read(_LARGEST)
    except (URLError, OSError, ValueError) as error:
        reason = error.reason if isinstance(error, URLError) else error
        raise _unfetched(address, str(reason)[:160]) from None
    return data


def _unfetched(where: str, got: str) -> DeviceError:
    return DeviceError(
        "the engine cannot be downloaded",
        where=where,
        got=got,
        remedy="Check the network connection, and install again. Nothing was installed",
    )
