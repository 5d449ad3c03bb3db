"""To be written: drawn over the panorama."""


def draw(context, canvas):
    """Nothing yet."""
