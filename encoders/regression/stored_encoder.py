"""Stores encoders in files as a header and arrays, and restores them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.encoder import Encoder
from encoders.regression.registry import (
    ENCODER_PLUGINS,
    ENCODERS,
    builtin_name,
    find_encoder,
    source_digest,
)
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.plugins import how_to_get, place_of
from models.pose import POSE_SIZE

EXTERNAL = "outside"
"""Kind of external encoders in a header."""

MODEL_ARRAYS = (
    "header",
    "covariance",
    "personal",
    "training_u",
    "training_pose",
    "anchors",
    "lengths",
    "tip_variance",
)
"""Names of the arrays in a model's file that do not belong to its encoder."""

SAME_POSE = 1e-3
"""m or rad, largest change of a pose that storing an encoder may cause."""

_TRIED = 100
"""Number of frames on which a restored encoder is tested."""


def header_fields(encoder: Encoder) -> dict[str, Any]:
    """Header fields of an encoder, as JSON values; with its arrays they define it completely."""
    ours = builtin_name(encoder)
    if ours is not None:
        return {"kind": ours, **encoder.configuration()}
    return {
        "kind": EXTERNAL,
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
    """Restores a stored encoder.

    Args:
        kind: Class of the encoder.
        options: Its configuration.
        arrays: Its learned arrays.
        U: (T, 15) training frames in single precision.
        Q: (T, 48) likewise.

    Raises:
        EncoderError: It cannot be restored.
    """
    with ENCODER_PLUGINS.guarded(kind.__qualname__, "the encoder does not take its own options"):
        encoder = kind(**options)
    with ENCODER_PLUGINS.guarded(
        kind.__qualname__, "the encoder cannot be restored from its arrays"
    ):
        complete: Encoder = encoder.restore(arrays, U.copy("K"), Q.copy("K"))
    return complete


def as_restored(encoder: Encoder, U: Array, Q: Array) -> Encoder:
    """The encoder as restored from a file.

    Args:
        encoder: A fitted encoder.
        U: (T, 15) training frames in single precision.
        Q: (T, 48) likewise.

    Raises:
        EncoderError: It cannot be stored, or the restored encoder differs.
    """
    ours = builtin_name(encoder)
    if ours is not None:
        return restored(ENCODERS[ours], encoder.configuration(), encoder.arrays(), U, Q)
    kind = type(encoder)
    where = kind.__qualname__
    with ENCODER_PLUGINS.guarded(where, "the encoder cannot be stored"):
        options = json.loads(json.dumps(encoder.configuration(), allow_nan=False))
        arrays = encoder.arrays()
    _check_arrays(arrays, where)
    loaded = restored(kind, options, arrays, U, Q)
    with ENCODER_PLUGINS.guarded(where, "the encoder cannot be stored"):
        same = loaded.digest() == encoder.digest()
    some = U[:_TRIED]
    moved = np.abs(predicted(loaded, some) - predicted(encoder, some)).max()
    # An encoder without stored arrays was fitted again, to rounded frames.
    if not arrays:
        check_repeatable(loaded, restored(kind, options, arrays, U, Q), some)
    if not same or (arrays and moved > SAME_POSE):
        raise EncoderError(
            "the encoder restored from its arrays differs from the original",
            where=where,
            got=f"poses that differ by up to {moved:.2g} m or rad" if same else "other arrays",
            remedy="restore must use everything that arrays and configuration return",
        )
    return loaded


def check_repeatable(first: Encoder, second: Encoder, U: Array) -> None:
    """Checks that two encoders fitted to equal frames predict equal poses.

    Args:
        first: One of them.
        second: The other.
        U: (T, 15) contact vectors of which both predict poses.

    Raises:
        EncoderError: They differ. A recording made with one could not be replayed with the other.
    """
    difference = np.abs(predicted(first, U) - predicted(second, U)).max()
    if difference > SAME_POSE:
        raise EncoderError(
            "two trainings on equal frames gave different encoders",
            where=f"{type(first).__qualname__}.fit",
            got=f"poses that differ by up to {difference:.2g} m or rad",
            remedy="Give random numbers a fixed seed, such as random_state=0 in scikit-learn",
        )


def predicted(encoder: Encoder, U: ArrayLike) -> Array:
    """Poses (T, 48) that an encoder predicts from contact vectors (T, 15), checked.

    Raises:
        EncoderError: The encoder fails, returns something else, or changes its input, for many
            vectors or for one.
    """
    U = np.asarray(U, float)
    where = f"{type(encoder).__qualname__}.predict"
    for rows, shape in ((U[0], (POSE_SIZE,)), (U, (len(U), POSE_SIZE))):
        given = rows.copy("K")
        with ENCODER_PLUGINS.guarded(
            where, f"the encoder cannot predict from U of shape {rows.shape}"
        ):
            poses = np.asarray(encoder.predict(given), float)
        if not np.array_equal(given, rows):
            raise EncoderError(
                "the encoder changes its input",
                where=where,
                remedy="Write `U = U - mean`, not `U -= mean`: others read the same array",
            )
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


def class_of_origin(source: Mapping[str, Any]) -> type[Encoder]:
    """Loads the class of an origin in a header (`encoders.regression.registry.origin`).

    Raises:
        EncoderError: The class does not exist on this machine.
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
    """Raises an error for arrays that cannot be written without pickle."""
    sound = isinstance(arrays, dict) and all(
        isinstance(name, str) and isinstance(array, np.ndarray) and array.dtype.kind in "biuf"
        for name, array in arrays.items()
    )
    if not sound:
        raise EncoderError(
            "the encoder does not store plain arrays",
            where=f"{where}.arrays",
            got=repr(arrays)[:80],
            expected="a dictionary of NumPy arrays of numbers by name",
        )
    odd = [name for name in arrays if name in MODEL_ARRAYS or not name.isidentifier()]
    if odd:
        raise EncoderError(
            "an array of the encoder has a reserved or invalid name",
            where=f"{where}.arrays",
            got=", ".join(odd),
            expected=f"an identifier other than {', '.join(MODEL_ARRAYS)}",
        )
