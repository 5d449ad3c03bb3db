"""The kinds of node trees that a preview is built in."""

SHADER, COMPOSITOR = "ShaderNodeTree", "CompositorNodeTree"
GROUP_NODES = {SHADER: "ShaderNodeGroup", COMPOSITOR: "CompositorNodeGroup"}
"""The node that stands for a group in each."""
