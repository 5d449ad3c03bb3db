"""A Blender scene as the page of a phone's shadows shows it.

found = page_scene(scene, depsgraph, kinds)            meshes, lights, ambient light; camera; background
write_page("page.html", found.scene, kinds, found.background, found.camera)
"""

from .page_scene import PageScene, page_scene

__all__ = ["PageScene", "page_scene"]
