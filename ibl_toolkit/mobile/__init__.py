"""The light of a place from one photo or from the sun, and shadows that small devices can afford."""
