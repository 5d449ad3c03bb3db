"""What the readers and writers of layered panoramas raise."""


class LayersError(ValueError):
    """A folder of layers that cannot be used; names the file, the element and what would be right."""
