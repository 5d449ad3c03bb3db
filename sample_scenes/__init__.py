"""Test rooms built by script, and the picks of the panoramas that ship with Blender."""
