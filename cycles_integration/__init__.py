"""Results as Blender data and pictures: roles, materials, lights, maps, render set-up, compositing."""

from . import place, roles

MODULES = (roles, place)


def register():
    """Register roles and places."""
    for module in MODULES:
        module.register()


def unregister():
    """Take them back."""
    for module in reversed(MODULES):
        module.unregister()
