"""The session: the control loop, and its contracts with devices, recorders and views."""
