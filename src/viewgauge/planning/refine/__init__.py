"""From the best of the sampled viewpoints to the best of all poses that the region allows."""
