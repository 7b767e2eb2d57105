"""What the belief over labels has learned, and how it is kept: arrays, checked before use."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.label_evidence import LabelEvidence
from encoders.layout_density import KernelShape, LayoutDensity, Prototypes, finger_sets
from models.errors import EncoderError
from models.frames import FINGERS

SCHEMA = 1
"""Version of the arrays' layout."""

_COUNTS = range(2, len(FINGERS) + 1)


@dataclass(frozen=True)
class TrainedBelief:
    """Everything that decides which labels are believed.

    Attributes:
        evidence: What one look at the touches says.
        eta: Share with which a new look at contacts that were there before counts anew, when others
            join them; 0 to 1.
        capture_digest: Of the capture it was trained on.

    Raises:
        EncoderError: eta is not a share.
    """

    evidence: LabelEvidence
    eta: float
    capture_digest: str

    def __post_init__(self) -> None:
        if not 0.0 <= self.eta <= 1.0:
            raise EncoderError("eta is a share", got=self.eta, expected="0 to 1")

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over everything that decides a label, hexadecimal."""
        hash_ = blake2b(digest_size=16)
        for name, array in sorted(self.to_arrays().items()):
            hash_.update(name.encode() + np.ascontiguousarray(array).tobytes())
        return hash_.hexdigest()

    def to_arrays(self) -> dict[str, NDArray[Any]]:
        """The belief as arrays without pickle; `from_arrays` makes the same belief of them."""
        evidence = self.evidence
        header = {
            "schema": SCHEMA,
            "shape": asdict(evidence.density.shape),
            "trust": evidence.trust,
            "eta": self.eta,
            "capture_digest": self.capture_digest,
        }
        text = json.dumps(header).encode()
        arrays: dict[str, NDArray[Any]] = {"header": np.frombuffer(text, np.uint8)}
        for count, p in evidence.density.prototypes.items():
            layout = np.stack([p.layout.real, p.layout.imag], axis=-1)
            arrays[f"layout_{count}"] = layout.astype(np.float32)
            arrays[f"weight_{count}"] = p.weight
            arrays[f"prior_{count}"] = p.prior
        return arrays

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, NDArray[Any]], where: str = "belief"
    ) -> TrainedBelief:
        """Inverse of `to_arrays`.

        Args:
            arrays: By name.
            where: They come from, for messages.

        Raises:
            EncoderError: An array is missing, of the wrong shape, or not what it must be.
        """
        try:
            header = json.loads(bytes(np.asarray(arrays["header"], np.uint8).tobytes()).decode())
            schema = header["schema"]
            shape = KernelShape(**{k: float(v) for k, v in header["shape"].items()})
            trust, eta = float(header["trust"]), float(header["eta"])
            digest = str(header["capture_digest"])
            prototypes = {k: _prototypes(arrays, k, where) for k in _COUNTS}
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise EncoderError(
                "this is no trained belief, or it is damaged", where=where, got=str(error)
            ) from error
        if schema != SCHEMA:
            raise EncoderError("another version's belief", where=where, got=schema,
                               expected=f"schema {SCHEMA}")  # fmt: skip
        return cls(LabelEvidence(LayoutDensity(prototypes, shape), trust), eta, digest)

    def save(self, path: Path) -> None:
        """Writes the belief as npz."""
        with path.open("wb") as file:
            np.savez_compressed(file, **self.to_arrays())  # type: ignore[arg-type]


def load_belief(path: Path) -> TrainedBelief:
    """Reads a belief.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    where = str(path)
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except FileNotFoundError:
        raise EncoderError("there is no such file", where=where) from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise EncoderError(
            "this is no trained belief, or it is damaged", where=where, got=str(error)
        ) from error
    return TrainedBelief.from_arrays(arrays, where)


def capture_digest(capture: Capture) -> str:
    """BLAKE2b over what a belief learns from: trials, contacts and their places to a micrometre."""
    hash_ = blake2b(digest_size=16)
    hash_.update(np.ascontiguousarray(capture.trial, np.int64).tobytes())
    hash_.update(np.ascontiguousarray(capture.down).tobytes())
    micrometres = np.where(capture.down[..., None], np.rint(capture.xy * 1e6), 0.0)
    hash_.update(micrometres.astype(np.int64).tobytes())
    return hash_.hexdigest()


def _prototypes(arrays: Mapping[str, NDArray[Any]], count: int, where: str) -> Prototypes:
    layout = np.asarray(arrays[f"layout_{count}"], float)
    weight = np.asarray(arrays[f"weight_{count}"], float)
    prior = np.asarray(arrays[f"prior_{count}"], float)
    sets = len(finger_sets(count))
    most = weight.shape[-1] if weight.ndim else 0
    for name, array, shape in (
        ("layout", layout, (sets, most, count, 2)),
        ("weight", weight, (sets, most)),
        ("prior", prior, (sets,)),
    ):
        if array.shape != shape or not np.isfinite(array).all():
            raise EncoderError(
                "wrong shape, or not finite",
                where=f"{where}: {name}_{count}",
                got=array.shape,
                expected=f"{shape} finite numbers",
            )
    for name, shares in (("weight", weight), ("prior", prior)):
        if (shares < 0).any() or not np.allclose(shares.sum(axis=-1), 1.0):
            raise EncoderError("shares do not add up to 1", where=f"{where}: {name}_{count}")
    return Prototypes(layout[..., 0] + 1j * layout[..., 1], weight, prior)
