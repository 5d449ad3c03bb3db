"""Blender's own render, given up: the operator that set it up is undone, unless the artist has gone on."""

import pytest
from room_job import built

BALL = "PANORAMA_OT_add_ball"


@pytest.fixture
def render_job(fresh_blend, tmp_path):
    """A render of a few pixels, begun by an operator that added a ball."""
    from expanded_panoramas.operators import render_job

    built(fresh_blend, tmp_path)
    scene = fresh_blend.context.scene
    scene.camera = fresh_blend.data.objects.new("eye", fresh_blend.data.cameras.new("eye"))
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 4
    fresh_blend.ops.ed.undo_push(message="Room")
    fresh_blend.ops.panorama.add_ball("EXEC_DEFAULT", True, kind="MATTE")
    render_job.start(BALL)
    return render_job


@pytest.mark.parametrize("cancelled", [True, False])
def test_what_began_it_is_undone_if_it_is_cancelled(fresh_blend, render_job, cancelled):
    if cancelled:
        for handler in fresh_blend.app.handlers.render_cancel:
            handler(fresh_blend.context.scene)
    assert render_job._watch() is None
    assert ("Matte Ball" in fresh_blend.data.objects) == (not cancelled)
    assert "floor" in fresh_blend.data.objects
    assert not fresh_blend.app.handlers.render_cancel


def test_what_the_artist_did_meanwhile_is_not_undone(fresh_blend, render_job):
    fresh_blend.ops.mesh.primitive_cube_add("EXEC_DEFAULT", True)
    render_job._cancelled()
    render_job._watch()
    assert {"Cube", "Matte Ball"} <= set(fresh_blend.data.objects.keys())


def test_unregistering_leaves_nothing(fresh_blend, render_job):
    assert fresh_blend.app.timers.is_registered(render_job._watch)
    render_job.unregister()
    assert not fresh_blend.app.timers.is_registered(render_job._watch)
    assert not fresh_blend.app.handlers.render_cancel
