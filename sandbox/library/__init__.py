"""Public functions of `import sandbox`: trials, replays and exports."""
