"""Cameras that look at layers, what they see, and the five methods by name (thesis, chapter 7)."""
