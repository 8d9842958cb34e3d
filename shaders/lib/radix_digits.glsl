#ifndef PALPATE_LIB_RADIX_DIGITS_GLSL
#define PALPATE_LIB_RADIX_DIGITS_GLSL

// Shift and bits of one pass's digit, as even as possible: 20 bits make 7 + 7 + 6. RadixSort::digits does the same.
uvec2 digitOfPass(uint keyBits, uint passes, uint pass) {
  const uint shorter = keyBits / passes;
  const uint longer = keyBits % passes;  // number of passes with one bit more, which come first
  return uvec2(pass * shorter + min(pass, longer), shorter + (pass < longer ? 1 : 0));
}

#endif
