/* Meshes on the graphics card. */

/* Of each mesh {vertices, count, and what else it has}: attribute 0 are points, 1 normals. */
export function upload(gl, meshes) {
  return meshes.map(({ points, normals, triangles, ...others }) => {
    const vertices = gl.createVertexArray();
    gl.bindVertexArray(vertices);
    [points, normals].forEach((values, attribute) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(attribute);
      gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 0, 0);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { vertices, count: triangles.length, ...others };
  });
}

export function draw(gl, mesh) {
  gl.bindVertexArray(mesh.vertices);
  gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
}
