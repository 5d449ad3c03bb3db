"""What all operators share: one call, its errors as reports, its reasons in the poll."""


class Reporting:
    """An operator that works in `work(context)`, which returns the line to report, or raises.

    ValueError and OSError become an error report and CANCELLED: work that raises has changed nothing.
    """

    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Work, and report."""
        try:
            done = self.work(context)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, done)
        return {"FINISHED"}


def possible(cls, reason: str) -> bool:
    """Whether an operator may run: there is no reason against it; else the button says which."""
    if reason:
        cls.poll_message_set(reason)
    return not reason
