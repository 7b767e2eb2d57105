"""From touches to a pose: contact vector, encoders, labels, correction, reconstructor."""
