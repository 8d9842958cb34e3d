// Lets one text be a formula for GLSL and CUDA in single precision, and for C++ in single and double. In C++ and CUDA a
// formula is a template over `Real`; in GLSL it is a plain function and Real is float:
//
//   PALPATE_FORMULA Real heightOver(PALPATE_VEC3 place, PALPATE_VEC3 normal) { return Real(2.0) * dot(place, normal); }
//
// Constants that are not of type Real are converted explicitly, as Real(0.5), or C++ would mix the precisions. All
// languages compute in the written order: nothing is contracted or reassociated in C++ and CUDA.
#ifndef PALPATE_SHARED_REAL_H
#define PALPATE_SHARED_REAL_H

#ifdef __cplusplus
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#define PALPATE_SHARED_BEGIN namespace palpate::shared {
#define PALPATE_SHARED_END }
#ifdef __CUDACC__
// Static and always inlined: the device linker takes clones of a function that translation units share for the same
// code, though one clone may have been specialised for the arguments of its own unit.
#define PALPATE_FORMULA \
  template <class Real> \
  static __forceinline__ __host__ __device__
#else
#define PALPATE_FORMULA \
  template <class Real> \
  inline
#endif
#define PALPATE_VEC2 glm::vec<2, Real>
#define PALPATE_VEC3 glm::vec<3, Real>
#define PALPATE_VEC4 glm::vec<4, Real>
#define PALPATE_MAT3 glm::mat<3, 3, Real>
// A parameter that the function writes, and one that it reads and writes.
#define PALPATE_OUT(type) type&
#define PALPATE_INOUT(type) type&
// A struct of Reals: PALPATE_STRUCT(Ball) {...}; is named PALPATE_OF(Ball) in formulas, and BallOf<double> in C++.
// PALPATE_SINGLE(Ball); after it makes Ball the single-precision struct, as in GLSL.
#define PALPATE_STRUCT(name) \
  template <class Real>      \
  struct name##Of
#define PALPATE_OF(name) name##Of<Real>
#define PALPATE_SINGLE(name) using name = name##Of<float>

namespace palpate::shared {

using glm::abs;
using glm::acos;
using glm::ceil;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::determinant;
using glm::dot;
using glm::exp;
using glm::length;
using glm::log;
using glm::max;
using glm::min;
using glm::normalize;
using glm::smoothstep;
using glm::sqrt;
using glm::transpose;
using std::lerp;

/// Whether the sign bit is set, also of -0.
PALPATE_FORMULA bool isNegative(Real x) { return std::signbit(x); }

}  // namespace palpate::shared
#else
#define PALPATE_SHARED_BEGIN
#define PALPATE_SHARED_END
#define Real float
#define PALPATE_FORMULA
#define PALPATE_VEC2 vec2
#define PALPATE_VEC3 vec3
#define PALPATE_VEC4 vec4
#define PALPATE_MAT3 mat3
#define PALPATE_OUT(type) out type
#define PALPATE_INOUT(type) inout type
#define PALPATE_STRUCT(name) struct name
#define PALPATE_OF(name) name
#define PALPATE_SINGLE(name)
#define lerp mix
#define isNegative(x) (floatBitsToInt(x) < 0)
#endif

#endif
