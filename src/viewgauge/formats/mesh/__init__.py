"""Triangle meshes: STL, PLY and OBJ files."""
