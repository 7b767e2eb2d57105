"""Tasks with things that are joined by hinges and slides, and the simulated users who play them."""
