"""What may be dropped where, and by which operator it is opened."""

from types import SimpleNamespace

import pytest


def dropped_on(area, region="WINDOW"):
    return SimpleNamespace(
        area=area and SimpleNamespace(type=area), region=region and SimpleNamespace(type=region)
    )


@pytest.mark.parametrize(
    ("area", "region", "takes"),
    [
        ("VIEW_3D", "WINDOW", True),
        ("IMAGE_EDITOR", "WINDOW", True),
        ("VIEW_3D", "UI", False),
        ("NODE_EDITOR", "WINDOW", False),
        ("VIEW_3D", None, False),
        (None, None, False),
    ],
)
def test_where_files_may_be_dropped(fresh_blend, area, region, takes):
    from expanded_panoramas.ui import file_handlers

    for handler in file_handlers.classes:
        assert handler.poll_drop(dropped_on(area, region)) == takes


def test_handlers_name_operators_that_take_a_path(fresh_blend):
    from expanded_panoramas.ui import file_handlers

    extensions = []
    for handler in file_handlers.classes:
        assert hasattr(fresh_blend.types, handler.__name__)
        verb = handler.bl_import_operator.partition(".")[2]
        properties = getattr(fresh_blend.ops.panorama, verb).get_rna_type().properties
        assert properties["filepath"].is_skip_save  # a second drop must not open the first one's file
        extensions += handler.bl_file_extensions.split(";")
    assert extensions == [".exr", ".hdr", ".json"]
