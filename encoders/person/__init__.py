"""Differences between a person's hand and the trained one: size, yaw and rest posture."""
