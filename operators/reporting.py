"""What all operators share: one call, its errors as reports, its reasons in the poll."""

from ..cycles_integration.roles import is_editable


class Reporting:
    """An operator that works in `work(context)`, which returns the line to report, or raises.

    ValueError and OSError become an error report and CANCELLED: work that raises has changed nothing.
    """

    bl_options = {"REGISTER", "UNDO"}

    def __init_subclass__(cls, **keywords):
        """The docstring is the tooltip, which Blender would show with the line breaks of the source."""
        super().__init_subclass__(**keywords)
        if "bl_idname" in vars(cls) and cls.__doc__:
            cls.bl_description = " ".join(cls.__doc__.split())

    def execute(self, context):
        """Work, and report."""
        try:
            refuse_linked(context.scene)
            done = self.work(context)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, done)
        return {"FINISHED"}


def refuse_linked(scene):
    """Raise ValueError where a scene is linked from another file, so that no change of it would stay."""
    if scene.library is not None:
        raise ValueError(
            f"scene '{scene.name}' is linked from {scene.library.filepath} and cannot be changed here: "
            "open that file, or make a scene of your own"
        )


def editable(things) -> tuple[list, str]:
    """Those data-blocks that may be changed, and a warning that names linked ones which were left alone.

    Raises ValueError where none is left.
    """
    linked = [thing for thing in things if not is_editable(thing)]
    names = ", ".join(f"'{thing.name}'" for thing in linked)
    warning = (
        f"{names}: linked from another file, so left alone; override or make local first" if linked else ""
    )
    if len(linked) == len(things):
        raise ValueError(warning)
    return [thing for thing in things if is_editable(thing)], warning


def possible(cls, reason: str) -> bool:
    """Whether an operator may run: there is no reason against it; else the button says which."""
    if reason:
        cls.poll_message_set(reason)
    return not reason
