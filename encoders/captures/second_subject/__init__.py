"""A second simulated subject, made in another way than the first.

What holds on one generator may hold because of how that generator is made. This one shares nothing
with `encoders.captures.subject` but the form of a capture: another hand, keyframed grips instead of
a Gaussian over synergies, fingers that reach one by one instead of a likeliest posture, markers
that err in place instead of joints that err in angle. Nothing it makes is real data, and everything
made from it says so.
"""

from encoders.captures.second_subject.configuration import FROZEN, SEED, SecondConfiguration
from encoders.captures.second_subject.hand import SLENDER
from encoders.captures.second_subject.session import simulate

__all__ = ["FROZEN", "SEED", "SLENDER", "SecondConfiguration", "simulate"]
