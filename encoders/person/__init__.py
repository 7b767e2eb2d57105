"""Differences between a person's hand and the trained one: size and yaw."""
