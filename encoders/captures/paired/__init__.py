"""Paired capture: touches and the hand seen by a 3-D device are recorded at the same time.

A capture needs the finger of every touch and the pose of the whole hand at the same moments. The
paper of 2015 used a studio with ten cameras; here a Leap gives both, through PAALM.

    capture_from_hands    conversion of two streams to a capture
    clocks                common clock of two devices, from the arrival times of their frames
    open_hand             measurement of the open hand at the beginning
    guide                 instructions for the person, and progress
    hand_track            poses and named fingertips of hand frames
    registration          pose of the device in the surface frame
    simulated             one simulated person with both devices, and the truth
"""
