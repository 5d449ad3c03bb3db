"""Text in panels that are as narrow as the artist makes them."""

import textwrap

LETTER = 6.3
"""Mean width of a letter [px at a UI scale of 1]."""
MARGIN = 75
"""What the panel's borders and the icon take [px at a UI scale of 1]."""


def paragraph(layout, context, text: str, icon: str = "NONE"):
    """Show a sentence in as many lines as the region's width needs, the icon beside the first."""
    scale = context.preferences.system.ui_scale
    width = context.region.width / scale if context.region else 300
    column = layout.column(align=True)
    column.scale_y = 0.8
    for index, line in enumerate(textwrap.wrap(text, max(int((width - MARGIN) / LETTER), 12))):
        column.label(text=line, icon="BLANK1" if index and icon != "NONE" else icon)


def figure(layout, name: str, value: str):
    """Show a name and a value side by side."""
    row = layout.row()
    row.scale_y = 0.8
    row.label(text=name)
    right = row.row()
    right.alignment = "RIGHT"
    right.label(text=value)
