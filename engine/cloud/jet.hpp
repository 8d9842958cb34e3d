// Numbers that carry their first and second derivatives by two parameters u and v (forward automatic differentiation;
// Griewank and Walther 2008, chapter 13), so that a surface is written once, as its formula, and its normals and
// curvatures are exact.
#pragma once

#include <cmath>

#include "engine/core/vec.hpp"

namespace palpate {

struct Jet {
  double value = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;

  constexpr Jet() = default;
  constexpr Jet(double constant) : value(constant) {}  // NOLINT: constants mix freely with jets
  constexpr Jet(double f, double fu, double fv, double fuu, double fuv, double fvv)
      : value(f), u(fu), v(fv), uu(fuu), uv(fuv), vv(fvv) {}
  static constexpr Jet parameterU(double u) { return {u, 1, 0, 0, 0, 0}; }
  static constexpr Jet parameterV(double v) { return {v, 0, 1, 0, 0, 0}; }
};

constexpr Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
}
constexpr Jet operator-(const Jet& a, const Jet& b) {
  return {a.value - b.value, a.u - b.u, a.v - b.v, a.uu - b.uu, a.uv - b.uv, a.vv - b.vv};
}
constexpr Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value,
          a.u * b.value + a.value * b.u,
          a.v * b.value + a.value * b.v,
          a.uu * b.value + 2 * a.u * b.u + a.value * b.uu,
          a.uv * b.value + a.u * b.v + a.v * b.u + a.value * b.uv,
          a.vv * b.value + 2 * a.v * b.v + a.value * b.vv};
}

/// f(a), from the values of f, f' and f'' at a.value.
constexpr Jet chain(const Jet& a, double f, double f1, double f2) {
  return {f, f1 * a.u, f1 * a.v, f1 * a.uu + f2 * a.u * a.u, f1 * a.uv + f2 * a.u * a.v, f1 * a.vv + f2 * a.v * a.v};
}
inline Jet sin(const Jet& a) { return chain(a, std::sin(a.value), std::cos(a.value), -std::sin(a.value)); }
inline Jet cos(const Jet& a) { return chain(a, std::cos(a.value), -std::sin(a.value), -std::cos(a.value)); }
inline Jet exp(const Jet& a) { return chain(a, std::exp(a.value), std::exp(a.value), std::exp(a.value)); }
/// 1 / sqrt(a), a > 0.
inline Jet inverseSqrt(const Jet& a) {
  const double f = 1 / std::sqrt(a.value);
  return chain(a, f, -0.5 * f / a.value, 0.75 * f / (a.value * a.value));
}

struct JetVec3 {
  Jet x, y, z;

  DVec3 value() const { return {x.value, y.value, z.value}; }
  DVec3 u() const { return {x.u, y.u, z.u}; }
  DVec3 v() const { return {x.v, y.v, z.v}; }
  DVec3 uu() const { return {x.uu, y.uu, z.uu}; }
  DVec3 uv() const { return {x.uv, y.uv, z.uv}; }
  DVec3 vv() const { return {x.vv, y.vv, z.vv}; }
};
constexpr JetVec3 operator+(const JetVec3& a, const JetVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr JetVec3 operator-(const JetVec3& a, const JetVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr JetVec3 operator*(const Jet& s, const JetVec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Jet dot(const JetVec3& a, const JetVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr JetVec3 cross(const JetVec3& a, const JetVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline JetVec3 normalize(const JetVec3& a) { return inverseSqrt(dot(a, a)) * a; }

}  // namespace palpate
