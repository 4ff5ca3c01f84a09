"""Triangle meshes: STL, PLY, OBJ, 3MF and GLB files."""

__all__ = ["MESH_SUFFIXES"]

MESH_SUFFIXES = (".stl", ".ply", ".obj", ".3mf", ".glb")
"""Of the files that are read."""
