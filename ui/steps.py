"""What the panels of the 3D View's sidebar tab "Panorama" share: each is one step of the work."""

from .texts import paragraph


class InSidebar:
    """The place of a panel."""

    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Panorama"


class Step(InSidebar):
    """One step: a tick when it is done, what is missing when it cannot be, and its buttons."""

    bl_parent_id = "PANORAMA_PT_job"

    def draw_header(self, context):
        """The tick."""
        done = self.is_done(context.scene)
        self.layout.label(text="", icon="CHECKMARK" if done else "RADIOBUT_OFF")

    def say(self, context, text, icon="INFO"):
        """Show a sentence, if there is one."""
        if text:
            paragraph(self.layout, context, text, icon)
