"""From landmarks of a hand in a camera's picture to the pose of the whole hand."""
