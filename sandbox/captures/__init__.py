"""Captures of a person's own hand: touches and a Leap or camera, recorded and read together."""
