"""A simulated person whose hand moves in the air over a 3-D device."""
