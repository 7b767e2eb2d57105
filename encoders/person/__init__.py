"""Differences between a person's hand and the hand on which encoders were trained: size, yaw and
rest posture."""
