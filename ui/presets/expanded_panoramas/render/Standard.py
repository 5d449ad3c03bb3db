"""Enough for most pictures: smoothed, fine texture kept."""

import bpy

job = bpy.context.scene.panorama_set.job

job.method = "catcher"
job.samples = 128
job.denoise = True
