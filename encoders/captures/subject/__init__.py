"""A simulated subject, which replaces the person whose hand was captured for the paper.

A reimplementation needs poses and touches of the same hand at the same time, and no public
recording contains both. The subject moves a hand over a touch surface as a person might, and is
then measured with the errors of a capture system and a touch screen. Its captures are simulated,
not real data, and all results made from them are marked as simulated.
"""

from encoders.captures.subject.configuration import FROZEN, SEED, SubjectConfiguration
from encoders.captures.subject.subject import simulate

__all__ = ["FROZEN", "SEED", "SubjectConfiguration", "simulate"]
