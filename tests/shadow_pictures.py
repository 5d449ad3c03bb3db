"""A floor with things on it whose nodes show how much of a light they say arrives, and what numpy says."""

import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenEXR
import small_scenes
from mathutils import Vector

from expanded_panoramas.cycles_integration import capture, shadow_preview
from expanded_panoramas.cycles_integration.node_trees import add
from expanded_panoramas.cycles_integration.rendering import write_render
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import visibility

SUN, LAMP = (-0.41, -0.23, 0.88), (-1.37, -0.83, 3.12)
"""Direction to the sun, and where a lamp is [m]."""


def still_life():
    """A floor, a turned box on it and a smooth ball above it, of one material; seen from aside."""
    scene = bpy.context.scene
    plain = small_scenes.material(small_scenes.DIFFUSE)
    small_scenes.add_plane(scene, plain, 4.0)
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(-0.4, 0.1, 0.3), rotation=(0, 0, 0.5))
    bpy.context.object.data.materials.append(plain)
    small_scenes.add_ball(scene, plain, 0.3, (0.5, -0.2, 0.6))
    small_scenes.add_camera(scene, (1.2, -1.9, 4.0), (0.1, 0.1, 0), width=2.6)
    return plain


def add_light(kind):
    """A sun, or a lamp, that shines to the middle."""
    made = bpy.data.objects.new(kind, bpy.data.lights.new(kind, kind))
    made.location = LAMP
    made.rotation_euler = Vector(SUN).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)
    bpy.context.view_layer.update()
    return made


def shown(light, settings, image=None):
    """A light's map and strength, its texels in an image."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    (made,) = shadow_preview.shadow_maps_of([light], depsgraph, settings)
    image = shadow_preview.store_map(made, image, "Shadow Map")
    return shadow_preview.ShownLight(made, image, shadow_preview.strength_of(light, depsgraph))


def preview(light, settings):
    """The map of a light, and the group that tests it."""
    one = shown(light, settings)
    return one.made, shadow_preview.build_group([one], None, "Shadow Map Preview")


def maps(scene):
    """The maps that a scene's preview should have, and their lights' strengths."""
    depsgraph, preview = bpy.context.evaluated_depsgraph_get(), scene.panorama_shadow_preview
    lights = shadow_preview.lights_of(preview)
    made = shadow_preview.shadow_maps_of(lights, depsgraph, shadow_preview.settings_of(preview))
    return made, np.array([shadow_preview.strength_of(light, depsgraph) for light in lights])


def show(material, group, output="Visibility"):
    """Make a material emit what the group gives."""
    tree = material.node_tree
    tree.nodes.clear()
    node = add(tree, "ShaderNodeGroup", node_tree=group)
    glow = add(tree, "ShaderNodeEmission", {"Color": node.outputs[output]})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": glow.outputs[0]})


def rendered(width, engine="CYCLES", channels="R", samples=1):
    """(shown (n,), points (n, 3) [m], normals (n, 3)) of all pixels, each at its centre.

    shown has (n, c) of several channels.
    """
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x = scene.render.resolution_y = width
    scene.render.resolution_percentage = 100
    scene.render.filter_size = 0.0
    scene.cycles.samples, scene.eevee.taa_render_samples = samples, samples
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    capture.sample_pixel_centres(scene)
    layer = bpy.context.view_layer
    layer.use_pass_position = layer.use_pass_normal = True
    with tempfile.TemporaryDirectory() as folder:
        path = _render(scene, folder)
        parts = OpenEXR.File(path, separate_channels=True).parts  # one per pass from Blender 5.0
        pixels = {name: channel.pixels for part in parts for name, channel in part.channels.items()}
    by_name = {name.split(".", 1)[1]: values.ravel() for name, values in pixels.items()}
    vectors = (np.stack([by_name[f"{name}.{k}"] for k in "XYZ"], axis=1) for name in ("Position", "Normal"))
    colours = np.stack([by_name[f"Combined.{k}"] for k in channels], axis=1)
    return colours[:, 0] if len(channels) == 1 else colours, *vectors


def composited(width, channels="R"):
    """The finished picture (n,), or (n, c) of several channels."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = width
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        write_render(scene, path)
        with OpenEXR.File(str(path), separate_channels=True) as file:
            found = file.parts[0].channels
            picture = np.stack([found[k].pixels.ravel() for k in channels], axis=1)
    return picture[:, 0] if len(channels) == 1 else picture


def _render(scene, folder):
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5.0
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
    scene.render.filepath = f"{folder}/picture.exr"
    bpy.ops.render.render(write_still=True)
    return scene.render.filepath


def differences(made, shown, points, normals):
    """|shown − numpy's visibility| (n,)."""
    return np.abs(shown - visibility(made, points.astype(np.float64), normals.astype(np.float64)))
