// Insertion and removal of points: what each point requests, given its neighbours.
#include "engine/edit/resampling.hpp"

#include <doctest/doctest.h>

#include <memory>

#include <numbers>
#include <random>

namespace palpate::resample_request_test {

namespace {

const DVec3 kUp(0, 0, 1);

// At its position as loaded.
ResampleNeighbour pointAt(const DVec3& offset, std::uint32_t number, bool unsettled = false) {
  return {.offset = offset, .normal = kUp, .rest = offset, .spacing = 1, .number = number, .unsettled = unsettled};
}

std::unique_ptr<ResampleNeighbours> these(std::span<const ResampleNeighbour> neighbours) {
  return std::make_unique<ResampleNeighbours>(neighbours);
}

ResampleRequest requestOf(const ResampleNeighbour& self, std::span<const ResampleNeighbour> neighbours) {
  return resampleRequest(self, {.neighbours = *these(neighbours)});
}

// Six neighbours around, the first of which an edit has moved to `far` times its distance.
std::vector<ResampleNeighbour> ring(double far) {
  std::vector<ResampleNeighbour> points;
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double angle = (k + 0.5) * std::numbers::pi / 3;
    const DVec3 direction(std::cos(angle), std::sin(angle), 0);
    points.push_back(pointAt((k == 0 ? far : 1.0) * direction, k + 10));
    points.back().rest = direction;
  }
  return points;
}

}  // namespace

TEST_CASE("a sector is a sixth of a full turn, counter-clockwise") {
  for (int k = 0; k < 360; ++k) {
    const double angle = (k + 0.5) * std::numbers::pi / 180;
    CHECK(shared::sectorOf(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))) ==
          static_cast<shared::uint>(k / 60));
  }
  CHECK(shared::sectorOf(1, 0) == 0);
  CHECK(shared::sectorOf(-1, 0) == 3);
  CHECK(shared::sectorOf(0, 0) < shared::kGapSectors);
}

TEST_CASE("the midpoint of two points of a sphere lies on it") {
  for (const float angle : {0.05f, 0.2f, 0.4f}) {
    const Vec3 a(0, 0, 1), b(std::sin(angle), 0, std::cos(angle));
    const Vec3 middle = a + shared::halfWay(b - a, a, b);
    CHECK(std::abs(glm::length(middle) - 1) < 0.03f * angle * angle * angle * angle + 1e-6f);
    CHECK(glm::dot(middle, Vec3(0.5f * (a + b))) > 0.99f * glm::length(0.5f * (a + b)));
  }
}

TEST_CASE("a point with near neighbours requests nothing, and behind a gap one point in its middle") {
  const ResampleRequest content = requestOf(pointAt(DVec3(0), 1), ring(1.5));
  CHECK_FALSE(content.inserts);
  CHECK_FALSE(content.goes);
  CHECK_FALSE(content.unsettled);
  const auto gap = ring(1.8);
  const ResampleRequest request = requestOf(pointAt(DVec3(0), 1), gap);
  CHECK(request.inserts);
  CHECK(request.unsettled);
  CHECK(request.other == 10);
  CHECK(glm::distance(request.offset, 0.5 * gap[0].offset) < 1e-12);
}

TEST_CASE("no point is requested beyond a border, near an existing one, or on the other side of a sheet") {
  auto border = ring(1.8);
  border.erase(border.begin());
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), border).inserts);

  auto taken = ring(1.8);
  taken.push_back(pointAt(0.5 * taken[0].offset + DVec3(0, 0, 0.55), 30));
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), taken).inserts);
  taken.back().normal = -kUp;  // on the back of the sheet
  CHECK(requestOf(pointAt(DVec3(0), 1), taken).inserts);

  auto back = ring(1.8);
  back[0].normal = -kUp;
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), back).inserts);
}

