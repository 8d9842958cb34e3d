#include "engine/render/drawn_gaussians.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <glm/gtc/packing.hpp>

#include "engine/cloud/gaussian_columns.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

std::uint32_t countOf(const Device& device, std::size_t count) {
  if (count > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} Gaussians exceed the maximum that can be drawn", device.name(), count);
  return static_cast<std::uint32_t>(count);
}

bool isDrawable(const shared::Gaussian& g) {
  constexpr float kFarthest = 1e30f, kWidest = 1e15f;  // products with the focal length, and their squares, are finite
  const auto isBelow = [](const Vec3& v, float most) {
    return std::abs(v.x) < most && std::abs(v.y) < most && std::abs(v.z) < most;
  };
  const float turn = glm::dot(g.rotation, g.rotation);
  return isBelow(g.center, kFarthest) && isBelow(g.scale, kWidest) && isBelow(g.color, kFarthest) && turn > 0 &&
         std::isfinite(turn) && g.opacity > shared::kGaussianFaintest;
}

shared::Gaussian packed(const GaussianColumns& columns, const std::byte* row, const DVec3& origin,
                        const GaussianOwner& owner) {
  const DVec4 turn = columns.rotation(row);  // w x y z
  const double length = glm::length(turn);
  shared::Gaussian g{.center = Vec3(columns.center(row) - origin),
                     .opacity = 1 / (1 + std::exp(-columns.opacityLogit(row))),
                     .rotation = Vec4(DVec4(turn.y, turn.z, turn.w, turn.x) / length),
                     .scale = glm::exp(columns.logScales(row)),
                     .color = Vec3(0.5 + kZeroHarmonic * columns.color(row)),
                     .owner = owner.point,
                     .beside = owner.beside,
                     .across = owner.across};
  if (owner.point != GaussianOwner::kNone && !owner.isNear) g.owner |= shared::kFarOwner;
  if (!isDrawable(g)) return {.owner = shared::kNoOwner, .beside = shared::kNoOwner, .across = shared::kNoOwner};
  return g;
}

}  // namespace

DrawnGaussians::DrawnGaussians(Device& device, const PointCloud& cloud)
    : count_(countOf(device, gaussiansOf(cloud)->size())),
      spacing_(static_cast<float>(meanSpacing(cloud))),
      gaussians_(Buffer::of<shared::Gaussian>(device, count_ + 1, Memory::device, "Gaussians")),
      harmonics_(deviceWords(device, 0, "harmonics of Gaussians")),
      positions_(Buffer::of<Vec4>(device, cloud.size(), Memory::device, "loaded positions")),
      normals_(Buffer::of<Vec4>(device, cloud.size(), Memory::device, "loaded normals")),
      colors_(deviceWords(device, cloud.size(), "loaded colors")) {
  const GaussianRecords& records = *gaussiansOf(cloud);
  const GaussianColumns columns(records);
  harmonicCount_ = static_cast<std::uint32_t>(columns.harmonics());
  const BareVector<GaussianOwner> owners = gaussianOwners(cloud);
  const auto made =
      parallelMake(count_, 0, [&](std::size_t i) { return packed(columns, records.row(i), cloud.origin, owners[i]); });
  uploadBytes(device, device.throughputQueue(), gaussians_, std::as_bytes(std::span(made)));
  for (std::size_t i = 0; i < count_; ++i) beyondTouch_ += made[i].opacity > 0 && !owners[i].isNear ? 1 : 0;

  const std::size_t words = (3 * std::size_t{harmonicCount_} + 1) / 2;
  std::vector<std::uint32_t> halves(count_ * words);
  parallelFor(count_, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < harmonicCount_; ++k) {
        const DVec3 color = columns.harmonic(records.row(i), k);
        for (int c = 0; c < 3; ++c) {
          const std::size_t at = 3 * k + static_cast<std::size_t>(c);
          const double value = std::isfinite(color[c]) ? std::clamp(color[c], -1000.0, 1000.0) : 0;
          halves[i * words + at / 2] |= std::uint32_t{glm::packHalf1x16(static_cast<float>(value))} << 16 * (at % 2);
        }
      }
  });
  harmonics_ = deviceWords(device, halves.size(), "harmonics of Gaussians");
  upload(device, device.throughputQueue(), harmonics_, halves);

  std::vector<Vec4> positions(cloud.size(), Vec4(0)), normals(cloud.size(), Vec4(0));
  for (std::size_t i = 0; i < cloud.size(); ++i) positions[i] = Vec4(cloud.positions[i], 0);
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) normals[i] = Vec4(cloud.normals[i], 0);
  std::vector<std::array<std::uint8_t, 4>> colors = cloud.colors;
  colors.resize(cloud.size(), kUnpainted);
  upload(device, device.throughputQueue(), positions_, positions);
  upload(device, device.throughputQueue(), normals_, normals);
  upload(device, device.throughputQueue(), colors_, colors);
}

std::string DrawnGaussians::inWords() const {
  std::string words = gaussiansInWords(count_, 3 * std::size_t{harmonicCount_}) + ", drawn as they were trained";
  if (beyondTouch_ > 0)
    words += fmt::format("; {} of them (haze, sky) are too far from the surface to be felt", beyondTouch_);
  return words;
}

shared::GaussianPoints DrawnGaussians::loaded() const {
  return {.positions = positions_.address(), .normals = normals_.address(), .colors = colors_.address()};
}

std::uint64_t DrawnGaussians::bytes() const {
  return gaussians_.bytes() + harmonics_.bytes() + positions_.bytes() + normals_.bytes() + colors_.bytes();
}

}  // namespace palpate
