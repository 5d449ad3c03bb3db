"""Triangle meshes of layers: uniform, of quadtrees, of a stated error; their code (thesis, 7.4)."""
