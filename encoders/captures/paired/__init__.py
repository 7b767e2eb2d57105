"""Paired capture: a touch device and a 3-D device record the same hand at the same time.

A capture needs the finger of every touch and the pose of the whole hand at the same moments. The
paper of 2015 used a studio with ten cameras. Here a Leap gives fingers and poses, through PAALM.

    capture_from_hands    conversion of touches and hand frames to a capture
    guide                 instructions for the person, and progress
    hand_track            measurement of the open hand, poses and labelled fingertips of hand frames
    registration          pose of the 3-D device in the surface frame
    simulated_pair        a simulated person with both devices, and the truth
"""
