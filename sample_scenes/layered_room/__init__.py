"""The sample room of panoramas in layers: a room like the thesis's (Fig. 6-11), built by script."""
