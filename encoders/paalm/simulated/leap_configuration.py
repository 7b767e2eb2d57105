"""Settings of the simulated Leap, of the first software and of the later one.

Numbers of the first software are those of the only recording of real hands that it left
(`leapmotion/leapjs`, test/hands.json). `benchmarks.first_leap` at commit db485e42 measured the
recording and the simulated device alike.
"""

from __future__ import annotations

from dataclasses import dataclass

QUANTILES = (0.0, 0.01, 0.05, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0)
"""Shares of the time that `LeapConfiguration.seen` counts."""


@dataclass(frozen=True)
class LeapConfiguration:
    """Settings of the device. Lengths in m, angles in degrees, times in s.

    Attributes:
        joint: Spread of the later software's joints.
        palm_place, palm_turn: Spread of its palm's frame.
        hidden: Share of the first bone that the first software counts as palm, for fingers and for
            the thumb. All from here on is the first software's. In the recording, greatest lengths
            are 71 to 82 mm of index, middle and ring finger and 52 to 55 of the thumb, which of an
            average hand leave out about these shares.
        seen: Share of the rest that is seen, from the tip on, at each of `QUANTILES`. It says
            nothing about how far the finger is bent.
        seen_seconds: Time constant with which that share changes, smoothly.
        seen_alike: Correlation between the shares of two fingers.
        length_slow: Spread of slow errors of a length, as a share of it.
        tip, length, direction: Spread of tips, lengths and directions from frame to frame.
        aside, aside_seconds: Spread and time constant of slow errors of a direction.
        centre: Palm's centre that the device reports, in palm coordinates; its x is that of either
            hand, towards the little finger.
        centre_wanders, wander_seconds: Spread and time constant of that centre's wandering forwards
            and backwards.
        centre_place, centre_turn: Spread of the palm's frame from frame to frame.
        reversed_share, reversed_for: Share of the hands that come into view with the palm the wrong
            way round, and for how long.
        folded: A finger that is bent to less than this share of its length is not seen.
        turned_in: Nor is one that points more than this away from the palm's direction.
        merged: Two tips closer than this are seen as one.
        lost_rate, lost: Hz at which a visible finger is lost without a reason, and its duration in
            s: every order of magnitude is equally likely.
        fresh: Share of the lost fingers that come back with a new id.
        back: s that a hidden finger must be visible before the device reports it again.
        swapped: Hz at which two neighbours exchange their ids.
    """

    joint: float = 0.0005
    palm_place: float = 0.0005
    palm_turn: float = 0.4
    hidden: float = 0.45
    thumb_hidden: float = 0.9
    seen: tuple[float, ...] = (0.14, 0.25, 0.44, 0.54, 0.69, 0.81, 0.9, 0.96, 0.99, 1.0, 1.0)
    seen_seconds: float = 0.2
    seen_alike: float = 0.5
    length_slow: float = 0.01
    tip: float = 0.00002
    length: float = 0.00004
    direction: float = 0.03
    aside: float = 5.5
    aside_seconds: float = 0.3
    centre: tuple[float, float, float] = (-0.007, 0.031, -0.005)
    centre_wanders: float = 0.005
    wander_seconds: float = 0.2
    centre_place: float = 0.00002
    centre_turn: float = 0.03
    reversed_share: float = 0.5
    reversed_for: float = 0.3
    folded: float = 0.5
    turned_in: float = 80.0
    merged: float = 0.012
    lost_rate: float = 0.65
    lost: tuple[float, float] = (0.008, 0.8)
    fresh: float = 0.15
    back: float = 0.03
    swapped: float = 0.1


FROZEN_LEAP = LeapConfiguration()

PRINTED_LEAP = LeapConfiguration(
    seen=(1.0,) * len(QUANTILES),
    length_slow=0.02,
    tip=0.0005,
    length=0.0004,
    direction=1.5,
    aside=0.0,
    centre=(0.0, 0.0, 0.0),
    centre_wanders=0.0,
    centre_place=0.0005,
    centre_turn=0.4,
    reversed_share=0.0,
    lost_rate=0.15,
    lost=(0.05, 0.4),
    fresh=1.0,
    swapped=0.0,
)
"""The device that the paper describes, in which a finger's length says how far it is bent. No real
recording looks so; what the paper prints can be tested on it."""
