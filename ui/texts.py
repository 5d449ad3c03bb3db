"""Text in panels that are as narrow as the artist makes them."""

import textwrap

LETTER = 6.2
"""Mean width of a letter [px at a UI scale of 1]."""
MARGIN, ICON = 50, 22
"""What the panel's borders and tabs, and an icon, take [px at a UI scale of 1]."""


def paragraph(layout, context, text: str, icon: str = "NONE"):
    """Show a sentence in as many lines as the region's width needs, the icon beside the first."""
    scale = context.preferences.system.ui_scale or 1  # 0 without a window
    width = (context.region.width if context.region else 300) / scale - MARGIN
    width -= ICON if icon != "NONE" else 0
    column = layout.column(align=True)
    column.scale_y = 0.8
    for index, line in enumerate(textwrap.wrap(text, max(int(width / LETTER), 12))):
        column.label(text=line, icon="BLANK1" if index and icon != "NONE" else icon)


def figure(layout, name: str, value: str):
    """Show a name and a value side by side."""
    row = layout.row()
    row.scale_y = 0.8
    row.label(text=name)
    right = row.row()
    right.alignment = "RIGHT"
    right.label(text=value)
