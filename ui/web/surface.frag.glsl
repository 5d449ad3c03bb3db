/* What the lights and their shadows make of a surface. A support is real: it shows the background, darkened by
 * what it loses of the light. Anything else is new, and diffuse. The numpy reference is `remaining_light` of
 * ibl_toolkit/mobile/shadow_maps, with the ambient light added: keep them the same. */

#define PI 3.14159265358979

in vec3 position;
in vec3 upright;
uniform bool is_real;
uniform vec3 albedo;
uniform vec3 ambient;      /* irradiance without the lights [W/m²], looking up */
uniform vec3 ambient_down; /* looking down */
uniform float exposure;
uniform vec3 origin;       /* of the panorama, in the world [m] */
out vec4 colour;

/* 0 in shadow, 1 lit; beside the map all is lit. */
float visibility(int light)
{
  vec4 clip = lights[light].clip_from_world * vec4(position, 1.0);
  vec3 place = 0.5 * clip.xyz / clip.w + 0.5;
  if (clip.w <= 0.0 || any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, vec2(1.0)))) {
    return 1.0;
  }
  place.z = clamp(place.z, 0.0, 1.0);
  return lit(light, place);
}

void main()
{
  vec3 normal = normalize(upright);
  vec3 kept = mix(ambient_down, ambient, 0.5 + 0.5 * normal.z);
  vec3 whole = kept;
  for (int light = 0; light < LIGHTS; light++) {
    vec3 away = lights[light].perspective ? lights[light].eye - position : lights[light].to_sun;
    float cosine = dot(away, normal) / length(away);
    if (cosine > 0.0) {
      vec3 irradiance = lights[light].strength * (cosine / dot(away, away));
      whole += irradiance;
      kept += irradiance * visibility(light);
    }
  }
  if (is_real) {
    vec3 share = mix(vec3(1.0), kept / max(whole, vec3(1e-30)), greaterThan(whole, vec3(0.0)));
    colour = srgb(background(position - origin) * share);
  } else {
    colour = srgb(albedo / PI * kept * exposure);
  }
}
