"""Digests of measures that are not built in: what computes them, and what they say they are.

Measures of ours have one version together (`compute.VERSION`), and a study is locked to their code.
Those of packages change without either.
"""

from __future__ import annotations

from dataclasses import fields
from hashlib import blake2b

from sandbox.recording.versions import package_digest
from sandbox.study.measures.measure import TrialMeasure
from sandbox.study.measures.registry import external_measures


def external_definitions() -> dict[str, str]:
    """A digest of every measure that is not built in, by its name.

    Raises:
        InputError: A measure of an installed package is invalid.
    """
    return {measure.name: _digest(measure) for measure in external_measures()}


def _digest(measure: TrialMeasure) -> str:
    """Digest of the declaration, and of all modules of the package that computes the measure."""
    computes = measure.of_trial or measure.of_result or measure.of_trials
    told = [
        f"{field.name}={getattr(measure, field.name)}"
        for field in fields(measure)
        if not callable(getattr(measure, field.name))
    ]
    digest = blake2b("\n".join(told).encode(), digest_size=8)
    digest.update(package_digest(computes.__module__ if computes else "").encode())
    return digest.hexdigest()
