"""Captures on disk: npz without pickle, checked whole before anything of it is used."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np

from encoders.capture import Capture
from models.errors import CaptureError

SCHEMA = 1
"""Version of the file's layout."""

_ARRAYS = {"time": "f", "trial": "i", "ids": "i", "xy": "f", "q": "f"}


def save_capture(capture: Capture, path: Path, dtype: type[np.floating] = np.float64) -> None:
    """Writes a capture; `dtype` float32 halves the file and keeps 0.01 micrometre."""
    header = json.dumps({"schema": SCHEMA, **capture.meta})
    with path.open("wb") as file:
        np.savez_compressed(
            file,
            header=np.frombuffer(header.encode(), np.uint8),
            time=capture.time,
            trial=capture.trial,
            ids=capture.ids,
            xy=capture.xy.astype(dtype),
            q=capture.q.astype(dtype),
        )


def load_capture(path: Path) -> Capture:
    """Reads a capture.

    Raises:
        CaptureError: The file is missing, damaged, of another version, or breaks the contract.
    """
    where = str(path)
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in (*_ARRAYS, "header")}
    except FileNotFoundError:
        raise CaptureError("there is no such file", where=where) from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise CaptureError(
            "this is not a capture, or it is damaged",
            where=where,
            got=str(error),
            remedy="`sandbox subject --out FILE` makes a sound one",
        ) from error
    try:
        meta = json.loads(bytes(arrays.pop("header").tobytes()).decode())
        schema = meta.pop("schema")
    except (ValueError, KeyError, AttributeError) as error:
        raise CaptureError("the header is damaged", where=where) from error
    if schema != SCHEMA:
        raise CaptureError(
            "another version's capture", where=where, got=schema, expected=f"schema {SCHEMA}"
        )
    for name, kind in _ARRAYS.items():
        if arrays[name].dtype.kind != kind:
            raise CaptureError(
                "wrong type", where=f"{where}: {name}", got=arrays[name].dtype, expected=kind
            )
    return Capture(
        arrays["time"].astype(float),
        arrays["trial"].astype(np.int64),
        arrays["ids"].astype(np.int64),
        arrays["xy"].astype(float),
        arrays["q"].astype(float),
        meta,
    )
