"""Digests of measures that are not built in: what computes them, and what they say they are.

Measures of ours have one version together (`compute.VERSION`), and a study is locked to their code.
Those of packages change without either.
"""

from __future__ import annotations

import sys
from dataclasses import fields
from functools import cache
from hashlib import blake2b
from pathlib import Path

from sandbox.recording.source_digest import source_digest, source_files
from sandbox.study.measures.measure import TrialMeasure
from sandbox.study.measures.registry import outside_measures


def outside_definitions() -> dict[str, str]:
    """A digest of every measure that is not built in, by its name.

    Raises:
        InputError: A measure of an installed package is invalid.
    """
    return {measure.name: _digest(measure) for measure in outside_measures()}


def _digest(measure: TrialMeasure) -> str:
    """Digest of the declaration, and of all modules of the package that computes the measure."""
    computes = measure.of_trial or measure.of_result or measure.of_trials
    told = [
        f"{field.name}={getattr(measure, field.name)}"
        for field in fields(measure)
        if not callable(getattr(measure, field.name))
    ]
    digest = blake2b("\n".join(told).encode(), digest_size=8)
    digest.update(_source(computes.__module__ if computes else "").encode())
    return digest.hexdigest()


@cache
def _source(module: str) -> str:
    """Digest of the outermost package of a module, or of the module; empty without a file."""
    top = sys.modules.get(module.partition(".")[0])
    spec = top.__spec__ if top else None
    if spec is None or spec.origin is None or not spec.has_location:
        return ""
    file = Path(spec.origin)
    if file.stem != "__init__":
        return source_digest([file], file.parent)
    return source_digest(source_files(file.parent, below=True), file.parent)
