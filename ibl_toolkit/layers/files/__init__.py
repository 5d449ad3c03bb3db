"""How layered panoramas are stored: panorama.xml, atlases, mip levels, images (thesis, 6.2.1 and 6.2.3)."""
