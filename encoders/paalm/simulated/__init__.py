"""A simulated Leap: the device's frames for a hand with a known pose."""
