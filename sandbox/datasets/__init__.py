"""Data sets of demonstrations, for those who train on them (docs/data-sets.md)."""
