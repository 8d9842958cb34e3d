// What a figure takes many repetitions to prove is the same code each time, and a sanitizer has seen it after a few:
// there it runs fewer of them, with the same checks. The others run where the program is built as it is: the entry is
// named in `full_in_plain` in tests/CMakeLists.txt, which house.full_in_plain looks after.
#pragma once

namespace palpate {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kUnderSanitizers = true;
#else
inline constexpr bool kUnderSanitizers = false;
#endif

template <class T>
constexpr T fewerUnderSanitizers(T full, T fewer) {
  return kUnderSanitizers ? fewer : full;
}

}  // namespace palpate
