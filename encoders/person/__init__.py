"""How a person's hand differs from the trained one: its size, and how it is turned."""
