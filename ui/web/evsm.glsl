/* Exponential variance shadow maps: moments of x = exp(c (z − 1)), z being the linear depth. Whole numbers hold
 * them as 1 + ln(mean)/c and b/(1 + b), b being the relative deviation; see evsm.py, the numpy reference. */

uniform float exponent;

float warped(float z)
{
  return exp(exponent * (z - 1.0));
}

vec2 numbers_of(int light, float depth)
{
  float x = warped(linear_depth(light, depth));
  return vec2(x, x * x);
}

#ifdef STORAGE_FLOAT32

const float LEAST_DEVIATION = 1e-3;

vec4 encode(vec2 moments)
{
  return pack(moments);
}

vec2 decode(vec4 texel)
{
  return unpack(texel);
}

float least_deviation()
{
  return LEAST_DEVIATION;
}

#else

vec4 encode(vec2 moments)
{
  float mean = max(moments.x, exp(-exponent));
  float deviation = sqrt(max(moments.y - mean * mean, 0.0)) / mean;
  return pack(vec2(1.0 + log(mean) / exponent, deviation / (1.0 + deviation)));
}

vec2 decode(vec4 texel)
{
  vec2 numbers = unpack(texel);
  float mean = warped(numbers.x);
  float share = min(numbers.y, 1.0 - 0.5 * STEP); /* 1 stands for all that is beyond */
  float deviation = share / (1.0 - share);
  return vec2(mean, mean * mean * (1.0 + deviation * deviation));
}

float least_deviation()
{
  return exponent * STEP;
}

#endif

float lit(int light, vec3 place)
{
  float x = warped(linear_depth(light, place.z));
  float least = least_deviation() * x;
  return without_bleeding(chebyshev(bilinear(place.xy, light), x, least * least));
}
