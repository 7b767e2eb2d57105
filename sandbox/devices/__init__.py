"""Devices: from bytes to frames, and nothing else."""
