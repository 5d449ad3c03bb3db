"""Modal tools on the panorama: what is common to them, the one that picks, and the one that draws."""

from .base import Tool, active_tool, busy, close_tool

__all__ = ["Tool", "active_tool", "busy", "close_tool"]
