/* A mesh as the camera sees it. */

layout(location = 0) in vec3 point;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
out vec3 position;
out vec3 upright;

void main()
{
  position = point;
  upright = normal;
  gl_Position = clip_from_world * vec4(point, 1.0);
}
