#include "engine/cloud/gaussian_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

constexpr float kFlat = -100;         // logarithm of a deviation of zero
constexpr double kNegligible = 1e-4;  // rad, and of scales

}  // namespace

GaussianMotion::GaussianMotion(const DQuat& rotation, const DVec3& from, const DVec3& to, double scale)
    : rotation_(rotation), from_(from), to_(to), scale_(std::abs(scale - 1) > kNegligible ? scale : 1) {
  const double sine = glm::length(DVec3(rotation.x, rotation.y, rotation.z));
  if (2 * std::asin(std::min(sine, 1.0)) > kNegligible) harmonics_.emplace(rotation);
}

GaussianColumns::GaussianColumns(const GaussianRecords& records) {
  const auto each = [&]<std::size_t kCount>(std::array<Column, kCount>& columns, const char* name) {
    for (std::size_t k = 0; k < kCount; ++k) columns[k] = records.find(fmt::format("{}{}", name, k));
  };
  center_ = {records.find("x"), records.find("y"), records.find("z")};
  normal_ = {records.find("nx"), records.find("ny"), records.find("nz")};
  each(color_, "f_dc_"), each(logScales_, "scale_"), each(rotation_, "rot_");
  opacity_ = records.find("opacity");
  for (std::size_t k = 0; const Column column = records.find(fmt::format("{}{}", kRestName, k)); ++k)
    rest_.push_back(column);
  const auto isFloat = [](Column column) { return column && isFloating(column->type); };
  if (rest_.size() % 3 != 0 || !std::ranges::all_of(rest_, isFloat)) rest_.clear();
  if (!std::ranges::all_of(normal_, isFloat)) normal_ = {};
}

double GaussianColumns::load(Column column, const std::byte* row) {
  return visitScalar(column->type, [&]<class T>(std::type_identity<T>) {
    return static_cast<double>(loadScalar<T>(row + column->offset));
  });
}

void GaussianColumns::store(Column column, std::byte* row, double value) {
  visitScalar(column->type, [&]<class T>(std::type_identity<T>) {
    const T number = static_cast<T>(value);
    std::memcpy(row + column->offset, &number, sizeof number);
  });
}

void GaussianColumns::setThree(const std::array<Column, 3>& columns, std::byte* row, const DVec3& values) {
  for (int k = 0; k < 3; ++k) store(columns[static_cast<std::size_t>(k)], row, values[k]);
}

Vec3 GaussianColumns::logScales(const std::byte* row) const {
  const auto at = [&](std::size_t k) { return logScales_[k] ? static_cast<float>(load(logScales_[k], row)) : kFlat; };
  return {at(0), at(1), at(2)};
}

DVec4 GaussianColumns::rotation(const std::byte* row) const {
  return {load(rotation_[0], row), load(rotation_[1], row), load(rotation_[2], row), load(rotation_[3], row)};
}

std::size_t GaussianColumns::harmonics() const {
  const std::size_t each = rest_.size() / 3;
  for (const std::size_t whole : {kHarmonics, std::size_t{8}, std::size_t{3}})
    if (each >= whole) return whole;
  return 0;
}

DVec3 GaussianColumns::harmonic(const std::byte* row, std::size_t k) const {
  const std::size_t each = rest_.size() / 3;
  return {load(rest_[k], row), load(rest_[each + k], row), load(rest_[2 * each + k], row)};
}

void GaussianColumns::setCenter(std::byte* row, const DVec3& center) const { setThree(center_, row, center); }

void GaussianColumns::move(std::byte* row, const GaussianMotion& motion) const {
  setCenter(row, motion(center(row)));
  if (motion.scale() != 1) scale(row, std::log(motion.scale()));
  if (!motion.isRotated()) return;
  const DVec4 had = rotation(row);
  const DQuat q = motion.rotation() * DQuat(had[0], had[1], had[2], had[3]);
  const std::array<double, 4> turned{q.w, q.x, q.y, q.z};
  for (std::size_t k = 0; k < 4; ++k) store(rotation_[k], row, turned[k]);
  // Zero by convention, which stays zero bit by bit.
  if (const DVec3 normal = normal_[0] ? three(normal_, row) : DVec3(0); normal != DVec3(0))
    setThree(normal_, row, motion.rotation() * normal);
  std::vector<double> channel(rest_.size() / 3);
  for (std::size_t first = 0; first < rest_.size(); first += channel.size()) {
    for (std::size_t k = 0; k < channel.size(); ++k) channel[k] = load(rest_[first + k], row);
    motion.harmonics().rotate(channel);
    for (std::size_t k = 0; k < channel.size(); ++k) store(rest_[first + k], row, channel[k]);
  }
}

void GaussianColumns::scale(std::byte* row, double log) const {
  for (const Column column : logScales_)
    if (column) store(column, row, load(column, row) + log);
}

void GaussianColumns::paint(std::byte* row, const std::array<std::uint8_t, 4>& color) const {
  setThree(color_, row, (DVec3(color[0], color[1], color[2]) / 255.0 - 0.5) / kZeroHarmonic);
}

}  // namespace palpate
