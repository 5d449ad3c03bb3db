"""Making layered panoramas: of one RGB-D panorama, of points, and what layers are (thesis, 6.2.4 and 6.3)."""
