/* Two numbers from 0 to 1 as a texel holds them. The numpy reference is storage.py of
 * ibl_toolkit/mobile/shadow_maps: keep them the same.
 *
 * STEP is the step between two numbers that a storage tells apart. A texture of bytes shows them as
 * parts of 255. */

#if defined(STORAGE_FLOAT32)

vec4 pack(vec2 numbers)
{
  return vec4(numbers, 0.0, 0.0);
}

vec2 unpack(vec4 texel)
{
  return texel.xy;
}

#elif defined(STORAGE_8_8)

const float STEP = 1.0 / 255.0;

vec4 pack(vec2 numbers)
{
  return vec4(floor(clamp(numbers, 0.0, 1.0) * 255.0 + 0.5) / 255.0, 0.0, 0.0);
}

vec2 unpack(vec4 texel)
{
  return texel.xy;
}

#elif defined(STORAGE_16_16)

const float STEP = 1.0 / 65535.0;

/* The high byte first, then the low one. */
vec4 pack(vec2 numbers)
{
  vec2 whole = floor(clamp(numbers, 0.0, 1.0) * 65535.0 + 0.5);
  vec2 high = floor(whole / 256.0);
  vec2 low = whole - 256.0 * high;
  return vec4(high.x, low.x, high.y, low.y) / 255.0;
}

vec2 unpack(vec4 texel)
{
  vec4 bytes = floor(texel * 255.0 + 0.5);
  return (bytes.xz * 256.0 + bytes.yw) * STEP;
}

#endif
