// Positions on the discs of Gaussians, and the densities there, compared with sums over all discs.
#include "engine/cloud/gaussian_seeds.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <vector>

#include "engine/cloud/morton.hpp"
#include "tests/gaussian_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::test::gaussian_seeds_test {
namespace {

/// Discs along the axes, from tiny ones to ten times the usual size.
std::vector<GaussianDisc> someDiscs(std::size_t count) {
  SceneRandom random(11);
  std::vector<GaussianDisc> discs;
  for (std::size_t i = 0; i < count; ++i) {
    const DVec3 center = random.inBox(DVec3(0), 40);
    const auto longest = static_cast<float>(0.2 * std::exp(4 * std::pow(random.unit(), 4)));
    GaussianDisc disc{.center = Vec3(center),
                      .opacity = 0.1f + 0.9f * static_cast<float>(random.unit()),
                      .longest = {longest, 0, 0},
                      .middle = {0, 0.7f * longest, 0},
                      .shortest = {0, 0, std::min(0.5f * longest, 1.0f)}};
    disc.reach = std::sqrt(2 * std::log(disc.opacity / 0.02f)) * (disc.longest + disc.middle + disc.shortest);
    discs.push_back(disc);
  }
  return discs;
}

double densityAt(const GaussianDisc& disc, const Vec3& place) {
  const DVec3 off = DVec3(place - disc.center) / DVec3(disc.longest + disc.middle + disc.shortest);
  return disc.opacity * std::exp(-0.5 * glm::dot(off, off));
}

}  // namespace

TEST_CASE("seeds are in the order of their voxels, one per voxel, on the discs that they name") {
  const std::vector<GaussianDisc> discs = someDiscs(3000);
  const BareVector<GaussianSeed> seeds = seedsOver(discs, 1);
  CHECK(seeds.size() > 3000);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const GaussianSeed& seed = seeds[i];
    REQUIRE(seed.voxel == mortonCode(mortonCell(seed.place, kSeedVoxel)));
    if (i > 0) REQUIRE(seeds[i - 1].voxel < seed.voxel);
    const GaussianDisc& disc = discs[seed.disc];
    REQUIRE(densityAt(disc, seed.place) > 0.54 * static_cast<double>(disc.opacity));  // within 1.1 deviations
    REQUIRE(std::abs(seed.place.z - disc.center.z) < 1e-5f);
  }
  for (const unsigned threads : {2u, 5u}) {
    const BareVector<GaussianSeed> same = seedsOver(discs, threads);
    CHECK(std::ranges::equal(same, seeds, [](const GaussianSeed& a, const GaussianSeed& b) {
      return a.voxel == b.voxel && a.place == b.place && a.disc == b.disc;
    }));
  }
}

TEST_CASE("of coincident discs the first one gets the seeds, and no discs give none") {
  std::vector<GaussianDisc> discs(50, someDiscs(1)[0]);
  for (GaussianDisc& disc : discs) disc.longest.x = disc.middle.y = 5;
  const BareVector<GaussianSeed> seeds = seedsOver(discs, 3);
  const auto first = std::ranges::count(seeds, 0u, &GaussianSeed::disc);
  CHECK(static_cast<std::size_t>(first) > seeds.size() / 2);
  CHECK(static_cast<std::size_t>(first) == seedsOver(std::span(discs).first(1), 3).size());
  CHECK(seedsOver({}, 3).empty());
}

TEST_CASE("each seed gathers exactly the Gaussians within reach, without duplicates") {
  const std::vector<GaussianDisc> discs = someDiscs(3000);
  const BareVector<GaussianSeed> seeds = seedsOver(discs, 1);
  for (const float margin : {0.0f, 2.0f, 5.0f}) {
    CAPTURE(margin);
    const SeedCells cells(discs, seeds, margin, 2);
    GaussiansAround around(cells);
    std::size_t next = 0;
    for (std::size_t cell = 0; cell < cells.count(); ++cell) {
      const auto [first, last] = cells.seedsOf(cell);
      REQUIRE(first == next);
      next = last;
      GaussianRegion region;
      for (std::size_t i = first; i < last; ++i) region.widen(seeds[i].place - margin), region.widen(seeds[i].place);
      GaussianDensity density;
      around.gather(cell, region, density);
      if (cell % 10 != 0) continue;
      // At the seed, and as far from it as the margin allows.
      for (const Vec3& place : {seeds[first].place, seeds[first].place - margin}) {
        double felt = 0, all = 0;
        for (const GaussianDisc& disc : discs) {
          const double one = densityAt(disc, place);
          all += one;
          if (glm::all(glm::lessThan(glm::abs(place - disc.center), 0.999f * disc.reach))) felt += one;
        }
        const auto got = static_cast<double>(density.slopeAt(place).density);
        CHECK(density.densityAt(place) == near(density.slopeAt(place).density, 1e-6));
        CHECK(got > felt - 1e-3 * (1 + felt));
        CHECK(got < all + 1e-3 * (1 + all));
      }
    }
    CHECK(next == seeds.size());
  }
}

}  // namespace palpate::test::gaussian_seeds_test
