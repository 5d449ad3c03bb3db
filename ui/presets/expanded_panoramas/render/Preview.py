"""A first look in seconds: few paths, smoothed."""

import bpy

job = bpy.context.scene.panorama_set.job

job.method = "catcher"
job.samples = 16
job.denoise = True