TEST_CASE(
    "no point is requested between two sides of the surface as the stroke found it, but in the corner of a fold") {
  const auto requested = [](double rise, double cosine, std::uint32_t stroke) {
    auto gap = ring(1.8);
    ResampleNeighbour self = pointAt(DVec3(0), 1);
    const DVec3 aside = glm::normalize(gap[0].offset);
    for (ResampleNeighbour* each : {&self, &gap[0]}) {
      each->stroke = stroke;
      each->foundNormal = kUp;
    }
    // Over a rim the other side falls off, from a corner it rises, and faces back.
    gap[0].found = aside + rise * kUp;
    gap[0].foundNormal = cosine * kUp - (rise < 0 ? -1.0 : 1.0) * std::sqrt(1 - cosine * cosine) * aside;
    return requestOf(self, gap).inserts;
  };
  CHECK(requested(0, 1, 1));
  CHECK(requested(-0.5, 0.4, 1));
  CHECK_FALSE(requested(-0.5, 0.2, 1));
  CHECK_FALSE(requested(-0.5, -1, 1));
  CHECK(requested(-0.5, 0.2, 0));  // no stroke has moved any of them
  CHECK(requested(0.5, 0, 1));
  CHECK_FALSE(requested(0.5, -0.5, 1));
}

TEST_CASE("no point is requested in a gap that is not wider than the stroke found it, nor between distant parts") {
  struct Apart {
    double rest, found, now;
  };
  const auto requested = [](const Apart& apart, std::uint32_t stroke, bool carves = false) {
    auto gap = ring(apart.now);
    const DVec3 aside = glm::normalize(gap[0].offset);
    ResampleNeighbour self = pointAt(DVec3(0), 1);
    for (ResampleNeighbour* each : {&self, &gap[0]}) {
      each->stroke = stroke;
      each->foundNormal = kUp;
    }
    gap[0].rest = apart.rest * aside;
    gap[0].found = apart.found * aside;
    return resampleRequest(self, {.neighbours = *these(gap), .carves = carves, .moved = false}).inserts;
  };
  CHECK(requested({1, 1, 1.8}, 1));
  CHECK(requested({1, 1.75, 1.8}, 1));
  CHECK_FALSE(requested({1, 1.85, 1.8}, 1));
  CHECK(requested({9, 2.9, 3.5}, 1));
  CHECK(requested({2.9, 3.2, 3.5}, 1));  // others have torn it apart
  CHECK_FALSE(requested({3.1, 3.2, 3.5}, 1));
  CHECK(requested({3.1, 3.2, 3.5}, 0));    // no stroke has moved any of them
  CHECK(requested({5, 5, 1.8}, 1, true));  // what was between them is carved away
}

TEST_CASE("of two crowded points one is removed, the unsettled or the later one, never both") {
  const auto goes = [](const ResampleNeighbour& self, ResampleNeighbour other) {
    other.offset = {0.3, 0, 0};
    other.rest = {1, 0, 0};
    return requestOf(self, std::vector{other}).goes;
  };
  const auto at = [](std::uint32_t number, bool unsettled) { return pointAt(DVec3(0), number, unsettled); };
  const auto compressed = [](const DVec3& offset, std::uint32_t number) {
    ResampleNeighbour point = pointAt(offset, number, true);
    point.rest = 3.0 * offset;
    return point;
  };
  CHECK(goes(at(7, true), at(3, true)));
  CHECK_FALSE(goes(at(3, true), at(7, true)));
  CHECK(goes(at(3, true), at(7, false)));
  CHECK_FALSE(goes(at(7, false), at(3, true)));
  // In a chain the middle point is removed for the first; the last waits to see whether it may stay.
  const ResampleRequest last =
      requestOf(at(9, true), std::vector{compressed({0.3, 0, 0}, 5), compressed({0.6, 0, 0}, 2)});
  CHECK_FALSE(last.goes);
  CHECK(last.unsettled);
}

