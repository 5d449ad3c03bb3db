/* What textures hold a map's texels. */

const STORED_BYTES = { "8+8": 1, "16+16": 2 };

export function hasMoments({ method }) {
  return method === "vsm" || method === "evsm";
}

/* {internalFormat, clear}: clear is the texel where there is nothing, at depth 1.
 * Errors: a device without textures of floats that can be drawn to. */
export function textureFormat(gl, settings) {
  const { method, storage } = settings;
  const moments = hasMoments(settings);
  if (storage === "float32") {
    if (!gl.getExtension("EXT_color_buffer_float")) {
      throw new Error("this device cannot draw to textures of 32-bit floats: choose 8+8 or 16+16 bits");
    }
    return { internalFormat: moments ? gl.RG32F : gl.R32F, clear: [1, 1, 0, 0] };
  }
  const bytes = STORED_BYTES[storage] * (moments ? 2 : 1);
  const second = method === "evsm" ? 0 : 1; // of depths that are all 1 the deviation, and the mean square
  return {
    internalFormat: { 1: gl.R8, 2: gl.RG8, 4: gl.RGBA8 }[bytes],
    clear: storage === "8+8" ? [1, second, 0, 0] : [1, 1, second, second],
  };
}

/* The texture array of a map of `resolution` texels a side for each of `layers`. */
export function textureArray(gl, internalFormat, resolution, layers) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
  gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, internalFormat, resolution, resolution, layers);
  gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
}
