"""What mouse and keys do while a shape is drawn, for the status bar."""

BASES = {
    "polygon": "Corner; the first one again closes",
    "rectangle": "One whole side, then the opposite one",
    "square": "Two opposite corners",
    "circle": "Points of its edge; the first one again closes",
}


def hints(shape, typed) -> tuple[tuple[str, str], ...]:
    """Icons with what they do, for a DrawnShape and the length typed so far."""
    is_raised = shape.base is not None
    part = ("walls" if is_raised else "floor") if shape.kind == "room" else "role"
    said = [("MOUSE_LMB", "Height of the upper edge" if is_raised else BASES[shape.flat])]
    if not is_raised:
        said.append(("EVENT_SHIFT", "Square to the axes and the sides before"))
    if typed:
        said.append(("EVENT_RETURN", f"Set {typed}"))
    else:
        said.append(("EVENT_RETURN", "Confirm; digits type a length"))
    said.append(("EVENT_R", f"{part.title()}: {shape.role.title()}"))
    if shape.has_ceiling:
        said.append(("EVENT_C", f"Ceiling: {'yes' if shape.ceiling else 'no'}"))
    return (*said, ("EVENT_BACKSPACE", "Back"), ("EVENT_ESC", "Cancel"))
