"""TUIO 1.1 and 2.0: receiver, sender and packet captures."""
