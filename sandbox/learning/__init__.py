"""Policies that are learned from demonstrations (docs/learning.md)."""
