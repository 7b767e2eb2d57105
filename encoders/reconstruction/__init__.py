"""From one touch frame after another to the pose of the whole hand."""
