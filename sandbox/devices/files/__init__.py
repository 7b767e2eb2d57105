"""Devices that play files of touch frames and hand frames, and the writers of these files."""
