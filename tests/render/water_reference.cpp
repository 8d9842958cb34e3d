#include "tests/render/water_reference.hpp"

#include <algorithm>
#include <cmath>

#include "shaders/shared/water.h"

namespace palpate::water_test {

Surface ballsOf(const Passes& p) {
  const std::size_t pixels = std::size_t{p.size.width} * p.size.height;
  Surface result{std::vector<double>(pixels, kNone), std::vector<double>(pixels), std::vector<double>(pixels)};
  for (const Vec3& position : p.positions) {
    const DVec3 center = p.inEye(DVec3(position));
    const double radius = std::max(kRadius, double{shared::kMinBall_px} / p.unitPx(center.z));
    if (center.z - radius < p.camera.nearDepth) continue;
    const double share = std::pow(kSpacing, 3) / (4.0 / 3 * 3.14159265358979 * std::pow(radius, 3));
    for (std::uint32_t y = 0; y < p.size.height; ++y)
      for (std::uint32_t x = 0; x < p.size.width; ++x) {
        const auto [from, along] = p.rayOf(x + 0.5, y + 0.5);
        const double a = glm::dot(along, along), b = glm::dot(center - from, along);
        const double root = b * b - a * (glm::dot(center - from, center - from) - radius * radius);
        if (!(root > 0)) continue;
        const double front = (b - std::sqrt(root)) / a, back = (b + std::sqrt(root)) / a;
        const std::uint32_t middle = p.size.supersample / 2;
        const double end =
            std::min(back, p.depthBehind(x * p.size.supersample + middle, y * p.size.supersample + middle));
        if (!(front < end)) continue;
        const std::size_t place = std::size_t{y} * p.size.width + x;
        result.depth[place] = std::min(result.depth[place], front);
        ++result.cover[place];
        result.thickness[place] += share * std::sqrt(a) * (end - front) / p.particles.side;
      }
  }
  return result;
}

Surface smoothedAlong(const Passes& p, const Surface& in, bool columns) {
  Surface out = in;
  const int width = static_cast<int>(p.size.width), height = static_cast<int>(p.size.height);
  const DVec2 range = depthRangeOf(p.camera, {DVec3(-1), DVec3(1)});
  const double band = double{shared::kWaterBand} * kRadius;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto at = [&](int k) {
        const int u = std::clamp(x + (columns ? 0 : k), 0, width - 1),
                  v = std::clamp(y + (columns ? k : 0), 0, height - 1);
        return static_cast<std::size_t>(v * width + u);
      };
      const double here = in.depth[at(0)];
      const bool isSurface = here < kNone;
      const double usual = isSurface ? here : 0.5 * (std::max(range.x, p.camera.nearDepth) + range.y);
      const double sigma =
          double{shared::kWaterSmooth} * std::max(kRadius * p.unitPx(usual), double{shared::kMinBall_px});
      const int reach = static_cast<int>(
          std::min(std::ceil(double{shared::kWaterWindow} * sigma), double{shared::kMaxWaterReach_px}));
      double low = here - band, high = here + band, sum = isSurface ? here : 0, weights = isSurface ? 1 : 0;
      double thickness = in.thickness[at(0)], cover = in.cover[at(0)], narrow = 1;
      for (int k = 1; k <= reach; ++k) {
        const double gauss = std::exp(-0.5 * k * k / (sigma * sigma)),
                     quarter = std::exp(-2.0 * k * k / (sigma * sigma));
        double depth[2] = {in.depth[at(-k)], in.depth[at(k)]}, weight[2] = {gauss, gauss};
        for (int side = 0; side < 2; ++side) {
          const std::size_t there = at(side == 0 ? -k : k);
          thickness += quarter * in.thickness[there], cover += quarter * in.cover[there], narrow += quarter;
          if (!isSurface) {
            if (depth[side] == kNone) weight[side] = 0;
          } else if (depth[side] < low) {
            weight[0] = weight[1] = 0;
          } else if (depth[side] > high) {
            depth[side] = here + double{shared::kWaterRim} * kRadius;
          } else {
            low = std::min(low, depth[side] - band), high = std::max(high, depth[side] + band);
          }
        }
        for (int side = 0; side < 2; ++side)
          if (weight[side] > 0) sum += weight[side] * depth[side], weights += weight[side];
      }
      out.depth[at(0)] = weights > 0 ? sum / weights : kNone;
      out.thickness[at(0)] = thickness / narrow, out.cover[at(0)] = cover / narrow;
    }
  return out;
}

Surface tidied(const Passes& p, const Surface& in) {
  Surface out = in;
  const int width = static_cast<int>(p.size.width), height = static_cast<int>(p.size.height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double here = in.depth[static_cast<std::size_t>(y * width + x)];
      if (here == kNone) continue;
      const double ball_px = std::max(kRadius * p.unitPx(here), double{shared::kMinBall_px});
      const int reach =
          static_cast<int>(std::min(std::ceil(double{shared::kWaterTidy} * ball_px), double{shared::kMaxWaterTidy_px}));
      double sum = 0, count = 0;
      for (int v = y - reach; v <= y + reach; ++v)
        for (int u = x - reach; u <= x + reach; ++u) {
          const double there =
              in.depth[static_cast<std::size_t>(std::clamp(v, 0, height - 1) * width + std::clamp(u, 0, width - 1))];
          if (std::abs(there - here) <= double{shared::kWaterBand} * kRadius) sum += there, ++count;
        }
      out.depth[static_cast<std::size_t>(y * width + x)] = sum / count;
    }
  return out;
}

