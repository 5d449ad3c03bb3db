"""Blender operators and property groups: read the scene, call one function, report."""


def register():
    """Nothing to register yet."""


def unregister():
    """Nothing to take back yet."""
