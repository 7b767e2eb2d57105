"""Encoders as a file holds them: what describes one, and how it is made again from its arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.discovery import guarded, source_digest
from encoders.encoder import Encoder
from encoders.regression.registry import ENCODERS, find_encoder, kind_of
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.outside import how_to_get, place_of
from models.pose import POSE_SIZE

OUTSIDE = "outside"
"""What a header calls an encoder that is not ours."""

MODEL_ARRAYS = (
    "header",
    "covariance",
    "training_u",
    "training_pose",
    "anchors",
    "lengths",
    "tip_variance",
)
"""Names of arrays in a model's file that are not the encoder's."""

SAME_POSE = 1e-3
"""m or rad, most by which poses may change by storing an encoder."""

_TRIED = 100
"""Frames on which an encoder is tried."""


def described(encoder: Encoder) -> dict[str, Any]:
    """What a header says of an encoder; with its arrays, all of it. JSON values only."""
    ours = kind_of(encoder)
    if ours is not None:
        return {"kind": ours, **encoder.configuration()}
    return {
        "kind": OUTSIDE,
        "class": type(encoder).__qualname__,
        "source": source_digest(type(encoder)),
        "configuration": encoder.configuration(),
        "encoder": encoder.digest(),
    }


def restored(
    kind: type[Encoder],
    options: Mapping[str, Any],
    arrays: Mapping[str, NDArray[Any]],
    U: Array,
    Q: Array,
) -> Encoder:
    """An encoder made again from what is stored.

    Args:
        kind: Its class.
        options: Its configuration.
        arrays: What it has learned.
        U: (T, 15) training frames in single precision.
        Q: (T, 48) likewise.

    Raises:
        EncoderError: It cannot be made again.
    """
    with guarded("the encoder does not take its own options", kind.__qualname__):
        encoder = kind(**options)
    with guarded("the encoder cannot be made again from its arrays", kind.__qualname__):
        found: Encoder = encoder.restore(arrays, U, Q)
    return found


def as_stored(encoder: Encoder, U: Array, Q: Array) -> Encoder:
    """The encoder as it comes back from a file.

    Args:
        encoder: A fitted one.
        U: (T, 15) training frames in single precision.
        Q: (T, 48) likewise.

    Raises:
        EncoderError: It cannot be stored, or comes back as another one.
    """
    ours = kind_of(encoder)
    if ours is not None:
        return restored(ENCODERS[ours], encoder.configuration(), encoder.arrays(), U, Q)
    kind = type(encoder)
    where = kind.__qualname__
    with guarded("the encoder cannot be stored", where):
        options = json.loads(json.dumps(encoder.configuration(), allow_nan=False))
        arrays = encoder.arrays()
    _check_arrays(arrays, where)
    found = restored(kind, options, arrays, U, Q)
    with guarded("the encoder cannot be stored", where):
        same = found.digest() == encoder.digest()
    some = U[:_TRIED]
    moved = np.abs(predicted(found, some) - predicted(encoder, some)).max()
    # One that stores nothing has learned anew, from frames that were rounded.
    if not same or (arrays and moved > SAME_POSE):
        raise EncoderError(
            "the encoder does not come back from its arrays as it was",
            where=where,
            got=f"poses that differ by up to {moved:.2g} m or rad" if same else "other arrays",
            remedy="restore must take over all that arrays and configuration give",
        )
    return found


def predicted(encoder: Encoder, U: ArrayLike) -> Array:
    """Poses (T, 48) that an encoder predicts of contact vectors (T, 15), checked.

    Raises:
        EncoderError: It fails, or gives something else; for all together or for one alone.
    """
    U = np.asarray(U, float)
    where = f"{type(encoder).__qualname__}.predict"
    for rows, shape in ((U[0], (POSE_SIZE,)), (U, (len(U), POSE_SIZE))):
        with guarded("the encoder cannot predict", where):
            poses = np.asarray(encoder.predict(rows), float)
        if poses.shape != shape:
            raise EncoderError(
                "the encoder predicts poses of another shape",
                where=where,
                got=f"{poses.shape} of inputs {rows.shape}",
                expected=str(shape),
            )
        if not np.isfinite(poses).all():
            raise EncoderError("the encoder predicts poses that are not finite", where=where)
    return poses


def found_again(source: Mapping[str, Any]) -> type[Encoder]:
    """The class that a header tells the origin of (`encoders.regression.registry.origin`).

    Raises:
        EncoderError: It is not on this machine.
    """
    place = place_of(source)
    try:
        return find_encoder(place)
    except EncoderError as error:
        raise EncoderError(
            "its encoder is not on this machine",
            got=str(error),
            expected=place,
            remedy=how_to_get(source),
        ) from error


def _check_arrays(arrays: Any, where: str) -> None:
    """Refuses what cannot be written without pickle."""
    sound = isinstance(arrays, dict) and all(
        isinstance(name, str) and isinstance(array, np.ndarray) and array.dtype.kind in "biuf"
        for name, array in arrays.items()
    )
    if not sound:
        raise EncoderError(
            "what the encoder stores are no arrays",
            where=f"{where}.arrays",
            got=repr(arrays)[:80],
            expected="a dictionary of NumPy arrays of numbers by name",
        )
    odd = [name for name in arrays if name in MODEL_ARRAYS or not name.isidentifier()]
    if odd:
        raise EncoderError(
            "an array of the encoder has a name that it cannot have",
            where=f"{where}.arrays",
            got=", ".join(odd),
            expected=f"an identifier other than {', '.join(MODEL_ARRAYS)}",
        )
