/* What a screen is given. Source: IEC 61966-2-1. */

vec4 srgb(vec3 linear)
{
  linear = clamp(linear, 0.0, 1.0);
  vec3 bright = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
  return vec4(mix(bright, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308))), 1.0);
}
