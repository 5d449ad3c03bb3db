/* Texels around a place of a light's map. Beyond its border those at the border count. Samplers would mix
 * bytes that belong together; so each texel is fetched, and decoded before it is mixed. */

uniform sampler2DArray shadow_maps; /* a layer for each light */

const int LAST = RESOLUTION - 1;

vec4 encode(vec2 numbers);
vec2 decode(vec4 texel);

vec2 numbers_at(ivec2 place, int light)
{
  return decode(texelFetch(shadow_maps, ivec3(clamp(place, ivec2(0), ivec2(LAST)), light), 0));
}

/* What the four texels next to a place hold, mixed. */
vec2 bilinear(vec2 place, int light)
{
  vec2 corner = place * float(RESOLUTION) - 0.5;
  ivec2 first = ivec2(floor(corner));
  vec2 part = corner - floor(corner);
  vec2 near = mix(numbers_at(first, light), numbers_at(first + ivec2(1, 0), light), part.x);
  vec2 far = mix(numbers_at(first + ivec2(0, 1), light), numbers_at(first + ivec2(1, 1), light), part.x);
  return mix(near, far, part.y);
}
