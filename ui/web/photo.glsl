/* The background: a camera's photo, which fills the picture whatever is seen in it. */

uniform sampler2D picture; /* row 0 is the top one */
uniform vec2 picture_size; /* of what is drawn [px] */

vec3 background(vec3 direction)
{
  vec2 place = gl_FragCoord.xy / picture_size;
  return texture(picture, vec2(place.x, 1.0 - place.y)).rgb;
}
