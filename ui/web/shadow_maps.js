/* The lights' shadow maps: depth from each light, then the Gaussian over their moments. */

import { draw } from "meshes";
import { lightValues, program, use } from "programs";
import { hasMoments, textureArray, textureFormat } from "storage";

/* What the shaders of a kind of shadow map have in common. */
export function defines(settings, lights) {
  return {
    LIGHTS: lights.length,
    RESOLUTION: settings.resolution,
    WINDOW: settings.window,
    [`STORAGE_${settings.storage.replace("+", "_").toUpperCase()}`]: 1,
  };
}

export function lookupFiles(settings) {
  return ["light", "storage", "lookup", ...(hasMoments(settings) ? ["chebyshev"] : []), settings.method];
}

/* The values that a method's look-up needs. */
export function lookupValues(settings, lights) {
  return {
    ...lightValues(lights),
    bleeding_reduction: { "1f": settings.bleeding_reduction },
    exponent: { "1f": settings.exponent },
    shadow_maps: { "1i": 0 },
  };
}

/* Draw the maps of the meshes that throw shadows -> their texture, a layer for each light.
 * Errors: a resolution beyond the device's, and what `textureFormat` and `program` say. */
export function drawShadowMaps(gl, sources, meshes, lights, settings) {
  const { resolution } = settings;
  const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
  if (resolution > most) {
    throw new Error(`this device's textures end at ${most} texels a side, the shadow map has ${resolution}`);
  }
  const { internalFormat, clear } = textureFormat(gl, settings);
  const maps = textureArray(gl, internalFormat, resolution, lights.length);
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.viewport(0, 0, resolution, resolution);
  gl.disable(gl.BLEND);
  gl.disable(gl.DITHER);
  drawDepths(gl, sources, meshes, lights, settings, maps, clear);
  if (hasMoments(settings) && settings.window > 1) {
    blur(gl, sources, lights, settings, maps, internalFormat);
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(frame);
  return maps;
}

function drawDepths(gl, sources, meshes, lights, settings, maps, clear) {
  const files = lookupFiles(settings);
  const depth = program(gl, sources, {
    vertex: ["light", "depth.vert"],
    fragment: [...files, "depth.frag"],
    defines: defines(settings, lights),
  });
  const nearest = gl.createRenderbuffer();
  gl.bindRenderbuffer(gl.RENDERBUFFER, nearest);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, settings.resolution, settings.resolution);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, nearest);
  gl.enable(gl.DEPTH_TEST);
  gl.disable(gl.CULL_FACE);
  use(gl, depth, {
    ...lookupValues(settings, lights),
    offset_factor: { "1f": settings.offset_factor },
    offset_units: { "1f": settings.offset_units },
  });
  lights.forEach((_, light) => {
    drawTo(gl, maps, light);
    gl.clearBufferfv(gl.COLOR, 0, clear);
    use(gl, depth, { light: { "1i": light } });
    if (hasMoments(settings)) {
      drawGround(gl, depth, meshes, settings);
    }
    use(gl, depth, { ground_reach: { "1f": 0 } });
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    meshes.filter(({ extras }) => extras.throws).forEach((mesh) => draw(gl, mesh));
  });
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, null);
  gl.deleteRenderbuffer(nearest);
  gl.deleteProgram(depth);
}

/* What receives shadows and throws none, where nothing will throw one, see numpy's `filled`: the farthest; none
 * in the outermost texels. */
function drawGround(gl, depth, meshes, { resolution, window }) {
  use(gl, depth, { ground_reach: { "1f": window } });
  gl.enable(gl.SCISSOR_TEST);
  gl.scissor(1, 1, resolution - 2, resolution - 2);
  gl.clearBufferfv(gl.DEPTH, 0, [0]);
  gl.depthFunc(gl.GEQUAL);
  meshes.filter(({ extras }) => extras.role === "support" && !extras.throws).forEach((mesh) => draw(gl, mesh));
  gl.depthFunc(gl.LESS);
  gl.disable(gl.SCISSOR_TEST);
}

/* Along s, into a map that is kept for it, and back along t. */
function blur(gl, sources, lights, settings, maps, internalFormat) {
  const made = program(gl, sources, {
    vertex: ["screen.vert"],
    fragment: [...lookupFiles(settings), "blur.frag"],
    defines: defines(settings, lights),
  });
  const between = textureArray(gl, internalFormat, settings.resolution, 1);
  gl.disable(gl.DEPTH_TEST);
  gl.bindVertexArray(null);
  gl.activeTexture(gl.TEXTURE0);
  use(gl, made, lookupValues(settings, lights));
  lights.forEach((_, light) => {
    for (const [from, layer, to, target, along] of [
      [maps, light, between, 0, [1, 0]],
      [between, 0, maps, light, [0, 1]],
    ]) {
      drawTo(gl, to, target);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, from);
      use(gl, made, { layer: { "1i": layer }, along: { "2iv": along } });
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
  });
  gl.deleteTexture(between);
  gl.deleteProgram(made);
}

function drawTo(gl, texture, layer) {
  gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, texture, 0, layer);
}
