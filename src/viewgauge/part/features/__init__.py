"""The shapes of a B-rep that measurands are made of: visible edges, arcs, faces that lie opposite each other."""
