"""Data sets of demonstrations, for training policies (docs/data-sets.md)."""
