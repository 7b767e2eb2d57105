"""Tasks with several free objects on the table, and the simulated users who play them."""
