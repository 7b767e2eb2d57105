"""`sandbox replay`."""
