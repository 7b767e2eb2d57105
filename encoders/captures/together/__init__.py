"""Touches and a 3-D device that sees the hand, recorded together, become a capture.

What the paper of 2015 had a studio of ten cameras for: the finger of every touch and the pose of
the whole hand at the same moments. Here a Leap tells both, through PAALM.

    capture_from_hands    the way from two streams to a capture
    clocks                one clock of two devices, from when their frames arrived
    seen_track            poses and named fingertips of hand frames
    registration          where the device is, seen from the surface
    simulated             one simulated person over both devices, with the truth
"""
