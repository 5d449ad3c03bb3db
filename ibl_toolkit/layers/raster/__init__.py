"""Views from meshes: a z-buffer rasteriser, and colours projected from the origin (thesis, 7.4)."""
