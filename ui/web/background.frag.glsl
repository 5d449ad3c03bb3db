/* The background behind everything. */

in vec2 ndc;
uniform mat3 world_from_ray; /* of (x, y, 1), x and y from −1 to 1 */
out vec4 colour;

void main()
{
  colour = srgb(background(world_from_ray * vec3(ndc, 1.0)));
}
