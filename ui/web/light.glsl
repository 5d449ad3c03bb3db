/* The lights. A sun is seen from at infinity, by an orthographic camera; a lamp by a perspective one. */

struct Light {
  mat4 clip_from_world;
  bool perspective;
  vec2 range;    /* nearest and farthest depth [m] */
  vec3 eye;      /* of a lamp [m] */
  vec3 to_sun;   /* unit vector */
  vec3 strength; /* of a sun [W/m²], of a lamp [W/sr] */
};
uniform Light lights[LIGHTS];

/* 0 at near, 1 at far, linear in metres, of the depth that a buffer has. */
float linear_depth(int light, float depth)
{
  if (!lights[light].perspective) {
    return depth;
  }
  vec2 range = lights[light].range;
  return depth * range.x / (range.y - depth * (range.y - range.x));
}