TEST_CASE("the request of a point does not depend on the order of its neighbours") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-3, 3);
  std::size_t inserted = 0, gone = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<ResampleNeighbour> neighbours;
    for (std::uint32_t k = 0; k < 16; ++k) {
      neighbours.push_back(pointAt({place(random), place(random), 0.1 * place(random)}, k, k % 3 > 0));
      neighbours.back().rest = {place(random), place(random), 0};
    }
    neighbours.push_back(neighbours[3]);  // two at equal distance
    neighbours.back().number = 40;
    const ResampleNeighbour self = pointAt(DVec3(0), 20, true);
    const ResampleRequest request = requestOf(self, neighbours);
    inserted += request.inserts;
    gone += request.goes;
    for (int shuffle = 0; shuffle < 4; ++shuffle) {
      std::ranges::shuffle(neighbours, random);
      const ResampleRequest again = requestOf(self, neighbours);
      CHECK(again.goes == request.goes);
      CHECK(again.inserts == request.inserts);
      CHECK(again.unsettled == request.unsettled);
      CHECK(again.other == request.other);
      CHECK(again.offset == request.offset);
    }
  }
  CHECK(inserted > 100);
  CHECK(gone > 50);
}

TEST_CASE("of all claims near a position the one with the smallest number wins, without blocking others") {
  const std::vector<std::pair<Vec3, std::uint32_t>> wanted{
      {{0.1f, 0.1f, 0}, 5}, {{0.5f, 0.1f, 0}, 3}, {{0.8f, 0.1f, 0}, 7}, {{1.3f, 0.1f, 0}, 9}, {{9, 0, 0}, 8}};
  InsertionClaims claims(1);
  for (int round = 0; round < 2; ++round) {
    claims.begin(1);
    for (const auto& [place, number] : wanted) claims.claim(place, number);
    for (const auto& [place, number] : wanted) claims.confirm(place, number);
    const auto stands = [&](std::size_t i) { return claims.stands(wanted[i].first, wanted[i].second); };
    CHECK_FALSE(stands(0));  // in the cell of the second
    CHECK(stands(1));
    CHECK_FALSE(stands(2));  // too close to the second
    CHECK_FALSE(stands(3));  // in the cell of the third
    CHECK(stands(4));
  }
  claims.begin(1);
  claims.claim(wanted[0].first, 5);
  claims.confirm(wanted[0].first, 5);
  CHECK(claims.stands(wanted[0].first, 5));
}

TEST_CASE(
    "where a stroke has inserted a point that did not stay it does not insert one again, but the next stroke does") {
  const std::vector<ResampleNeighbour> gap = ring(2);
  const DVec3 place(30, -7, 2);
  InsertionClaims claims(1);
  const auto request = [&] {
    return resampleRequest(pointAt(DVec3(0), 0), {.neighbours = *these(gap), .claims = &claims, .place = place});
  };
  claims.begin(1);
  REQUIRE(request().inserts);
  const Vec3 at(place + request().offset);
  claims.grant(Vec3(place));  // another position
  CHECK(request().inserts);
  claims.grant(at);
  CHECK_FALSE(request().inserts);
  CHECK_FALSE(request().unsettled);
  claims.begin(1);
  CHECK_FALSE(request().inserts);
  claims.begin(2);
  CHECK(request().inserts);
}

TEST_CASE("a gap is measured by the coarser of its ends, whose target spacing the new point gets") {
  auto gap = ring(1.8);
  gap[0].spacing = 1.5;
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), gap).inserts);
  gap = ring(2.4);
  gap[0].spacing = 1.5;
  const ResampleRequest request = requestOf(pointAt(DVec3(0), 1), gap);
  CHECK(request.inserts);
  CHECK(request.takesAfterOther);
  CHECK_FALSE(requestOf(pointAt(DVec3(0), 1), ring(2.4)).takesAfterOther);
}

TEST_CASE("no point is requested beyond its reach, or if the list of neighbours is incomplete") {
  const auto gap = ring(1.8);
  const ResampleNeighbour self = pointAt(DVec3(0), 1);
  CHECK(resampleRequest(self, {.neighbours = *these(gap), .reach = 0.91}).inserts);
  CHECK_FALSE(resampleRequest(self, {.neighbours = *these(gap), .reach = 0.89}).inserts);
  CHECK_FALSE(resampleRequest(self, {.neighbours = *these(gap), .fills = false}).inserts);
}

