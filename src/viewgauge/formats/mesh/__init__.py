"""Triangle meshes: STL, PLY and OBJ files."""

__all__ = ["MESH_SUFFIXES"]

MESH_SUFFIXES = (".stl", ".ply", ".obj")
