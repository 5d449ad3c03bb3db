"""Expanded Panoramas: an HDR panorama becomes a calibrated light map with depth, and a place to render in.

The root only registers the rooms; without Blender the package still imports, for `ibl_toolkit` and the tests.
"""

from importlib import import_module

# The order matters: operators use what cycles_integration defines, panels name operators.
ROOMS = ("cycles_integration", "operators", "ui", "cli")


def register():
    """Register every room with Blender."""
    for room in ROOMS:
        import_module(f".{room}", __package__).register()


def unregister():
    """Take back what `register` did, in reverse."""
    for room in reversed(ROOMS):
        import_module(f".{room}", __package__).unregister()
