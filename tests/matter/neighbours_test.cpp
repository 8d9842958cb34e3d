// Cells and lists compared with all pairs, and formulas compared with numerical integrals.
#include <algorithm>
#include <bit>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <set>

#include "engine/matter/boundary.hpp"
#include "engine/matter/lanes.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/neighbour_lists.hpp"
#include "tests/matter/matter_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::neighbours_test {

TEST_CASE("neighbour lists contain exactly the particles within reach, also across periodic borders") {
  constexpr float kReach = 0.1f;
  for (const bool periodic : {false, true}) {
    CAPTURE(periodic);
    const MatterBox box{.size = {0.4f, 0.31f, 0.5f}, .periodic = {periodic, false, periodic}};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> share(0, 1);
    std::vector<Vec4> places(700), sorted;
    for (Vec4& place : places)
      for (int axis = 0; axis < 3; ++axis) place[axis] = share(random) * box.size[axis];
    CellGrid grid(cellsOf(box, kReach));
    WorkerTeam team(2);
    grid.sort(places, team);
    for (const std::uint32_t k : grid.order()) sorted.push_back(places[k]);
    NeighbourLists lists(kReach);
    REQUIRE(lists.build(grid, sorted, team));
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      std::set<std::uint32_t> expected, listed;
      for (std::uint32_t j = 0; j < sorted.size(); ++j) {
        Vec3 offset(sorted[i] - sorted[j]);
        for (int axis = 0; axis < 3; ++axis)
          if (box.periodic[static_cast<std::size_t>(axis)])
            offset[axis] -= box.size[axis] * std::round(offset[axis] / box.size[axis]);
        if (j != i && glm::length(offset) < kReach) expected.insert(j);
      }
      for (const Neighbour neighbour : lists.of(i)) {
        listed.insert(neighbour.slot);
        CHECK(glm::length(Vec3(sorted[i] - sorted[neighbour.slot]) - grid.shiftOf(neighbour.image)) < kReach);
      }
      REQUIRE(listed == expected);
      REQUIRE(lists.of(i).size() == expected.size());
      const std::span<const Neighbour> filled(
          lists.of(i).data(), (expected.size() + kListedTogether - 1) / kListedTogether * kListedTogether);
      const NeighbourLists::OfBlock block = lists.ofBlock(i / kSlotsOfBlock);
      REQUIRE(block.first[i % kSlotsOfBlock] % kListedTogether == 0);
      REQUIRE(block.neighbours + block.first[i % kSlotsOfBlock] == lists.of(i).data());
      REQUIRE(block.counts[i % kSlotsOfBlock] == expected.size());
      for (std::size_t k = expected.size(); k < filled.size(); ++k) {
        REQUIRE(filled[k].slot == sorted.size());
        REQUIRE(filled[k].image == 0);
      }
      pairs += expected.size();
    }
    CHECK(pairs > 5000);
  }
}

TEST_CASE("a body meets exactly its points within the support radius, in their order") {
  constexpr double kSpacing_m = 0.01, kSupport_m = kSupport_spacings * kSpacing_m;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(-1, 1);
  for (const double radius_m : {0.035, 0.08}) {
    BoundaryBody body(ballPoints(radius_m, kSpacing_m, kSupport_m), static_cast<float>(kSupport_m), 0);
    const BodyMotion motion{.place = {0.3, 0.2, -0.1},
                            .orientation = glm::angleAxis(0.7, glm::normalize(DVec3(1, 2, 3)))};
    body.moveTo(motion, 1);
    std::size_t pairs = 0;
    for (int k = 0; k < 500; ++k) {
      DVec3 offset;
      for (int axis = 0; axis < 3; ++axis) offset[axis] = 1.6 * radius_m * double{share(random)};
      std::vector<std::uint32_t> met, expected;
      body.forEachNear(Vec3(motion.place + offset), [&](const BoundaryMeeting& one) { met.push_back(one.number); });
      for (std::uint32_t n = 0; n < body.size(); ++n) {
        const DVec3 point = motion.orientation * DVec3(Vec3(body.points()[n]) - body.middle());
        if (glm::length(offset - point) < kSupport_m) expected.push_back(n);
      }
      REQUIRE(met == expected);
      pairs += met.size();
    }
    CHECK(pairs > 1000);
  }
}

