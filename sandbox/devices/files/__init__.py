"""Files of recorded touch frames and hand frames."""
