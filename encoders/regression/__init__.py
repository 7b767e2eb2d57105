"""Fits encoders, which map a contact vector to a pose, and reads fitted ones."""
