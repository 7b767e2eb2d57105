"""A simulated subject: it stands for the person whose hand and touches the paper captured.

A reimplementation needs poses and touches of the same hand at the same time, and no public
recording holds both. The subject moves a hand over a touch surface as a person might and is then
measured, with errors, as a capture system and a touch screen would measure. Nothing it makes is
real data, and everything made from it says so.
"""

from encoders.captures.subject.configuration import FROZEN, SEED, SubjectConfiguration
from encoders.captures.subject.subject import simulate

__all__ = ["FROZEN", "SEED", "SubjectConfiguration", "simulate"]
