#include "engine/cloud/triangle_mesh.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/error.hpp"
#include "tests/near.hpp"

namespace palpate::test::triangle_mesh_test {
namespace {

struct Mesh {
  std::vector<DVec3> vertices;
  std::vector<TriangleMesh::Triangle> triangles;

  void quad(const DVec3& a, const DVec3& b, const DVec3& c, const DVec3& d) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c, d});
    triangles.push_back({first, first + 1, first + 2});
    triangles.push_back({first, first + 2, first + 3});
  }
};

// Every face has its own corners, as many programs write them.
Mesh cubeMesh(double half) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      DVec3 out(0), u(0), v(0);
      out[axis] = side * half;
      u[(axis + 1) % 3] = side * half;
      v[(axis + 2) % 3] = half;
      mesh.quad(out - u - v, out + u - v, out + u + v, out - u + v);
    }
  return mesh;
}

// Longitude and latitude; the triangles at the poles have no area.
Mesh sphereMesh(double radius, int steps) {
  Mesh mesh;
  const auto at = [&](int i, int k) {
    if (k == steps) return DVec3(0, 0, -radius);  // the sine of pi is not quite zero
    const double around = std::numbers::pi * i / steps, down = std::numbers::pi * k / steps;
    return radius * DVec3(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down));
  };
  for (int i = 0; i < 2 * steps; ++i)
    for (int k = 0; k < steps; ++k) mesh.quad(at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
  return mesh;
}

DVec3 somewhere(std::uint64_t i, double reach) { return reach * randomNormal3(5, i); }

}  // namespace

TEST_CASE("distances to a fine mesh of a sphere equal those to the sphere") {
  const Mesh mesh = sphereMesh(50, 200);
  const TriangleMesh sphere(mesh.vertices, mesh.triangles);
  const auto truth = makeShape("sphere");
  const double sag = 50 * (1 - std::cos(std::numbers::pi / 400)) * 2.1;  // of a facet, in both directions
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const DVec3 p = somewhere(i, 40);
    CHECK(sphere.signedDistance(p) == within(truth->signedDistance(p), sag));
    const SurfacePoint on = sphere.closest(p);
    CHECK(angleBetween_deg(on.normal, on.position) < 0.5);  // the slender triangles around the poles are the worst
  }
}

TEST_CASE("distances to a mesh of a cube are exact inside, outside, over faces, edges and corners") {
  const Mesh mesh = cubeMesh(50);
  const TriangleMesh cube(mesh.vertices, mesh.triangles);
  const auto truth = makeShape("cube");
  CHECK(cube.triangleCount() == 12);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const DVec3 p = somewhere(i, 45);
    CHECK(cube.signedDistance(p) == within(truth->signedDistance(p), 1e-11));
    CHECK(glm::distance(cube.closest(p).position, p) == within(std::abs(truth->signedDistance(p)), 1e-9));
  }
  CHECK(cube.signedDistance({60, 60, 60}) == near(10 * std::sqrt(3.0), 1e-6));
  CHECK(angleBetween_deg(cube.closest({60, 60, 60}).normal, DVec3(1)) < 1e-6);
}

TEST_CASE("the tree of a mesh finds the nearest triangle of a full search") {
  Mesh mesh;
  for (std::uint64_t i = 0; i < 257; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint64_t k = 0; k < 3; ++k)
      mesh.vertices.push_back(somewhere(100 * i, 10) + somewhere(7000 + 3 * i + k, 2));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const TriangleMesh whole(mesh.vertices, mesh.triangles);
  std::vector<TriangleMesh> single;
  for (const auto& triangle : mesh.triangles) single.emplace_back(mesh.vertices, std::vector{triangle});
  for (std::uint64_t i = 0; i < 300; ++i) {
    const DVec3 p = somewhere(20'000 + i, 12);
    double least = std::numeric_limits<double>::infinity();
    for (const TriangleMesh& one : single) least = std::min(least, std::abs(one.signedDistance(p)));
    CHECK(std::abs(whole.signedDistance(p)) == within(least, 1e-11));
  }
}

TEST_CASE("triangles without area are ignored, and a mesh of nothing else is refused") {
  Mesh mesh = cubeMesh(50);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({2, 2, 2});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {DVec3(50, 0, 0), DVec3(50, 10, 0), DVec3(50, 20, 0)});
  mesh.triangles.push_back({first, first + 1, first + 2});
  const TriangleMesh cube(mesh.vertices, mesh.triangles);
  CHECK(cube.triangleCount() == 12);
  CHECK(cube.signedDistance({53, 5, 0}) == near(3, 1e-6));
  CHECK_THROWS_AS(TriangleMesh(mesh.vertices, {{0, 0, 1}}), Error);
  CHECK_THROWS_AS(TriangleMesh({}, {}), Error);
}

}  // namespace palpate::test::triangle_mesh_test
