// A neighbour in a list of four: its slot, and the image of it that is near.
#ifndef PALPATE_LIB_MATTER_LISTS_GLSL
#define PALPATE_LIB_MATTER_LISTS_GLSL

uint listed(uint slot, uint image) { return slot | image << kSlotBits; }
uint slotOf(uint neighbour) { return neighbour & ((1u << kSlotBits) - 1); }

// From the neighbour at `other` to `place`.
vec3 offsetFrom(uint neighbour, vec3 other, vec3 place, vec3 size) {
  const uint image = neighbour >> kSlotBits;
  vec3 offset = place - other;
  if (image != kItself) offset -= vec3(image % 3, image / 3 % 3, image / 9) * size - size;
  return offset;
}

#endif
