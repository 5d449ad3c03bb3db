"""What an add-on may leave behind, counted: handlers, timers, callbacks, GPU textures. Runs in Blender."""

import sys

import bpy
import gpu

SPACES = (bpy.types.SpaceView3D, bpy.types.SpaceImageEditor)


class Watch:
    """Counts what is registered from now on and not taken back, until `end`."""

    def __init__(self):
        self.timers, self.textures, self.callbacks = [], [], []
        self._handlers = handlers()
        self._undone = []
        self._replace(bpy.app.timers, "register", self._keep_timer)
        self._replace(gpu.types, "GPUTexture", self._keep_texture)
        self._replace(gpu.texture, "from_image", self._keep_texture)
        for space in SPACES:
            self._replace(space, "draw_handler_add", self._keep_callback)
            self._replace(space, "draw_handler_remove", self._drop_callback)

    def left(self):
        """What is still there: {kind: count}."""
        return {
            "handlers": sum(len(now) - len(self._handlers[name]) for name, now in handlers().items()),
            "timers": sum(bpy.app.timers.is_registered(timer) for timer in self.timers),
            "callbacks": len(self.callbacks),
            # One reference is the list's, one the argument's, one the loop's.
            "textures": sum(sys.getrefcount(texture) > 3 for texture in self.textures),
        }

    def has_texture_of(self, image):
        """Whether an image still has the texture that was made of it: else this makes another."""
        before = len(self.textures)
        gpu.texture.from_image(image)
        return len(self.textures) == before

    def end(self):
        """Give Blender its functions back."""
        for owner, name, function in self._undone:
            setattr(owner, name, function)

    def _replace(self, owner, name, keep):
        original = getattr(owner, name)
        self._undone.append((owner, name, original))
        setattr(owner, name, lambda *values, **how: keep(original, *values, **how))

    def _keep_timer(self, register, function, **how):
        self.timers.append(function)
        return register(function, **how)

    def _keep_texture(self, make, *what, **how):
        texture = make(*what, **how)
        if not any(texture is kept for kept in self.textures):  # Blender gives an image's texture again
            self.textures.append(texture)
        return texture

    def _keep_callback(self, add, *values):
        self.callbacks.append(add(*values))
        return self.callbacks[-1]

    def _drop_callback(self, remove, handle, *values):
        self.callbacks = [kept for kept in self.callbacks if kept is not handle]
        return remove(handle, *values)


def handlers():
    """All of Blender's handlers: {name: [functions]}."""
    names = [name for name in dir(bpy.app.handlers) if isinstance(getattr(bpy.app.handlers, name), list)]
    return {name: list(getattr(bpy.app.handlers, name)) for name in names}
