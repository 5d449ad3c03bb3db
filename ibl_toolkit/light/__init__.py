"""Light of a panorama: samplers, the split into a bright part and a residual, clustering (thesis, ch. 3)."""
