"""A second Blender, without a window, that does long work on a copy of the file."""
