"""Views from samples: direct splatting, and splatting adapted to the neighbourhood (thesis, 7.3)."""
