"""Both simulated subjects by name, as `encoders.evaluation.subjects.Subject`."""

from __future__ import annotations

from functools import cache

from encoders.capture import Capture
from encoders.evaluation.subjects import Progress, Subject, first_subject, json_values
from models.errors import EncoderError
from training.second_subject import FROZEN, SEED, simulate

SUBJECTS = ("first", "second")
"""Names of the subjects. The name is a part of the digest that chooses a subject's judged days."""


@cache
def subject(name: str) -> Subject:
    """Finds a subject by name.

    Raises:
        EncoderError: The subject is unknown.
    """
    if name not in SUBJECTS:
        raise EncoderError("no such subject", got=name, expected=", ".join(SUBJECTS))
    return first_subject() if name == "first" else _second_subject()


def _second_subject() -> Subject:
    def day(number: int, progress: Progress | None = None) -> Capture:
        return simulate(FROZEN, SEED, number, progress)

    return Subject("second", SEED, json_values(FROZEN.as_json()), day)
