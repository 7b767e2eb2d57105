"""Tasks with several free things on the table, and the simulated users who play them."""
