/* The page's "programs", each built once: a device whose light moves does not compile anew. */

import { program as built } from "programs as shipped";

export { lightValues, use } from "programs as shipped";

const kept = {};

export function program(gl, sources, parts) {
  return (kept[JSON.stringify(parts)] ??= built(gl, sources, parts));
}