TEST_CASE("eight lanes give the same bits as four, and as floats") {
  using Eight = LanesOf<8>;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(-1, 1);
  std::vector<Vec4> vectors(400);
  for (Vec4& vector : vectors)
    for (int axis = 0; axis < 4; ++axis) vector[axis] = share(random);
  const auto lanesOf = [&](std::size_t i) { return Lanes::at(&vectors[i].x); };
  const auto same = [](float one, float other) {
    return std::bit_cast<std::uint32_t>(one) == std::bit_cast<std::uint32_t>(other);
  };
  LaneSum<4> sumOfFours;
  LaneSum<8> sumOfEights;
  std::array<float, 8> sums{};
  std::size_t wrong = 0;
  for (std::size_t i = 0; i + 8 <= vectors.size(); i += 8) {
    const auto low = VectorsOf<4>::of({lanesOf(i), lanesOf(i + 1), lanesOf(i + 2), lanesOf(i + 3)});
    const auto high = VectorsOf<4>::of({lanesOf(i + 4), lanesOf(i + 5), lanesOf(i + 6), lanesOf(i + 7)});
    const auto all = VectorsOf<8>::of({lanesOf(i), lanesOf(i + 1), lanesOf(i + 2), lanesOf(i + 3), lanesOf(i + 4),
                                       lanesOf(i + 5), lanesOf(i + 6), lanesOf(i + 7)});
    sumOfFours.add(0, low.x * low.y - low.z);
    sumOfFours.add(1, high.x * high.y - high.z);
    const Eight eight = all.x * all.y - all.z;
    sumOfEights.add(0, eight);
    const std::array<Lanes, 8> each = all.each();
    for (std::size_t k = 0; k < Eight::kCount; ++k) {
      const Vec4& v = vectors[i + k];
      sums[k] += v.x * v.y - v.z;
      wrong += !same(eight[k], v.x * v.y - v.z);
      const std::array<Lanes, 4> ofFour = (k < 4 ? low : high).each();
      for (std::size_t axis = 0; axis < 4; ++axis)
        wrong += !same(each[k][axis], v[static_cast<int>(axis)]) || !same(ofFour[k % 4][axis], each[k][axis]);
    }
  }
  const float total = ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
  wrong += !same(sumOfFours.total(), total) || !same(sumOfEights.total(), total);
  CHECK(wrong == 0);
  CHECK(total != 0);
}

TEST_CASE("the contribution beyond a wall is the integral of the weights there") {
  // Midpoint sums over a ball, in slices across the plane.
  for (const double distance : {0.0, 0.2, 0.5, 0.9}) {
    CAPTURE(distance);
    constexpr int kCells = 120;
    double beyond = 0, all = 0;
    for (int z = 0; z < kCells; ++z)
      for (int y = 0; y < kCells; ++y) {
        const double along = (z + 0.5) / kCells, across = (y + 0.5) / kCells;
        const double weight = shared::wendland(std::min(std::hypot(along, across), 1.0)) * across;
        all += 2 * weight;
        if (along > distance) beyond += weight;
      }
    CHECK(shared::shareBeyond(distance) == near(beyond / all, 0.01));
    const double slope = (shared::shareBeyond(distance + 1e-5) - shared::shareBeyond(distance)) / 1e-5;
    CHECK(shared::shareInLayer(distance) == near(-slope, 1e-3));
  }
}

TEST_CASE("the pair force is the derivative of the weight") {
  for (const double r : {0.1, 0.4, 0.7, 0.95}) {
    const double slope = (shared::wendland(r + 1e-6) - shared::wendland(r - 1e-6)) / 2e-6;
    CHECK(shared::wendlandPull(r) * r == near(-slope, 1e-6));
  }
  CHECK(std::isfinite(shared::wendlandPull(0.0f)));
}

TEST_CASE("matter at rest on its lattice has full density at a wall") {
  const Fluid fluid{.spacing_m = 0.01, .density_kg_m3 = 1000, .viscosity_Pa_s = 1e-3, .substep_s = 5e-4};
  const shared::WaterRules rules = waterRules(fluid);
  const LatticeSums sums = latticeSums(kSupport_spacings);
  const auto far = shared::wallsBeside<float>(rules, 0.5f, 1, false);
  const auto beside = shared::wallsBeside<float>(rules, 0.005f, 1, false);
  CHECK(shared::wallEffect(rules, far, far, far).sum == 0);
  const float missing = shared::wallEffect(rules, far, beside, far).sum;
  CHECK(missing == near(sums.beyond, 1e-4));
  CHECK(shared::compressionOf<float>(rules, static_cast<float>(sums.weight)) == within(0, 1e-6));
}

}  // namespace palpate::neighbours_test
