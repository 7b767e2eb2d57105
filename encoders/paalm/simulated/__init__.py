"""A simulated Leap: what the device would say of a hand whose pose is known."""
