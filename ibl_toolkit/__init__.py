"""Mathematics and file formats of Expanded Panoramas: plain Python, no bpy."""
