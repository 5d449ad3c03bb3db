/* The scene as a light sees it. */

layout(location = 0) in vec3 point;
uniform int light;

void main()
{
  gl_Position = lights[light].clip_from_world * vec4(point, 1.0);
}
