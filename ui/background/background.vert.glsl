/* What the panorama is drawn on, in clip space: all of the region, or the floor far away. */

void main()
{
  place = corner.xyw;
  gl_Position = corner;
}