TEST_CASE("no point is added where it would crowd one with a wider target, or one of possibly the same sheet") {
  auto gap = ring(1.8);
  const ResampleNeighbour self = pointAt(DVec3(0), 1);
  const DVec3 place = 0.5 * gap[0].offset, aside = glm::normalize(DVec3(-place.y, place.x, 0));
  gap.push_back(pointAt(place + aside, 30));
  CHECK(requestOf(self, gap).inserts);
  gap.back().spacing = 3;
  CHECK_FALSE(requestOf(self, gap).inserts);
  gap.back() = pointAt(place + DVec3(0, 0, 0.3), 30);
  gap.back().normal = glm::normalize(DVec3(1, 0, -0.3));
  CHECK_FALSE(requestOf(self, gap).inserts);
  gap.back().normal = -kUp;
  CHECK(requestOf(self, gap).inserts);
}

TEST_CASE("a point waits for the removal of another point only if that one is examined") {
  const auto row = [](bool firstIsExamined) {
    std::vector<ResampleNeighbour> points{pointAt({0.3, 0, 0}, 20, firstIsExamined), pointAt({0.6, 0, 0}, 10)};
    for (ResampleNeighbour& point : points) point.rest *= 10;
    return points;
  };
  const ResampleNeighbour self = pointAt(DVec3(0), 30, true);
  CHECK(requestOf(self, row(true)).unsettled);
  CHECK_FALSE(requestOf(self, row(true)).goes);
  CHECK(requestOf(self, row(false)).goes);
}

TEST_CASE("while a ball carves, points outside the solid are removed, and none is added where it would be removed") {
  // The ends of a gap are slightly above a plane at rest, which is seen slightly farther away.
  auto gap = ring(1.8);
  const ResampleNeighbour self = pointAt(DVec3(0), 1);
  const auto raised = [&](double height) {
    auto all = gap;
    for (ResampleNeighbour& each : all) each.rest = each.offset - DVec3(0, 0, 5);
    for (std::uint32_t k = 0; k < 12; ++k) {
      const double angle = k * std::numbers::pi / 6;
      all.push_back(pointAt(DVec3(0.9 + 2.5 * std::cos(angle), 2.5 * std::sin(angle), -height), 40 + k));
      all.back().atRest = true;
    }
    return all;
  };
  const auto request = [&](double height, bool carves) {
    const auto all = raised(height);
    return resampleRequest(self, {.neighbours = *these(all), .carves = carves});
  };
  CHECK(request(0.05, false).inserts);
  CHECK_FALSE(request(0.05, true).goes);
  CHECK_FALSE(request(0.05, true).inserts);
  CHECK(request(-0.05, true).inserts);
  CHECK(request(0.15, true).goes);
  CHECK_FALSE(request(0.15, false).goes);
  const auto all = raised(0.15);
  CHECK_FALSE(resampleRequest(self, {.neighbours = *these(all), .carves = true, .moved = false}).goes);
}

TEST_CASE("midpoints over an edge, or between normals that disagree, stay within the planes of the ends") {
  std::mt19937 random(8);
  std::normal_distribution<double> side;
  const auto direction = [&] { return glm::normalize(DVec3{side(random), side(random), side(random)}); };
  for (int k = 0; k < 2000; ++k) {
    const DVec3 normal = direction(), other = direction();
    const Vec3 offset(direction()), place = shared::halfWay(offset, Vec3(normal), Vec3(other));
    const double chord = 0.5 * glm::dot(DVec3(offset), normal), chordBack = -0.5 * glm::dot(DVec3(offset), other);
    CHECK(glm::dot(DVec3(place), normal) < std::max(0.0, chord) + 1e-6);
    CHECK(glm::dot(DVec3(place - offset), other) < std::max(0.0, chordBack) + 1e-6);
  }
}

}  // namespace palpate::resample_request_test
