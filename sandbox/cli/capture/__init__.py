"""`sandbox capture`."""
