"""From the joints of a hand, as a headset reports them, to the pose of the whole hand."""
