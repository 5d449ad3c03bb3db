"""Scenes that several tests of layers look at."""

import pytest


@pytest.fixture
def hollow_room(fresh_blend):
    """A scene of a room that glows, seen from within."""
    import boxed_scene as boxed
    import small_scenes as small

    made = fresh_blend.context.scene
    glow = small.material(boxed.EMISSION, Color=(*boxed.WALL, 1))
    boxed.add_box(made, boxed.ROOM, glow, inward=True).name = "room"
    return made


@pytest.fixture
def furnished_room(hollow_room):
    """The same with a box in it."""
    import boxed_scene as boxed
    import small_scenes as small

    boxed.add_box(hollow_room, boxed.BOX, small.material(boxed.EMISSION, Color=(*boxed.SIDE, 1)))
    return hollow_room
