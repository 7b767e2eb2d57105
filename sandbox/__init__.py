"""The running program: devices, session, views, recordings, command line."""
