#include "engine/edit/layer_attributes.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

std::byte* valueOf(Attribute& values, std::uint64_t point) { return values.data.data() + point * sizeOf(values.type); }

// Gives a point the value of another one; it is a new point if there is no value for it yet.
void copyValue(Attribute& values, std::uint64_t from, std::uint64_t to) {
  const std::size_t bytes = sizeOf(values.type);
  values.data.resize(std::max(values.data.size(), (std::max(from, to) + 1) * bytes));
  std::memmove(valueOf(values, to), valueOf(values, from), bytes);
}

}  // namespace

std::optional<std::uint32_t> LayerAttributes::fieldNamed(std::string_view name) const {
  const auto field =
      std::ranges::find(fields_, name, [](const Field& each) { return std::string_view(each.values.name); });
  if (field == fields_.end()) return std::nullopt;
  return static_cast<std::uint32_t>(field - fields_.begin());
}

std::uint32_t LayerAttributes::add(Field field) {
  fields_.push_back(std::move(field));
  return static_cast<std::uint32_t>(fields_.size() - 1);
}

void LayerAttributes::exchange(AttributeChange& change) {
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) {
    masks_[static_cast<std::size_t>(flip->role)].flip(flip->points);
    return;
  }
  auto& [layer, number, points, values] = std::get<FieldChange>(change);
  Attribute& field = fields_.at(number).values;
  const std::size_t bytes = sizeOf(field.type);
  PALPATE_CHECK_EQ(points.count() * bytes, values.size());
  field.data.resize(std::max<std::size_t>(field.data.size(), points.end() * bytes));
  std::byte* value = values.data();
  points.forEach([&](std::uint64_t point) {
    std::swap_ranges(value, value + bytes, valueOf(field, point));
    value += bytes;
  });
}

std::vector<AttributeChange> LayerAttributes::masks() const {
  std::vector<AttributeChange> flips;
  for (std::size_t role = 0; role < kMaskRoles; ++role)
    if (!masks_[role].empty())
      flips.emplace_back(MaskFlip{.role = static_cast<MaskRole>(role), .points = masks_[role]});
  return flips;
}

bool LayerAttributes::empty() const { return fields_.empty() && std::ranges::all_of(masks_, &PointSet::empty); }

void LayerAttributes::follow(EditBatch& batch, const PointStates& before) {
  if (empty()) return;
  PointSet fresh;
  std::array<PointSet, kMaskRoles> flips;
  for (const PointState& state : batch.points) {
    const std::uint64_t point = state.number, parent = state.parent;
    const PointState was = before[point];
    const bool isKnown = !was.gone || was.parent != point;
    if (isKnown || state.gone || parent == point) continue;
    fresh.set(point);
    for (std::size_t role = 0; role < kMaskRoles; ++role) {
      if (masks_[role].test(point) == masks_[role].test(parent)) continue;
      masks_[role].set(point, !masks_[role].test(point));
      flips[role].set(point, !flips[role].test(point));
    }
    for (Field& field : fields_) copyValue(field.values, parent, point);
  }
  for (std::size_t role = 0; role < kMaskRoles; ++role)
    if (!flips[role].empty())
      batch.attributes.emplace_back(MaskFlip{.role = static_cast<MaskRole>(role), .points = std::move(flips[role])});
  for (std::uint32_t i = 0; i < fields_.size() && !fresh.empty(); ++i) {
    const Attribute& field = fields_[i].values;
    FieldChange change{.field = i, .points = fresh};
    fresh.forEach([&](std::uint64_t point) {
      const auto value = std::span(field.data).subspan(point * sizeOf(field.type), sizeOf(field.type));
      change.values.insert(change.values.end(), value.begin(), value.end());
    });
    batch.attributes.emplace_back(std::move(change));
  }
}

PointSet existing(const PointSet& points, const PointStates& states) {
  PointSet there = points;
  points.forEach([&](std::uint64_t point) {
    if (states[point].gone) there.set(point, false);
  });
  return there;
}

Field initialField(const PointCloud& file, const PointStates& points, std::string_view name, ScalarType type) {
  const auto property = std::ranges::find(file.extra, name, &Attribute::name);
  Field field{.values = property != file.extra.end() ? *property : Attribute{std::string(name), type, {}}};
  field.values.data.resize(points.size() * sizeOf(field.values.type));
  for (std::uint64_t point = file.size(); point < points.size(); ++point)
    copyValue(field.values, points[point].parent, point);
  return field;
}

void addFields(const std::vector<Field>& fields, const PointStates& points, PointCloud& edited) {
  for (const Field& field : fields) {
    const Attribute& from = field.values;
    const std::size_t bytes = sizeOf(from.type);
    auto to = std::ranges::find(edited.extra, from.name, &Attribute::name);
    if (to == edited.extra.end()) to = edited.extra.insert(to, {from.name, from.type, {}});
    to->data.clear();
    for (const PointState& state : points) {
      if (state.gone) continue;
      const auto value = std::span(from.data).subspan(state.number * bytes, bytes);
      to->data.insert(to->data.end(), value.begin(), value.end());
    }
  }
}

}  // namespace palpate
