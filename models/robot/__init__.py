"""Hands of robots in the place of ours: their models, mappings, and retargeting."""
