/* The depth of what a light sees, as its map stores it. Each triangle is moved away from the light first, as
 * glPolygonOffset would with a depth buffer that has the storage's steps; what is nearest then is kept. */

uniform int light;
uniform float offset_factor;
uniform float offset_units;
uniform float ground_reach; // texels; 0 for what throws shadows
out vec4 texel;

float resolvable(float depth)
{
#ifdef STORAGE_FLOAT32
  return uintBitsToFloat(floatBitsToUint(depth) & 0x7f800000u) / 8388608.0;
#else
  return STEP;
#endif
}

void main()
{
  float depth = gl_FragCoord.z;
  float steepest = max(abs(dFdx(depth)), abs(dFdy(depth)));
  float moved = clamp(depth + steepest * offset_factor + resolvable(depth) * offset_units, 0.0, 1.0);
  if (moved + steepest * ground_reach >= 1.0) {
    moved = 1.0; // the slope comes to far within the filter, which would darken it
  }
  gl_FragDepth = moved;
  texel = encode(numbers_of(light, moved));
}
