/* Percentage-closer filtering: the mean of the comparisons under a box that is WINDOW texels wide and lies
 * over a place of the map; the outermost texels count with the share of them that it covers. */

vec4 encode(vec2 numbers)
{
  return pack(numbers);
}

vec2 decode(vec4 texel)
{
  return unpack(texel);
}

vec2 numbers_of(int light, float depth)
{
  return vec2(depth, 0.0);
}

float covered(float share, int texel)
{
  return texel == 0 ? 1.0 - share : texel == WINDOW ? share : 1.0;
}

float lit(int light, vec3 place)
{
  vec2 corner = place.xy * float(RESOLUTION) - 0.5 * float(WINDOW);
  ivec2 first = ivec2(floor(corner));
  vec2 share = corner - floor(corner);
  float sum = 0.0;
  for (int down = 0; down <= WINDOW; down++) {
    for (int across = 0; across <= WINDOW; across++) {
      if (place.z <= numbers_at(first + ivec2(across, down), light).x) {
        sum += covered(share.x, across) * covered(share.y, down);
      }
    }
  }
  return sum / float(WINDOW * WINDOW);
}
