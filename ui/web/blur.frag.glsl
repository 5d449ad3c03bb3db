/* One pass of the separable Gaussian, σ = WINDOW/4, over a layer of the maps. */

uniform int layer;
uniform ivec2 along;
out vec4 texel;

void main()
{
  vec2 sum = vec2(0.0);
  float whole = 0.0;
  for (int k = -(WINDOW / 2); k <= WINDOW / 2; k++) {
    float place = float(k) / (0.25 * float(WINDOW));
    float weight = exp(-0.5 * place * place);
    sum += weight * numbers_at(ivec2(gl_FragCoord.xy) + k * along, layer);
    whole += weight;
  }
  texel = encode(sum / whole);
}
