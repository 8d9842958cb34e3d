// Force of the cells around a node of a soft body on it. Requires `args` with incident, forces and stride.
#ifndef PALPATE_LIB_SOFT_FORCES_GLSL
#define PALPATE_LIB_SOFT_FORCES_GLSL

vec3 forceOn(uint node) {
  const uvec4 low = args.incident.at[kIncidentUVec4s * node], high = args.incident.at[kIncidentUVec4s * node + 1];
  vec3 force = vec3(0);
  for (uint k = 0; k < 8; ++k) {
    const uint word = k < 4 ? low[k] : high[k - 4];
    force += vec3(args.forces.at[word], args.forces.at[word + args.stride], args.forces.at[word + 2 * args.stride]);
  }
  return force;
}

#endif
