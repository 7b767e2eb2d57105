"""TUIO 1.1 and 2.0: received, sent and captured."""
