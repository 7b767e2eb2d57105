"""Labellers, which tell the finger of each contact."""
