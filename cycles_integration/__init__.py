"""Turns results into Blender data and pictures: roles, materials, lights, bakes, renders."""


def register():
    """Nothing to register yet."""


def unregister():
    """Nothing to take back yet."""
