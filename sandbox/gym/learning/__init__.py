"""Environments of Gymnasium that can be learned from (docs/gymnasium.md)."""
