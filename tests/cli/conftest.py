"""A set of the closed room with a synthetic photograph, an objects file, and the command in this process."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import write_exr

WIDTH = 128


def write_photograph(path, width=WIDTH):
    """Grey stripes with one lamp on the ceiling."""
    image = np.ones((width // 2, 1)) * (0.5 + 0.2 * np.sin(np.linspace(0, 40, width)))
    image[: width // 16, width // 4 : width // 3] = 20
    write_exr(path, dict.fromkeys("RGB", image.astype(np.float16)))


def write_objects(bpy, path):
    """A ball that moves with the frames, looked at by two cameras; of 48 × 28 px."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 56, 50
    props = bpy.data.collections.new("Props")
    left_out = bpy.data.collections.new("Left Out")
    for collection in (props, left_out):
        scene.collection.children.link(collection)
    scene.view_layers[0].layer_collection.children["Left Out"].exclude = True
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.25, location=(1.1, -0.6, 0.25))
    ball = bpy.context.object
    ball.name = "Ball"
    scene.collection.objects.unlink(ball)
    props.objects.link(ball)
    for frame, x in ((1, 1.1), (5, 1.9)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    for name, location in (("Front", (-0.5, -0.6, 1.2)), ("Side", (1.0, 1.2, 1.2))):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        camera.location = location
        scene.collection.objects.link(camera)
        camera.constraints.new("TRACK_TO").target = ball
    scene.camera = scene.objects["Front"]
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


@pytest.fixture
def room(tmp_path):
    """A folder with the room's set and its photograph; needs no Blender."""
    pytest.importorskip("bpy")  # sample_scenes builds the room with it
    from expanded_panoramas.ibl_toolkit.panorama_set import write_set
    from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

    write_photograph(tmp_path / "room.exr")
    write_set(closed_room_set(tmp_path / "room.exr"), tmp_path / "room.json")
    return tmp_path


@pytest.fixture
def room_with_objects(fresh_blend, room):
    """The same with an objects file that the set names."""
    write_objects(fresh_blend, room / "objects.blend")
    change_set(room / "room.json", objects="objects.blend")
    return room


def change_set(path, **keys):
    document = json.loads(path.read_text())
    path.write_text(json.dumps({**document, **keys}))


@pytest.fixture
def panorama(capfd):
    """The command in this process: panorama(*arguments) -> exit status, stdout, lines of stderr."""
    from expanded_panoramas.cli import main, stdout

    def run(*arguments):
        stdout.flush()  # what Blender printed before belongs to whoever made it print
        capfd.readouterr()
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as stop:  # as argparse ends it
            status = stop.code
        out, err = capfd.readouterr()
        return status, out, err.splitlines()

    return run
