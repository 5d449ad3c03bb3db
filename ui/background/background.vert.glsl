/* A triangle that covers the region, at the far plane: whatever has been drawn lies before it. */

void main()
{
  ndc = corner;
  gl_Position = vec4(corner, 1.0, 1.0);
}
