"""An RGB-D panorama file as a place: its picture, its calibration, and its depth as the one real surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy

from ..ibl_toolkit.depth_mesh import DepthMesh, mesh_from_depth
from ..ibl_toolkit.images import read_rgbd
from ..ibl_toolkit.reconstruction import Piece
from . import roles
from .pieces import update_pieces
from .place import Place, create_place

NAME = "depth"


@dataclass(frozen=True)
class LoadedRGBD:
    """A place made from an RGB-D file, and how far its surface is from the file's depth."""

    place: Place
    surface: DepthMesh
    piece: Piece
    camera_height: float


def load_rgbd(scene: bpy.types.Scene, path: Path) -> LoadedRGBD:
    """Give the scene the place of an RGB-D file: a light map whose light has a position (section 5.1).

    The depth becomes one surface with the role ENVIRONMENT; objects that are to receive shadows are built or
    drawn over it as support. Raises ImageError as `read_rgbd` does.
    """
    rgbd = read_rgbd(path)
    surface = mesh_from_depth(rgbd.depth, rgbd.world_from_panorama, rgbd.camera_height)
    place = create_place(scene, str(Path(path).absolute()), rgbd)
    size = surface.mesh.world_vertices.max(axis=0) - surface.mesh.world_vertices.min(axis=0)
    piece = Piece(NAME, "depth", roles.ENVIRONMENT, surface.mesh, tuple(size.tolist()), 0.0, 0.0, 0.2)
    update_pieces(place, [piece])
    return LoadedRGBD(place, surface, piece, rgbd.camera_height)
