#include "engine/cloud/eigen3.hpp"

#include <doctest/doctest.h>

#include <bit>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/eigen3_many.hpp"

namespace palpate::test::eigen3_test {
namespace {

DVec3 multiply(const SymmetricMatrix3& m, const DVec3& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

/// Checks the definition: m v = value v, unit and perpendicular vectors, ascending values.
void checkEigen(const SymmetricMatrix3& m) {
  const Eigen3 e = eigenSymmetric(m);
  double scale = 0;
  for (const double entry : {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz}) scale = std::max(scale, std::abs(entry));
  CHECK(e.values[0] <= e.values[1]);
  CHECK(e.values[1] <= e.values[2]);
  for (int k = 0; k < 3; ++k) {
    const DVec3 v = e.vectors[k], image = multiply(m, v);
    for (int c = 0; c < 3; ++c) CHECK(std::abs(image[c] - e.values[k] * v[c]) <= 1e-14 * scale);
    CHECK(std::abs(glm::length(v) - 1) < 1e-14);
    CHECK(std::abs(glm::dot(v, e.vectors[(k + 1) % 3])) < 1e-14);
  }
}

}  // namespace

TEST_CASE("eigenvalues of random symmetric matrices of any scale are right") {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const DVec3 diagonal = randomNormal3(1, i), rest = randomNormal3(2, i);
    for (const double scale : {1.0, 1e-150, 1e150, 1e-6}) {
      checkEigen(
          {scale * diagonal.x, scale * diagonal.y, scale * diagonal.z, scale * rest.x, scale * rest.y, scale * rest.z});
    }
  }
}

TEST_CASE("matrices with equal, zero and negative eigenvalues are solved") {
  checkEigen({});
  checkEigen({1, 1, 1, 0, 0, 0});
  checkEigen({-3, -3, 5, 0, 0, 0});
  checkEigen({1, 1, 1, 1, 1, 1});                 // rank one
  checkEigen({2, 2, 2, 1, 1, 1});                 // one double eigenvalue
  checkEigen({1, 1, 1, 1e-17, 1e-9, -1e-13});     // almost equal
  checkEigen({1, 1e-12, 1e-24, 1e-7, 1e-13, 0});  // graded
  checkEigen({0, 0, 0, 1, 0, 0});
  checkEigen({5e-324, 0, 0, 0, 0, 0});
}

TEST_CASE("many matrices at once have the same eigenvalues and vectors bit by bit, however many there are") {
  std::vector<SymmetricMatrix3> matrices{{},
                                         {1, 1, 1, 0, 0, 0},
                                         {-3, -0.0, 5, 0, -0.0, 0},
                                         {2, 2, 2, 1, 1, 1},
                                         {1, 1e-12, 1e-24, 1e-7, 1e-13, 0},
                                         {0, 0, 0, 1, 0, 0},
                                         {5e-324, 0, 0, 0, 0, 0}};
  for (std::uint64_t i = 0; i < 300; ++i) {
    const DVec3 diagonal = randomNormal3(1, i), rest = randomNormal3(2, i);
    const double scale = std::exp2(static_cast<double>(i % 300) - 150);
    matrices.push_back(
        {scale * diagonal.x, scale * diagonal.y, scale * diagonal.z, scale * rest.x, scale * rest.y, scale * rest.z});
  }
  ManyEigen3 many;
  for (const std::size_t count : {std::size_t{1}, std::size_t{11}, matrices.size(), std::size_t{9}}) {
    many.clear();
    for (std::size_t i = 0; i < count; ++i) many.add(matrices[matrices.size() - count + i]);
    many.solve();
    REQUIRE(many.size() == count);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < count; ++i)
      differ += std::bit_cast<std::array<std::uint64_t, 12>>(many[i]) !=
                std::bit_cast<std::array<std::uint64_t, 12>>(eigenSymmetric(matrices[matrices.size() - count + i]));
    CHECK(differ == 0);
  }
}

TEST_CASE("the smallest eigenvector of points on a plane is its normal") {
  const Frame3 plane = frameAround(glm::normalize(DVec3(1, -2, 0.5)));
  SymmetricMatrix3 covariance;
  for (std::uint64_t i = 0; i < 20; ++i) covariance.addSquare(randomUnit(1, i) * plane.u + randomUnit(2, i) * plane.v);
  const Eigen3 e = eigenSymmetric(covariance);
  CHECK(std::abs(e.values[0]) < 1e-15);
  CHECK(std::abs(glm::dot(e.vectors[0], plane.n)) > 1 - 1e-14);
}

}  // namespace palpate::test::eigen3_test
