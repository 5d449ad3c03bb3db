"""What the image files' readers and writers raise."""


class ImageError(ValueError):
    """An image that cannot be used; the message names the file and the value, in one line."""
