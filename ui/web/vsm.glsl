/* Variance shadow maps: mean and mean square of the linear depths under a Gaussian. */

#ifdef STORAGE_FLOAT32
const float LEAST = 1.5 / 8388608.0;
#else
const float LEAST = 1.5 * STEP;
#endif

vec4 encode(vec2 moments)
{
  return pack(moments);
}

vec2 decode(vec4 texel)
{
  return unpack(texel);
}

vec2 numbers_of(int light, float depth)
{
  float z = linear_depth(light, depth);
  return vec2(z, z * z);
}

float lit(int light, vec3 place)
{
  return without_bleeding(chebyshev(bilinear(place.xy, light), linear_depth(light, place.z), LEAST));
}
