"""Devices: sources of touch frames and hand frames."""
