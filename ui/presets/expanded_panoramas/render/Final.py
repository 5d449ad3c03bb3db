"""For delivery: many paths, noise left as it is, so that no texture is smoothed away."""

import bpy

job = bpy.context.scene.panorama_set.job

job.method = "catcher"
job.samples = 1024
job.denoise = False
