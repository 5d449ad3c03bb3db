/* Shader programs, and the values that they are given. */

const HEAD = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2DArray;\n";

/* A program of shader files, each stage by its names in order. defines: {name: value} for both stages.
 * Errors: a device that cannot build it. */
export function program(gl, sources, { vertex, fragment, defines }) {
  const head = HEAD + Object.entries(defines).map(([name, value]) => `#define ${name} ${value}\n`).join("");
  const made = gl.createProgram();
  for (const [stage, names] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(stage);
    gl.shaderSource(shader, head + names.map((name) => sources[`${name}.glsl`]).join("\n"));
    gl.compileShader(shader);
    gl.attachShader(made, shader);
    gl.deleteShader(shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
    const logs = gl.getAttachedShaders(made).map((shader) => gl.getShaderInfoLog(shader));
    throw new Error(`this device cannot build its shaders: ${[...logs, gl.getProgramInfoLog(made)].join(" ")}`);
  }
  return made;
}

/* Use a program with values {name: {kind: value}}, kind as in gl.uniform<kind>; matrices are given row by row.
 * Names that the program does not use are passed over. */
export function use(gl, made, values) {
  gl.useProgram(made);
  for (const [name, given] of Object.entries(values)) {
    const [[kind, value]] = Object.entries(given);
    const place = gl.getUniformLocation(made, name);
    if (kind.startsWith("Matrix")) {
      gl[`uniform${kind}`](place, true, value.flat());
    } else {
      gl[`uniform${kind}`](place, value);
    }
  }
}

/* The values of `lights[]`, see light.glsl. */
export function lightValues(lights) {
  const values = {};
  lights.forEach((light, k) => {
    values[`lights[${k}].clip_from_world`] = { Matrix4fv: light.clip_from_world };
    values[`lights[${k}].perspective`] = { "1i": light.perspective };
    values[`lights[${k}].range`] = { "2fv": light.range };
    values[`lights[${k}].eye`] = { "3fv": light.eye };
    values[`lights[${k}].to_sun`] = { "3fv": light.to_sun };
    values[`lights[${k}].strength`] = { "3fv": light.strength };
  });
  return values;
}
