#include "engine/io/triangle_soup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr double kMaxCorner = 1e30;  // as for all clouds

/// Triangles by cumulative area.
class AreaOfTriangles {
 public:
  explicit AreaOfTriangles(const TriangleSoup& soup) : soup_(soup) {
    double sum = 0;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
      const double area = areaOf(t);
      if (!(area > 0)) {
        ++flat_;
        continue;
      }
      sum += area;
      which_.push_back(static_cast<std::uint32_t>(t));
      ends_.push_back(sum);
    }
  }

  std::size_t flat() const { return flat_; }
  double whole() const { return ends_.empty() ? 0 : ends_.back(); }
  /// Index, among triangles with an area, of the one that contains the cumulative `area`.
  std::size_t holding(double area) const {
    const auto end = std::ranges::upper_bound(ends_, area);
    return std::min<std::size_t>(static_cast<std::size_t>(end - ends_.begin()), ends_.size() - 1);
  }
  std::uint32_t triangle(std::size_t place) const { return which_[place]; }
  double begin(std::size_t place) const { return place == 0 ? 0 : ends_[place - 1]; }

 private:
  double areaOf(std::size_t t) const {
    std::array<DVec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = soup_.corners[soup_.triangles[t][k]];
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(corners[k][axis]) < kMaxCorner)) return 0;
    }
    return 0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  }

  const TriangleSoup& soup_;
  std::vector<std::uint32_t> which_;
  std::vector<double> ends_;
  std::size_t flat_ = 0;
};

struct Spot {
  std::uint32_t triangle;
  DVec3 shares;
};

/// The `i`th of `count` sample positions.
Spot spotOf(const AreaOfTriangles& areas, std::size_t i, std::size_t count, std::uint64_t seed) {
  constexpr double kPlastic = 1.32471795724474602596;  // its powers have low discrepancy in two dimensions
  const double step = areas.whole() / static_cast<double>(count);
  const double shift = randomUnit(seed, 0);
  const std::size_t place = areas.holding((static_cast<double>(i) + shift) * step);
  // Index of the sample within its triangle: i minus the number of samples before the triangle.
  const double first = std::max(0.0, std::ceil(areas.begin(place) / step - shift));
  const double own = static_cast<double>(i) - first;
  const auto part = [](double value) { return value - std::floor(value); };
  double u = part(randomUnit(seed, 2 * place + 1) + own / kPlastic);
  double v = part(randomUnit(seed, 2 * place + 2) + own / (kPlastic * kPlastic));
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return {areas.triangle(place), {1 - u - v, u, v}};
}

Vec3 normalAt(const TriangleSoup& soup, const Spot& spot) {
  const auto& corners = soup.triangles[spot.triangle];
  if (!soup.normals.empty()) {
    DVec3 blended(0);
    for (int k = 0; k < 3; ++k) blended += spot.shares[k] * DVec3(soup.normals[corners[static_cast<std::size_t>(k)]]);
    const double length = glm::length(blended);
    if (length > 1e-6 && std::isfinite(length)) return Vec3(blended / length);
  }
  const DVec3 a = soup.corners[corners[0]];
  return Vec3(glm::normalize(glm::cross(soup.corners[corners[1]] - a, soup.corners[corners[2]] - a)));
}

TextureSpot textureAt(const TriangleSoup& soup, const Spot& spot) {
  const auto& [texture, uv] = soup.textured[spot.triangle];
  const DVec2 at = spot.shares[0] * DVec2(uv[0]) + spot.shares[1] * DVec2(uv[1]) + spot.shares[2] * DVec2(uv[2]);
  return {texture, Vec2(at)};
}

/// As multiplyByTextures(); colours that were missing before are removed again if no texture can be read.
template <class Colors>
std::vector<std::string> multiplied(const TriangleSoup& soup, std::span<const TextureSpot> spots, Colors& colors,
                                    unsigned threads) {
  const bool hadColors = !soup.colors.empty();
  if (!hadColors) colors.assign(spots.size(), Rgba{255, 255, 255, 255});
  std::vector<std::string> lost = multiplyByTextures(soup.textures, spots, colors, threads);
  if (!hadColors && lost.size() == soup.textures.size()) colors.clear();
  return lost;
}

std::array<std::uint8_t, 4> colorAt(const TriangleSoup& soup, const Spot& spot) {
  const auto& corners = soup.triangles[spot.triangle];
  std::array<std::uint8_t, 4> color{};
  for (std::size_t channel = 0; channel < 4; ++channel) {
    double value = 0.5;  // for rounding
    for (std::size_t k = 0; k < 3; ++k) value += spot.shares[static_cast<int>(k)] * soup.colors[corners[k]][channel];
    color[channel] = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
  }
  return color;
}

}  // namespace

