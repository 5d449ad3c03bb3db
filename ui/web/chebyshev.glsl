/* What moments tell of the depths under a filter. */

uniform float bleeding_reduction;

/* Upper bound of the part of them that is at a depth or beyond. least: of the variance. */
float chebyshev(vec2 moments, float depth, float least)
{
  float variance = max(moments.y - moments.x * moments.x, least);
  float beyond = max(depth - moments.x, 0.0);
  return beyond > 0.0 ? variance / (variance + beyond * beyond) : 1.0;
}

/* What is lit less than the reduction is dark, the rest is spread over 0 to 1. */
float without_bleeding(float light)
{
  return clamp((light - bleeding_reduction) / (1.0 - bleeding_reduction), 0.0, 1.0);
}
