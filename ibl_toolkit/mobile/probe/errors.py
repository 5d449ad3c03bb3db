"""What is wrong with a photograph of a probe."""


class ProbeError(ValueError):
    """A photograph, or what was said of it, tells no light; the message says what would."""
