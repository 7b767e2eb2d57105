"""Array types, and arithmetic whose result is the same on every machine."""
