#ifndef PALPATE_CHANGED_POINT_GLSL
#define PALPATE_CHANGED_POINT_GLSL

bool differ(vec3 one, vec3 other) { return any(notEqual(floatBitsToUint(one), floatBitsToUint(other))); }

// Whether an entry of the edit log changes what discs depend on, and not only the colour of a point. `before`,
// `normalBefore`: the drawn point; `stays`: the entry does not remove it.
bool changesDiscs(vec4 before, vec3 normalBefore, bool stays, vec3 position, vec3 normal) {
  const bool wasThere = floatBitsToUint(before.w) != kEmptySlot;
  return wasThere != stays || stays && (differ(before.xyz, position) || differ(normalBefore, normal));
}

#endif
