"""Options of PAALM. The paper leaves these choices open; docs/paalm.md has the measurement behind
each default."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from encoders.paalm.coupling import TWO_THIRDS, Coupling, coupling_of
from models.errors import EncoderError

Hands = Literal["right", "left", "both"]


@dataclass(frozen=True)
class PaalmOptions:
    """Choices of PAALM that the paper leaves open.

    Attributes:
        identity: How fingers are labelled. `paper`: by rank in x among the visible fingers.
            `tracked`: by the most likely assignment (`encoders.paalm.identity`).
        direction: Source of a finger's target. `device`: the device's direction and the length
            ratio, as in the paper. `thumb`: as `device` for the fingers; the thumb's target is the
            line from its calibrated knuckle to its tip. Fingers with reported joints always use
            their knuckle.
        hidden, thumb_hidden: Share of the first bone that the device's length leaves out. The paper
            has 0, since it assumes that the length begins at the knuckle.
        behind: Distance from a finger's visible part back to its knuckle, as a share of the first
            bone, if fingers are solved by their tips. It is less than `hidden`, since the line of a
            slightly bent finger does not pass through its knuckle.
        open_bend: PIP (degrees) of an open hand at a length ratio of 1; 0 in the paper.
        coupling: Relation of DIP to PIP; None takes that of the device's dialect
            (`encoders.paalm.coupling`).
        solve: Input for solving a finger without joints. `tips`: the line from its knuckle to its
            tip (`calibration.longest_calibration`). `lengths`: length and direction, as in the
            paper.
        learns: True learns the coupling of each hand whose joints the device reports, unless
            `coupling` is given (`encoders.paalm.coupling`). For an unmeasured hand without joints,
            True learns the position of the palm (`encoders.paalm.seen_palm`).
        smoothing: Least time constant (s) of the smoothing of fingers' targets; 0 switches it off.
        longest: Upper limit (s) of this time constant, which grows with the noise of each fingertip
            (`encoders.paalm.joint_angles`).
    """

    identity: Literal["paper", "tracked"] = "tracked"
    direction: Literal["device", "thumb"] = "thumb"
    hidden: float = 0.45
    thumb_hidden: float = 0.9
    behind: float = 0.2
    open_bend: float = 5.0
    coupling: Coupling | None = None
    solve: Literal["tips", "lengths"] = "tips"
    learns: bool = True
    smoothing: float = 0.03
    longest: float = 0.15

    def coupling_for(self, dialect: str | None) -> Coupling:
        """The chosen coupling; if none is chosen, the coupling of a dialect."""
        return self.coupling or coupling_of(dialect)

    def __post_init__(self) -> None:
        choices = {
            "identity": ("paper", "tracked"),
            "direction": ("device", "thumb"),
            "solve": ("tips", "lengths"),
        }
        for name, allowed in choices.items():
            if getattr(self, name) not in allowed:
                raise EncoderError(
                    "no such value of an option of PAALM",
                    where=name,
                    got=getattr(self, name),
                    expected=", ".join(allowed),
                )
        for name, most in (
            ("hidden", 0.95),
            ("thumb_hidden", 0.95),
            ("behind", 0.95),
            ("open_bend", 60.0),
            ("smoothing", 10.0),
            ("longest", 10.0),
        ):
            if not 0.0 <= getattr(self, name) <= most:
                raise EncoderError(
                    "an option of PAALM is out of range",
                    where=name,
                    got=getattr(self, name),
                    expected=f"0 to {most}",
                )


PAPER = PaalmOptions(
    identity="paper",
    direction="device",
    hidden=0.0,
    thumb_hidden=0.0,
    open_bend=0.0,
    coupling=TWO_THIRDS,
    solve="lengths",
    learns=False,
    smoothing=0.0,
)
"""The choices of the paper, as far as the paper states them. For inverse kinematics, the paper uses
an animation program, and this package `encoders.paalm.chain`."""
