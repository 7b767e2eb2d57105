"""Tasks with objects on hinges and slides, and the simulated users who play them."""
