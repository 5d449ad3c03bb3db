/* One comparison with one texel: Williams's shadow map. */

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

float lit(int light, vec3 place)
{
  return place.z <= numbers_at(ivec2(floor(place.xy * float(RESOLUTION))), light).x ? 1.0 : 0.0;
}
