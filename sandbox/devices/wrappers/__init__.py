"""Device wrappers: merged, split and degraded devices, and devices with a lift control."""
