/* Frames of the phone's page on demand: the server says which part of which kind is drawn next, and takes the
 * time until the next question. The page's modules are its own; only its programs are kept between frames. */

import { readGlb } from "glb";
import { upload } from "meshes";
import { Picture, backgroundTexture } from "picture";
import { drawShadowMaps } from "shadow_maps";
import { View } from "view";

const image = document.querySelector("img");
await image.decode();
const sources = await (await fetch("/shaders.json")).json();
const { extras, meshes } = readGlb(new Uint8Array(await (await fetch("/scene.glb")).arrayBuffer()));
const gl = document.querySelector("canvas").getContext("webgl2", { antialias: true, alpha: false });
gl.deleteProgram = () => {};
const uploaded = upload(gl, meshes);
const texture = backgroundTexture(gl, image);
const view = new View(extras.camera);
let maps, picture;

const parts = {
  maps: (settings, scene) => {
    gl.deleteTexture(maps);
    maps = drawShadowMaps(gl, sources, uploaded, scene.lights, settings);
    picture = new Picture(gl, sources, uploaded, scene, settings, texture);
  },
  picture: () => picture.draw(view, maps),
};

/* What the server answers, at once: nothing else of this page runs in between. */
function ask(address) {
  const request = new XMLHttpRequest();
  request.open("GET", address, false);
  request.send();
  return JSON.parse(request.responseText);
}

for (let next; (next = ask("/next")); ) {
  const scene = { ...extras, lights: [extras.lights[next.light]] };
  parts[next.part](extras.shadow_settings[next.kind], scene);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // only then is it drawn
}
