"""The library behind `import sandbox`: trials, replays and exports as functions."""
