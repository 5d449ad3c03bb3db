"""Layers as textured meshes for other programs: glTF 2.0, OBJ, PLY."""
