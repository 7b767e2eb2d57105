"""What is measured of a person's hand: its size and layouts by touches, and its posture at rest."""
