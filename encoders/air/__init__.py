"""From a hand in the air, as a headset or a camera sees it, to the pose of the whole hand."""
