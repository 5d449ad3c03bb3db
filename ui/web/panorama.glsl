/* The background: an equirectangular panorama. The numpy reference is `sample` of ibl_toolkit/equirectangular.py:
 * keep them the same. */

#define HALF_TURN 3.14159265358979

uniform sampler2D picture; /* row 0 is the top one */
uniform mat3 panorama_from_world;

/* Round the seam and over the poles: there the columns are those of the other side. */
vec3 texel_at(int column, int row, ivec2 size)
{
  if (row < 0 || row >= size.y) {
    column += size.x / 2;
  }
  column = (column + 2 * size.x) % size.x;
  return texelFetch(picture, ivec2(column, clamp(row, 0, size.y - 1)), 0).rgb;
}

/* Linear colour in a direction of the world. */
vec3 background(vec3 direction)
{
  vec3 at = panorama_from_world * direction;
  bool at_pole = at.x == 0.0 && at.y == 0.0;
  float u = 0.5 - atan(at.y, at_pole ? 1.0 : at.x) / (2.0 * HALF_TURN);
  float v = 0.5 - atan(at.z, length(at.xy)) / HALF_TURN;
  ivec2 size = textureSize(picture, 0);
  vec2 place = vec2(u, v) * vec2(size) - 0.5;
  vec2 part = place - floor(place);
  int i = int(floor(place.x));
  int j = int(floor(place.y));
  vec3 top = mix(texel_at(i, j, size), texel_at(i + 1, j, size), part.x);
  vec3 bottom = mix(texel_at(i, j + 1, size), texel_at(i + 1, j + 1, size), part.x);
  return mix(top, bottom, part.y);
}
