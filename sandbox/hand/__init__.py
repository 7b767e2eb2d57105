"""Measurements of a person's hand: size and layouts from touches, and the posture at rest."""
