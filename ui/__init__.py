"""What people look at: panels, overlays and menus."""


def register():
    """Nothing to register yet."""


def unregister():
    """Nothing to take back yet."""
