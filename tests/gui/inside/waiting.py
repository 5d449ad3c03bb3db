"""What a job yields in order to wait. Runs in Blender."""

from typing import NamedTuple

AT_ONCE = "AT_ONCE"
"""Until the events are handled; a plain `yield` waits until Blender has drawn, too."""


class Until(NamedTuple):
    """Wait until a condition holds; TimeoutError after so many seconds says for what."""

    condition: object
    what: str
    seconds: float = 30
