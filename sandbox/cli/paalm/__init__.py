"""`sandbox paalm`."""
