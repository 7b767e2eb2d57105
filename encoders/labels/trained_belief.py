"""The trained model of the belief over labels, stored as arrays that are checked before use."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labels.finger_order import ORDERED_COUNTS
from encoders.labels.label_evidence import ASSUMED, LabelEvidence
from encoders.labels.label_sums import LEAST
from encoders.labels.layout_density import KernelShape, Layouts, finger_sets
from encoders.labels.recent_liftoffs import AT_ONCE, LATER, REACH
from encoders.npz import read_npz, write_npz
from models.errors import EncoderError
from models.frames import FINGERS

SCHEMA = 3
"""Version of the arrays' layout."""

_COUNTS = range(2, len(FINGERS) + 1)


@dataclass(frozen=True)
class TrainedBelief:
    """All trained parameters of the belief over labels.

    Attributes:
        evidence: Evidence of a single frame.
        eta: Weight of a new evaluation of old contacts that have moved, when others join them; 0 to
            1.
        stay: Weight of a new evaluation of contacts that stay and have moved; 0 to 1.
        capture_digest: Digest of the capture it was trained on.

    Raises:
        EncoderError: eta or stay is not a share.
    """

    evidence: LabelEvidence
    eta: float
    stay: float
    capture_digest: str

    def __post_init__(self) -> None:
        for name, share in (("eta", self.eta), ("stay", self.stay)):
            if not 0.0 <= share <= 1.0:
                raise EncoderError(f"{name} is a share", got=share, expected="0 to 1")

    @cached_property
    def digest(self) -> str:
        """BLAKE2b, hexadecimal, of everything that decides a label, including the assumed
        constants."""
        known = {**self.header, **ASSUMED, "lifted": [REACH, AT_ONCE, LATER], "least": LEAST}
        hash_ = blake2b(json.dumps(known, sort_keys=True).encode(), digest_size=16)
        for name, array in sorted(self.to_arrays().items()):
            hash_.update(name.encode() + np.ascontiguousarray(array).tobytes())
        return hash_.hexdigest()

    @property
    def header(self) -> dict[str, Any]:
        """The belief's settings as JSON values."""
        return {
            "schema": SCHEMA,
            "shapes": {str(k): asdict(shape) for k, shape in self.evidence.shapes.items()},
            "order": {str(k): share for k, share in self.evidence.order.items()},
            "eta": self.eta,
            "stay": self.stay,
            "capture_digest": self.capture_digest,
        }

    def to_arrays(self) -> dict[str, NDArray[Any]]:
        """Layouts and prior as arrays; with the header, `from_arrays` restores the same belief."""
        arrays: dict[str, NDArray[Any]] = {}
        for count, z in self.evidence.layouts.items():
            arrays[f"layout_{count}"] = np.stack([z.real, z.imag], axis=-1).astype(np.float32)
        for count, prior in self.evidence.prior.items():
            arrays[f"prior_{count}"] = prior
        return arrays

    @classmethod
    def from_arrays(
        cls, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]], where: str = "belief"
    ) -> TrainedBelief:
        """Inverse of `header` and `to_arrays`.

        Args:
            header: Settings.
            arrays: Layouts and prior by name.
            where: Their source, for messages.

        Raises:
            EncoderError: A value is missing, of the wrong shape or invalid.
        """
        try:
            schema = header["schema"]
            shapes = {
                k: KernelShape(**{n: float(v) for n, v in header["shapes"][str(k)].items()})
                for k in _COUNTS
            }
            eta, stay = float(header["eta"]), float(header["stay"])
            digest = str(header["capture_digest"])
            layouts = {k: _layouts(arrays, k, where) for k in _COUNTS}
            order = {int(k): float(v) for k, v in header["order"].items()}
            prior = {k: np.asarray(arrays[f"prior_{k}"], float) for k in (1, *_COUNTS)}
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise EncoderError(
                "not a trained belief, or it is damaged",
                where=where,
                got=f"{type(error).__name__}: {error}",
            ) from error
        if schema != SCHEMA:
            raise EncoderError(
                "the belief has another version",
                where=where,
                got=schema,
                expected=f"schema {SCHEMA}",
            )
        if sorted(order) != list(ORDERED_COUNTS):
            raise EncoderError("shares of order are missing", where=where, got=sorted(order))
        return cls(LabelEvidence(layouts, shapes, order, prior), eta, stay, digest)

    def save(self, path: Path) -> None:
        """Writes the belief as npz."""
        write_npz(path, self.header, self.to_arrays())


def load_belief(path: Path) -> TrainedBelief:
    """Reads a belief.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    names = [f"layout_{k}" for k in _COUNTS] + [f"prior_{k}" for k in (1, *_COUNTS)]
    header, arrays = read_npz(
        path,
        names,
        EncoderError,
        "a trained belief",
        "`python -m encoders.labels.belief_training` makes the built-in one anew",
    )
    return TrainedBelief.from_arrays(header, arrays, str(path))


def capture_digest(capture: Capture) -> str:
    """BLAKE2b of a belief's training data: trials, contacts and their positions to a micrometre."""
    hash_ = blake2b(digest_size=16)
    hash_.update(np.ascontiguousarray(capture.trial, np.int64).tobytes())
    hash_.update(np.ascontiguousarray(capture.down).tobytes())
    micrometres = np.where(capture.down[..., None], np.rint(capture.xy * 1e6), 0.0)
    hash_.update(micrometres.astype(np.int64).tobytes())
    return hash_.hexdigest()


def _layouts(arrays: Mapping[str, NDArray[Any]], count: int, where: str) -> Layouts:
    parts = np.asarray(arrays[f"layout_{count}"], float)
    sets = len(finger_sets(count))
    number = parts.shape[1] if parts.ndim > 1 else 0
    if parts.shape != (sets, number, count, 2) or not number or not np.isfinite(parts).all():
        raise EncoderError(
            "wrong shape, or not finite",
            where=f"{where}: layout_{count}",
            got=parts.shape,
            expected=f"({sets}, M, {count}, 2) finite numbers",
        )
    return parts[..., 0] + 1j * parts[..., 1]
