"""A simulated person who moves a hand in the air over a Leap or in front of a headset or camera."""
