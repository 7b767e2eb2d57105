"""Options for choices that the paper leaves open; docs/paalm.md has the measurement behind each
default."""

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
        identity: `paper`: rank by x among the visible fingers. `tracked`: the most likely
            assignment to the fingers' last positions and to their knuckles.
        direction: Source of a finger's target. `device`: the device's direction and length ratio,
            as printed. `thumb`: that of the thumb goes from its knuckle, as calibrated in the palm,
            to its tip. Fingers with joints have a knuckle and always use it.
        hidden, thumb_hidden: Share of the first bone that the device's length leaves out; 0 as in
            the paper, which takes the length from the knuckle.
        behind: Share of the first bone by which a finger's knuckle is taken to be behind what is
            seen of it, where fingers are solved by their tips. It is less than `hidden`, since a
            finger that is a little bent does not point back to its knuckle.
        open_bend: Degrees of PIP of an open hand, at a ratio of 1; 0 as in the paper.
        coupling: Relation of DIP to PIP; None is that of the device's dialect
            (`encoders.paalm.coupling`).
        solve: What a finger without joints is solved by: `tips`, from its knuckle to its tip
            (`calibration.longest_calibration`), or `lengths` and directions, as printed.
        learns: Learns the coupling of each hand while its device reports joints, unless a coupling
            is chosen (`encoders.paalm.coupling`); of a hand without joints that was not
            measured, where the device sees its palm (`encoders.paalm.average`).
        smoothing: s, time constant of lengths and directions; 0 switches it off.
        longest: s, upper limit of that constant, which grows with the device's noise, finger by
            finger (`encoders.paalm.paalm`).
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
        """The chosen coupling, or that of a dialect."""
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
                    "no such choice",
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
                    "out of range", where=name, got=getattr(self, name), expected=f"0 to {most}"
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
"""The paper's choices as far as it states them; the paper uses an animation program's inverse
kinematics, we use that of `chain`."""
