"""By how much each error source must shrink, cameras to choose from, and what a change of the set-up gives."""
