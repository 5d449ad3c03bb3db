/* The lit pass: background, then meshes, those that are real showing the background darkened by shadows. */

import { draw } from "meshes";
import { program, use } from "programs";
import { defines, lookupFiles, lookupValues } from "shadow_maps";

/* The background's texture. image: decoded. */
export function backgroundTexture(gl, image) {
  const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
  if (Math.max(image.naturalWidth, image.naturalHeight) > most) {
    throw new Error(`this device's textures end at ${most} px, the background is ${image.naturalWidth} wide`);
  }
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.SRGB8_ALPHA8, gl.RGBA, gl.UNSIGNED_BYTE, image);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

export class Picture {
  /* scene: the glb's extras. */
  constructor(gl, sources, meshes, scene, settings, texture) {
    const { lights, background } = scene;
    Object.assign(this, { gl, meshes, scene, texture });
    const shown = [background.kind, "display"];
    this.behind = program(gl, sources, {
      vertex: ["screen.vert"],
      fragment: [...shown, "background.frag"],
      defines: {},
    });
    this.surfaces = program(gl, sources, {
      vertex: ["surface.vert"],
      fragment: [...lookupFiles(settings), ...shown, "surface.frag"],
      defines: defines(settings, lights),
    });
    const picture = { "1i": 1 };
    const turn = { Matrix3fv: background.panorama_from_world };
    this.use(this.behind, { picture, panorama_from_world: turn });
    this.use(this.surfaces, {
      ...lookupValues(settings, lights),
      picture,
      panorama_from_world: turn,
      origin: { "3fv": background.origin },
      ambient: { "3fv": scene.ambient },
      ambient_down: { "3fv": scene.ambient_down },
      exposure: { "1f": background.exposure },
    });
  }

  free() {
    this.gl.deleteProgram(this.behind);
    this.gl.deleteProgram(this.surfaces);
  }

  draw(view, maps) {
    const { gl } = this;
    const size = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const aspect = size[0] / size[1];
    const { near, far } = this.scene;
    gl.viewport(0, 0, ...size);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, maps);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(null);
    this.use(this.behind, {
      picture_size: { "2fv": size },
      world_from_ray: { Matrix3fv: view.worldFromRay(aspect) },
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.use(this.surfaces, {
      picture_size: { "2fv": size },
      clip_from_world: { Matrix4fv: view.clipFromWorld(aspect, near, far) },
    });
    for (const mesh of this.meshes) {
      this.use(this.surfaces, {
        is_real: { "1i": mesh.extras.role !== "synthetic" },
        albedo: { "3fv": mesh.albedo },
      });
      draw(gl, mesh);
    }
  }

  use(made, values) {
    use(this.gl, made, values);
  }
}
