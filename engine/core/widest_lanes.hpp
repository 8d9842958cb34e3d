// Loops as many lanes wide as the processor has: AVX-512 or AVX2 where it supports them, chosen at program start where
// the compiler can defer the choice. Fused multiplications have to be disabled for such a file, and no reduction be
// reordered, so that results are the same everywhere.
#pragma once

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_WIDEST_LANES [[gnu::target_clones("avx512f", "avx2", "default")]]
#define PALPATE_INTO_CALLER __attribute__((always_inline))
// A function of AVX-512's own, such as those that compress lanes; to be called only where hasAvx512().
#define PALPATE_AVX512 [[gnu::target("avx512f,avx512vl,popcnt")]]
// Two definitions of a function, each with all that it calls: for a processor with AVX2, whose lanes are eight floats,
// and for any other.
#define PALPATE_WITH_AVX2 [[gnu::target("avx2"), gnu::flatten]]
#define PALPATE_WITHOUT_AVX2 [[gnu::target("default"), gnu::flatten]]
#else
#define PALPATE_WIDEST_LANES
#define PALPATE_INTO_CALLER
#define PALPATE_WITHOUT_AVX2
#endif

#ifdef PALPATE_AVX512
namespace palpate {

inline bool hasAvx512() {
  static const bool has = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
  return has;
}

}  // namespace palpate
#endif
