"""`sandbox hand`."""
