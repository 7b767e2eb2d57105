"""Who may connect to the server, how many and how often, and each connection."""