namespace {

/// Whether colours differ by more than the two sides of a seam in a picture do.
bool areDifferent(const Rgba& a, const Rgba& b) {
  constexpr int kSeam = 4;
  for (std::size_t k = 0; k < 4; ++k)
    if (std::abs(a[k] - b[k]) > kSeam) return true;
  return false;
}

/// Gives each corner its colour; one of several colours becomes several, behind the others.
void divideByColor(TriangleSoup& soup, std::span<const Rgba> colors) {
  constexpr std::uint32_t kNone = 0xffffffff;
  const std::size_t before = soup.corners.size();
  std::vector<std::uint32_t> next(before, kNone);  // the same corner in another colour
  std::vector<bool> isColored(before, false);
  soup.colors.resize(before, Rgba{255, 255, 255, 255});
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& corner = soup.triangles[t][k];
      const Rgba& color = colors[3 * t + k];
      if (!isColored[corner]) {
        isColored[corner] = true;
        soup.colors[corner] = color;
        continue;
      }
      while (areDifferent(soup.colors[corner], color) && next[corner] != kNone) corner = next[corner];
      if (!areDifferent(soup.colors[corner], color)) continue;
      if (soup.corners.size() == kNone) throw Error("a mesh has more than 4,294,967,295 corners");
      next[corner] = static_cast<std::uint32_t>(soup.corners.size());
      next.push_back(kNone);
      isColored.push_back(true);
      soup.corners.push_back(DVec3(soup.corners[corner]));
      if (!soup.normals.empty()) soup.normals.push_back(Vec3(soup.normals[corner]));
      soup.colors.push_back(color);
      corner = next[corner];
    }
}

}  // namespace

BadCorners leaveOutBadCorners(TriangleSoup& soup) {
  constexpr std::uint32_t kGone = 0xffffffff;
  std::vector<std::uint32_t> numbers(soup.corners.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < soup.corners.size(); ++i) {
    const DVec3 p = soup.corners[i];
    const bool isThere = std::abs(p.x) < kMaxCorner && std::abs(p.y) < kMaxCorner && std::abs(p.z) < kMaxCorner;
    numbers[i] = isThere ? kept : kGone;
    if (!isThere) continue;
    soup.corners[kept] = p;
    if (!soup.normals.empty()) soup.normals[kept] = soup.normals[i];
    if (!soup.colors.empty()) soup.colors[kept] = soup.colors[i];
    ++kept;
  }
  BadCorners bad{.corners = soup.corners.size() - kept};
  if (bad.corners == 0) return bad;
  soup.corners.resize(kept);
  if (!soup.normals.empty()) soup.normals.resize(kept);
  if (!soup.colors.empty()) soup.colors.resize(kept);
  std::size_t left = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    std::array<std::uint32_t, 3> triangle = soup.triangles[t];
    for (std::uint32_t& corner : triangle) corner = numbers[corner];
    if (std::ranges::count(triangle, kGone) > 0) continue;
    soup.triangles[left] = triangle;
    if (!soup.textured.empty()) soup.textured[left] = soup.textured[t];
    ++left;
  }
  bad.triangles = soup.triangles.size() - left;
  soup.triangles.resize(left);
  if (!soup.textured.empty()) soup.textured.resize(left);
  return bad;
}

std::vector<std::string> colorCorners(TriangleSoup& soup) {
  if (soup.textures.empty()) return {};
  // All corners of all triangles, each with its colour.
  std::vector<TextureSpot> spots;
  std::vector<Rgba> colors;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      spots.push_back({soup.textured[t].texture, soup.textured[t].uv[k]});
      if (!soup.colors.empty()) colors.push_back(soup.colors[soup.triangles[t][k]]);
    }
  std::vector<std::string> unread = multiplied(soup, spots, colors, 0);
  if (!colors.empty()) divideByColor(soup, colors);
  return unread;
}

SampledSoup sampleSoup(const TriangleSoup& soup, std::size_t count, std::uint64_t seed, unsigned threads) {
  const AreaOfTriangles areas(soup);
  SampledSoup result{.flat = areas.flat()};
  if (!(areas.whole() > 0) || !std::isfinite(areas.whole())) return result;
  Bounds box{DVec3(std::numeric_limits<double>::infinity()), DVec3(-std::numeric_limits<double>::infinity())};
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (const std::uint32_t corner : soup.triangles[t]) {
      const DVec3& place = soup.corners[corner];
      if (!(std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) < kMaxCorner)) continue;
      box = {glm::min(box.min, place), glm::max(box.max, place)};
    }
  PointCloud& cloud = result.cloud;
  cloud.origin = originFor(box);
  cloud.positions.resize(count);
  cloud.normals.resize(count);
  if (!soup.colors.empty()) cloud.colors.resize(count);
  std::vector<TextureSpot> spots(soup.textures.empty() ? 0 : count);
  parallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Spot spot = spotOf(areas, i, count, seed);
      const auto& corners = soup.triangles[spot.triangle];
      DVec3 place(0);
      for (int k = 0; k < 3; ++k)
        place += spot.shares[k] * (soup.corners[corners[static_cast<std::size_t>(k)]] - cloud.origin);
      cloud.positions[i] = Vec3(place);
      cloud.normals[i] = normalAt(soup, spot);
      if (!soup.colors.empty()) cloud.colors[i] = colorAt(soup, spot);
      if (!spots.empty()) spots[i] = textureAt(soup, spot);
    }
  });
  if (!spots.empty()) result.lost = multiplied(soup, spots, cloud.colors, threads);
  return result;
}

}  // namespace palpate
