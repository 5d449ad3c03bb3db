/* glTF 2.0 in one file, as far as our own files use it: meshes of triangles with normals, and extras. */

const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
const ARRAYS = { 5126: Float32Array, 5125: Uint32Array };
const NUMBERS = { SCALAR: 1, VEC3: 3 };

/* {extras, meshes}: the scene's extras, and of each mesh {name, points, normals, triangles, albedo, extras}.
 * Points [m] and normals are z up again, three numbers each. */
export function readGlb(bytes) {
  const { document, binary } = chunks(bytes);
  const array = (number) => {
    const accessor = document.accessors[number];
    const view = document.bufferViews[accessor.bufferView];
    const count = accessor.count * NUMBERS[accessor.type];
    return new ARRAYS[accessor.componentType](binary, view.byteOffset, count);
  };
  const meshes = document.meshes.map(({ name, primitives: [primitive] }) => {
    const material = document.materials[primitive.material];
    return {
      name,
      points: zUp(array(primitive.attributes.POSITION)),
      normals: zUp(array(primitive.attributes.NORMAL)),
      triangles: array(primitive.indices),
      albedo: material.pbrMetallicRoughness.baseColorFactor.slice(0, 3),
      extras: material.extras,
    };
  });
  return { extras: document.scenes[document.scene].extras, meshes };
}

function chunks(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const found = {};
  for (let at = 12; at < view.getUint32(8, true); ) {
    const length = view.getUint32(at, true);
    found[view.getUint32(at + 4, true)] = bytes.slice(at + 8, at + 8 + length);
    at += 8 + length;
  }
  const text = new TextDecoder().decode(found[JSON_CHUNK]);
  return { document: JSON.parse(text), binary: found[BINARY_CHUNK].buffer };
}

/* glTF's (x, z, −y) as (x, y, z). */
function zUp(vectors) {
  const turned = new Float32Array(vectors.length);
  for (let k = 0; k < vectors.length; k += 3) {
    turned.set([vectors[k], -vectors[k + 2], vectors[k + 1]], k);
  }
  return turned;
}
