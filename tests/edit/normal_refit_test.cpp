// Normals of points among gathered ones, against sums that are written out here in the order that is promised.
#include "engine/edit/normal_refit.hpp"

#include <doctest/doctest.h>

#include <random>

#include "engine/cloud/eigen3.hpp"
#include "shaders/shared/resample.h"

namespace palpate::normal_refit_test {

namespace {

constexpr double kRadius = 1;

struct Neighbour {
  DVec3 offset;
  Vec3 normal;
};

// The sum of term(k) for all k < count: of every eighth one, each in its own lane; then lane l and lane l + 4, l + 2
// and l + 1 are added.
template <class Term>
double sumInLanes(std::size_t count, Term&& term) {
  std::array<double, 8> lane{};
  for (std::size_t k = 0; k < count; ++k) lane[k % 8] += term(k);
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

Vec3 normalInLanes(const std::vector<Neighbour>& near, const Vec3& old) {
  std::vector<double> shares, weights;
  for (const Neighbour& each : near) {
    shares.push_back(double{shared::fitShare(glm::dot(each.normal, old))});
    weights.push_back(shares.back() * wendland(glm::length(each.offset) * (1 / kRadius)));
  }
  const auto sum = [&](auto&& of) {
    return sumInLanes(near.size(), [&](std::size_t k) { return of(weights[k], near[k]); });
  };
  const auto moment = [&](int i, int j) {
    return sum([&](double w, const Neighbour& each) { return w * each.offset[i] * each.offset[j]; });
  };
  NormalFit::Sums sums{.weights = sum([](double w, const Neighbour&) { return w; })};
  DVec3 side;
  for (int i = 0; i < 3; ++i) {
    sums.offsets[i] = sum([i](double w, const Neighbour& each) { return w * each.offset[i]; });
    side[i] = sum([i](double w, const Neighbour& each) { return w * double{each.normal[i]}; });
  }
  sums.squares = {moment(0, 0), moment(1, 1), moment(2, 2), moment(0, 1), moment(0, 2), moment(1, 2)};
  for (const double share : shares) sums.neighbours += share > 0;
  const DVec3 normal = NormalFit::normal(eigenSymmetric(NormalFit::spread(sums)), DVec3(old)).normal;
  return Vec3(glm::dot(normal, side) < 0 ? -normal : normal);
}

}  // namespace

// The neighbours are so close to each other, far from the position, that the last bits of the sums turn the normal.
TEST_CASE("the sums of a normal's fit are those of eight lanes, on every processor") {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(-1, 1);
  std::size_t wrong = 0, wrongAlone = 0, turned = 0;
  NormalRefit refit;
  NearPoints near;
  GatheredPoints gathered;
  for (std::size_t count = 9; count < 130; ++count) {
    std::vector<Vec3> positions, normals;
    for (std::size_t i = 0; i < count; ++i) {
      positions.push_back(Vec3(0.3f, 0.4f, 0.2f) + 2e-5f * Vec3{share(random), share(random), 0.3f * share(random)});
      normals.push_back(glm::normalize(Vec3{share(random), share(random), 1}));
    }
    SortedGrid grid(makeHashGrid(Vec3(-4), kRadius, positions.size()), 1);
    grid.build(positions);
    const DVec3 place(0.001 * share(random), 0, 0);
    gathered.gather(grid, {place, place, kRadius, cellsAround(grid.grid(), place, kRadius)});
    gathered.near(place, kRadius, near);
    REQUIRE(near.size() == count);
    const Vec3 old(0, 0, 1);
    refit.gather(gathered, normals);
    refit.add(0, near, old, kRadius);
    std::array<Vec3, 1> found;
    refit.solve(found);
    NormalFit alone(kRadius);
    std::vector<Neighbour> around;
    for (std::size_t k = 0; k < near.size(); ++k) {
      around.push_back({{near.x()[k], near.y()[k], near.z()[k]}, normals[gathered.numbers()[near.indices()[k]]]});
      alone.add(around.back().offset, double{shared::fitShare(glm::dot(around.back().normal, old))});
    }
    const Vec3 expected = normalInLanes(around, old);
    wrong += found[0] != expected;
    wrongAlone += Vec3(alone.normal(DVec3(old)).normal) != expected;
    std::ranges::reverse(around);
    turned += normalInLanes(around, old) != expected;
  }
  CHECK(wrong == 0);
  CHECK(wrongAlone == 0);
  CHECK(turned > 50);  // the order matters here
}

}  // namespace palpate::normal_refit_test