DVec3 lightOfWater(const DVec3& body, const DVec3& n, const DVec3& v, double gloss) {
  const DVec3 sky(0.26, 0.29, 0.34), ground(0.12, 0.10, 0.09), key = glm::normalize(DVec3(-0.55, 0.66, -0.52));
  const DVec3 keyLight(0.95, 0.89, 0.80), mirrored = 2 * glm::dot(n, v) * n - v;
  const double t = std::clamp((mirrored.y + 0.4) / 1.0, 0.0, 1.0);
  const DVec3 around = 2.4 * glm::mix(ground, sky, t * t * (3 - 2 * t));
  const DVec3 inside =
      body * (glm::mix(ground, sky, 0.5 + 0.5 * n.y) + 0.6 * keyLight * std::max(glm::dot(n, key), 0.0));
  const double reflectance = 0.02 + 0.98 * std::pow(1 - std::clamp(glm::dot(n, v), 0.0, 1.0), 5);
  return glm::mix(inside, around, reflectance) +
         gloss * 0.9 * keyLight * std::pow(std::max(glm::dot(n, glm::normalize(key + v)), 0.0), 120);
}

DVec4 composed(const Passes& p, const Surface& water, std::uint32_t x, std::uint32_t y) {
  const int ss = static_cast<int>(p.size.supersample), px = static_cast<int>(x) / ss, py = static_cast<int>(y) / ss;
  const int width = static_cast<int>(p.size.width), height = static_cast<int>(p.size.height);
  const auto depthAt = [&](int u, int v) {
    if (u < 0 || v < 0 || u >= width || v >= height) return kNone;
    return water.depth[static_cast<std::size_t>(v * width + u)];
  };
  const auto premultiplied = [&](std::size_t i) {
    return DVec4(DVec3(p.lights[i]) * double{p.lights[i].a}, p.lights[i].a);
  };
  const std::size_t place = std::size_t{y} * p.across() + x;
  const double depth = depthAt(px, py), end = p.depthBehind(x, y);
  const std::size_t pixel = static_cast<std::size_t>(py * width + px);
  const double fall =
      2.5066 * 0.5 * double{shared::kWaterSmooth} * std::max(kRadius * p.unitPx(depth), double{shared::kMinBall_px});
  const double cover = depth < kNone ? std::clamp(0.5 + (water.cover[pixel] - 0.5) * fall, 0.0, 1.0) : 0;
  const bool isSpread = p.fronts[pixel] == shared::kNoDepth && end < kNone;
  if (!(depth < end) || cover <= 0 || isSpread) return premultiplied(place);
  const auto gentler = [&](double before, double after) {
    const double back = depth - before, forth = after - depth, step = std::abs(back) < std::abs(forth) ? back : forth;
    return std::isinf(step) ? 0.0 : step;
  };
  const auto at = [&](double u, double v, double d) {
    const auto [from, along] = p.rayOf(u, v);
    return from + d * along;
  };
  const double u = px + 0.5, v = py + 0.5;
  const DVec3 here = at(u, v, depth);
  DVec3 n = glm::normalize(glm::cross(at(u + 1, v, depth + gentler(depthAt(px - 1, py), depthAt(px + 1, py))) - here,
                                      at(u, v + 1, depth + gentler(depthAt(px, py - 1), depthAt(px, py + 1))) - here));
  const DVec3 sight = p.rayOf(u, v).along;
  if (glm::dot(n, sight) > 0) n = -n;
  const DVec3 toViewer = -glm::normalize(sight);
  const double thickness = water.thickness[pixel], most = double{shared::kMaxWaterBend_px} * ss;
  const DVec2 shift_px =
      glm::clamp(-double{shared::kWaterBend} * thickness * p.particles.side * p.unitPx(depth) * ss * DVec2(n.x, -n.y),
                 -most, most);
  const int tx = std::clamp(static_cast<int>(x) + static_cast<int>(std::lround(shift_px.x)), 0, width * ss - 1);
  const int ty = std::clamp(static_cast<int>(y) + static_cast<int>(std::lround(shift_px.y)), 0, height * ss - 1);
  const bool isBehind = p.depthBehind(static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty)) > depth;
  const DVec4 behind = premultiplied(isBehind ? static_cast<std::size_t>(ty * width * ss + tx) : place);
  const DVec3 passes = glm::exp(-DVec3(shared::kWaterAbsorption) * thickness);
  const double reflectance = 0.02 + 0.98 * std::pow(1 - std::clamp(glm::dot(n, toViewer), 0.0, 1.0), 5);
  const double gloss = std::clamp(2 * water.cover[pixel] - 1, 0.0, 1.0);
  const DVec3 light = lightOfWater((1.0 - passes) * DVec3(0.02, 0.20, 0.40), n, toViewer, gloss) +
                      (1 - reflectance) * passes * DVec3(behind);
  const double opacity = 1 - (1 - behind.a) * (1 - reflectance) * passes.g;
  return glm::mix(premultiplied(place), DVec4(light, opacity), cover);
}

}  // namespace palpate::water_test
