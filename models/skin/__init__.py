"""The mesh of the hand's skin: posing, colours, and export as glTF."""
