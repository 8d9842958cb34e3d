// Normals of the surface of matter.
#include "engine/matter/matter_surface.hpp"

#include "tests/matter/matter_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::matter_surface_test {

namespace {

constexpr double kSpacing_m = 0.005;
const Vec3 kUp(0, 1, 0);

std::vector<Vec3> ball(int spacings) {
  std::vector<Vec3> places;
  for (int x = -spacings; x <= spacings; ++x)
    for (int y = -spacings; y <= spacings; ++y)
      for (int z = -spacings; z <= spacings; ++z)
        if (x * x + y * y + z * z <= spacings * spacings) places.push_back(Vec3(0.1f) + Vec3(x, y, z) * 0.005f);
  return places;
}

std::vector<Vec3> normalsOf(const std::vector<Vec3>& places, unsigned threads, const MatterBox& box) {
  std::vector<Vec3> normals;
  MatterSurface(box, kSpacing_m, threads).normalsOf(places, kUp, normals);
  return normals;
}

}  // namespace

TEST_CASE("normals of a ball of particles face outwards at its surface, up inside, and are unit vectors") {
  const MatterBox box{.size = Vec3(0.2f)};
  const std::vector<Vec3> places = ball(8);
  const std::vector<Vec3> normals = normalsOf(places, 2, box);
  REQUIRE(normals.size() == places.size());
  std::size_t outer = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 from = places[i] - Vec3(0.1f);
    CHECK(glm::length(normals[i]) == near(1, 1e-5));
    if (glm::length(from) > 7.0f * 0.005f) {
      ++outer;
      CHECK(glm::dot(normals[i], glm::normalize(from)) > 0.94f);
    }
    if (glm::length(from) < 3.0f * 0.005f) CHECK(normals[i] == kUp);
  }
  CHECK(outer > 500);
}

TEST_CASE("surface normals do not depend on the order of particles or the number of threads") {
  const MatterBox box{.size = Vec3(0.2f)};
  std::vector<Vec3> places = ball(7);
  const std::vector<Vec3> one = normalsOf(places, 1, box);
  for (const unsigned threads : {2u, 5u}) CHECK(normalsOf(places, threads, box) == one);
  std::vector<Vec3> backwards(places.rbegin(), places.rend());
  const std::vector<Vec3> other = normalsOf(backwards, 1, box);
  for (std::size_t i = 0; i < places.size(); ++i) CHECK(glm::distance(other[places.size() - 1 - i], one[i]) < 1e-4f);
}

TEST_CASE("drops are round, no particles have no normals, and coincident particles have normals that face up") {
  const MatterBox box{.size = Vec3(0.2f)};
  CHECK(normalsOf({}, 1, box).empty());
  for (const Vec3& normal : normalsOf({Vec3(0.01f), Vec3(0.1f), Vec3(0.1f, 0.104f, 0.1f)}, 1, box))
    CHECK(normal == Vec3(0));
  for (const Vec3& normal : normalsOf(std::vector<Vec3>(40, Vec3(0.05f)), 1, box)) CHECK(normal == kUp);
}

TEST_CASE("matter that continues across a periodic border has no surface there") {
  const MatterBox box{.size = {0.05f, 0.05f, 0.05f}, .periodic = {true, false, true}};
  std::vector<Vec3> places;
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 10; ++z) places.push_back((Vec3(x, y, z) + 0.5f) * 0.005f);
  const std::vector<Vec3> normals = normalsOf(places, 1, box);
  for (std::size_t i = 0; i < places.size(); ++i) CHECK(std::abs(normals[i].y) > 0.999f);
}

}  // namespace palpate::matter_surface_test
