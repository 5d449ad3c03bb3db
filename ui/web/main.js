/* The page: what is in it is read, drawn, and drawn again when the view or the kind of shadow map changes. */

import { readGlb } from "glb";
import { upload } from "meshes";
import { Picture, backgroundTexture } from "picture";
import { drawShadowMaps } from "shadow_maps";
import { View, control } from "view";

const canvas = document.querySelector("canvas");
const choice = document.querySelector("select");
const sources = JSON.parse(document.getElementById("shaders").textContent);

function start(image) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) {
    throw new Error("this browser or device has no WebGL 2");
  }
  const { extras: scene, meshes } = readGlb(bytesOf(document.getElementById("scene").textContent));
  const uploaded = upload(gl, meshes);
  const texture = backgroundTexture(gl, image);
  const view = new View(scene.camera);
  let maps, picture;

  const paint = () => {
    resize(scene.background.kind === "photo" ? image : null);
    if (picture) {
      picture.draw(view, maps);
    }
  };
  const later = onceAFrame(paint);
  const choose = () => {
    const settings = scene.shadow_settings[choice.selectedIndex];
    const newMaps = drawShadowMaps(gl, sources, uploaded, scene.lights, settings);
    const newPicture = new Picture(gl, sources, uploaded, scene, settings, texture);
    gl.deleteTexture(maps); // only now: where the new ones fail, the old ones stay
    picture?.free();
    [maps, picture] = [newMaps, newPicture];
    paint();
  };
  choice.append(...scene.shadow_settings.map(({ label }) => new Option(label)));
  choice.hidden = scene.shadow_settings.length < 2;
  choice.addEventListener("change", () => guarded(choose));
  addEventListener("resize", later);
  if (scene.background.kind === "panorama") {
    control(canvas, view, later);
  }
  choose();
}

/* As many pixels as the screen has; a photo keeps its shape. */
function resize(photo) {
  let [width, height] = [innerWidth, innerHeight];
  if (photo) {
    const scale = Math.min(width / photo.naturalWidth, height / photo.naturalHeight);
    [width, height] = [photo.naturalWidth * scale, photo.naturalHeight * scale];
  }
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  canvas.width = Math.round(width * devicePixelRatio);
  canvas.height = Math.round(height * devicePixelRatio);
}

function onceAFrame(paint) {
  let waiting = false;
  return () => {
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        paint();
      });
    }
  };
}

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/* Do it; what goes wrong is said on the page. */
function guarded(work) {
  const complaint = document.querySelector("output");
  complaint.textContent = "";
  try {
    work();
  } catch (error) {
    complaint.textContent = error.message;
  }
}

const image = document.querySelector("img");
await image.decode();
guarded(() => start(image));
