/* The panorama as a view of the scene shows it: scene-linear radiance, as the image has it.
 *
 * Source: thesis section 5.5.2, eq. 5.5 and Alg. 5.1. The numpy reference is View.directions_at of
 * ibl_toolkit/views.py with sample of ibl_toolkit/equirectangular.py: keep them the same.
 *
 * Push constants, each a vec4. The first three components, in the panorama frame around its origin:
 *   eye + x eye_x + y eye_y   where the ray of (x, y) begins [m]; x, y in [-1, 1] over the region
 *   ray + x ray_x + y ray_y   its direction
 *   up                        the world's z
 * and in the fourth:
 *   eye 1 for rays from one point, 0 for parallel ones    ray    what the radiance is multiplied by
 *   eye_x, eye_y width and height of a pixel in x and y    up     camera height above the floor [m]
 *   ray_x share of the panorama in the mix
 */

#define HALF_TURN 3.14159265358979
#define PARALLEL 1e-6        /* sine of the angle to the floor below which a ray never meets it */
#define LARGEST_HALF 65504.0 /* brighter pixels, as of the sun, became infinite in the texture */
#define MOST_STEPS 4

vec3 direction_at(vec2 xy)
{
  vec3 along = ray.xyz + xy.x * ray_x.xyz + xy.y * ray_y.xyz;
  float sinking = dot(along, up.xyz);
  if (eye.w == 1.0 || abs(sinking) < PARALLEL) {
    return normalize(along);
  }
  vec3 start = eye.xyz + xy.x * eye_x.xyz + xy.y * eye_y.xyz;
  return normalize(start - (dot(start, up.xyz) + up.w) / sinking * along);
}

/* Column and row from the top, taken round the seam and over the poles: there the columns are those of the
 * other side. The texture begins with its bottom row. */
vec3 texel(int column, int row, ivec2 size)
{
  if (row < 0 || row >= size.y) {
    column += size.x / 2;
  }
  column = (column + 2 * size.x) % size.x;
  row = clamp(row, 0, size.y - 1);
  return min(texelFetch(panorama, ivec2(column, size.y - 1 - row), 0).rgb, vec3(LARGEST_HALF));
}

/* By hand and not by the sampler, which would blend the poles' rows with themselves, and the image's other
 * border where it is told to repeat. */
vec3 look_up(vec3 direction, ivec2 size)
{
  bool at_pole = direction.x == 0.0 && direction.y == 0.0;
  float u = 0.5 - atan(direction.y, at_pole ? 1.0 : direction.x) / (2.0 * HALF_TURN);
  float v = 0.5 - atan(direction.z, length(direction.xy)) / HALF_TURN;
  vec2 position = vec2(u, v) * vec2(size) - 0.5;
  vec2 corner = floor(position);
  vec2 part = position - corner;
  int i = int(corner.x);
  int j = int(corner.y);
  vec3 top = mix(texel(i, j, size), texel(i + 1, j, size), part.x);
  vec3 bottom = mix(texel(i, j + 1, size), texel(i + 1, j + 1, size), part.x);
  return mix(top, bottom, part.y);
}

void main()
{
  ivec2 size = textureSize(panorama, 0);
  vec2 ndc = place.xy / place.z;
  vec2 pixel = vec2(eye_x.w, eye_y.w);

  /* Where a pixel covers several of the image's, the mean of a grid of points in it. */
  vec3 middle = direction_at(ndc);
  float across = length(direction_at(ndc + vec2(pixel.x, 0.0)) - middle);
  float upwards = length(direction_at(ndc + vec2(0.0, pixel.y)) - middle);
  float covered = max(across, upwards) * float(size.x) / (2.0 * HALF_TURN);
  int steps = clamp(int(covered + 0.5), 1, MOST_STEPS);

  vec3 sum = vec3(0.0);
  for (int row = 0; row < steps; row++) {
    for (int column = 0; column < steps; column++) {
      vec2 offset = (vec2(column, row) + 0.5) / float(steps) - 0.5;
      sum += look_up(direction_at(ndc + offset * pixel), size);
    }
  }
  vec3 radiance = sum * (ray.w / float(steps * steps));
  colour = vec4(radiance, 1.0) * ray_x.w;
}
