#include "engine/edit/layer_attributes.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/edited_gaussians.hpp"
#include "engine/core/check.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/parallel_collect.hpp"

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

const Attribute* LayerAttributes::lockValues(const PointCloud& file) const {
  const auto isBytes = [](const Attribute& values) { return values.type == ScalarType::u8; };
  if (const auto field = fieldNamed(kLockField))
    return isBytes(fields_[*field].values) ? &fields_[*field].values : nullptr;
  const auto property = std::ranges::find(file.extra, kLockField, &Attribute::name);
  return property != file.extra.end() && isBytes(*property) ? &*property : nullptr;
}

std::vector<std::uint8_t> LayerAttributes::lockWeights(const PointCloud& file,
                                                       std::span<const PointState> states) const {
  std::vector<std::uint8_t> weights(states.size());
  const Attribute* const values = lockValues(file);
  if (!values) {
    mask(MaskRole::locked).forEach([&](std::uint64_t point) {
      if (point < weights.size()) weights[point] = PointLock::kWhole;
    });
    return weights;
  }
  const std::size_t known = std::min(values->data.size(), weights.size());
  std::memcpy(weights.data(), values->data.data(), known);
  for (std::size_t point = known; point < weights.size(); ++point) weights[point] = weights[states[point].parent];
  return weights;
}

PointLock LayerAttributes::lock(const PointCloud& file, std::span<const PointState> states) const {
  PointLock lock;
  if (const PointSet within = existing(mask(MaskRole::within), states); !within.empty()) {
    lock.points = PointSet::range(0, states.size());
    lock.points.remove(within);
  }
  if (!lockValues(file)) {
    lock.points.add(mask(MaskRole::locked));
    return lock;
  }
  lock.weights = lockWeights(file, states);
  bool isInPart = false;
  for (std::size_t point = 0; point < lock.weights.size(); ++point) {
    if (lock.weights[point] == PointLock::kWhole) lock.points.set(point);
    isInPart = isInPart || (lock.weights[point] > 0 && lock.weights[point] < PointLock::kWhole);
  }
  if (!isInPart) lock.weights.clear();
  return lock;
}

bool LayerAttributes::isOfLock(const AttributeChange& change) const {
  if (const auto* const flip = std::get_if<MaskFlip>(&change))
    return flip->role == MaskRole::locked || flip->role == MaskRole::within;
  if (const auto* const made = std::get_if<FieldPresence>(&change)) return made->name == kLockField;
  const auto* const field = std::get_if<FieldChange>(&change);
  return field && fieldNamed(kLockField) == field->field;
}

std::optional<std::uint32_t> LayerAttributes::fieldNamed(std::string_view name) const {
  const auto field =
      std::ranges::find(fields_, name, [](const Field& each) { return std::string_view(each.values.name); });
  if (field == fields_.end()) return std::nullopt;
  return static_cast<std::uint32_t>(field - fields_.begin());
}

bool LayerAttributes::fits(const AttributeChange& change) const {
  if (const auto* const of = std::get_if<FieldChange>(&change))
    return of->field < fields_.size() && of->values.size() % sizeOf(fields_[of->field].values.type) == 0 &&
           of->points.count() == of->values.size() / sizeOf(fields_[of->field].values.type);
  if (const auto* const layer = std::get_if<StrokeLayerChange>(&change)) return strokeLayers_.fits(*layer);
  const auto* const of = std::get_if<FieldPresence>(&change);
  if (!of) return true;
  if (!of->isPresent) return std::uint64_t{of->field} + 1 == fields_.size();
  const std::uint64_t bytes = sizeOf(static_cast<ScalarType>(of->type));
  return of->field == fields_.size() &&
         (of->values.empty() || (of->values.size() % bytes == 0 && of->values.size() / bytes == of->points));
}

void LayerAttributes::exchange(AttributeChange& change) {
  PALPATE_CHECK(fits(change));
  if (const auto* const flip = std::get_if<MaskFlip>(&change))
    masks_[static_cast<std::size_t>(flip->role)].flip(flip->points);
  else if (auto* const of = std::get_if<FieldChange>(&change))
    exchange(*of);
  else if (auto* const layer = std::get_if<StrokeLayerChange>(&change))
    strokeLayers_.exchange(*layer);
  else
    exchange(std::get<FieldPresence>(change));
}

void LayerAttributes::exchange(FieldChange& change) {
  Attribute& field = fields_[change.field].values;
  const std::size_t bytes = sizeOf(field.type);
  field.data.resize(std::max<std::size_t>(field.data.size(), change.points.end() * bytes));
  std::byte* value = change.values.data();
  change.points.forEach([&](std::uint64_t point) {
    std::swap_ranges(value, value + bytes, valueOf(field, point));
    value += bytes;
  });
}

void LayerAttributes::exchange(FieldPresence& change) {
  const std::size_t bytes = sizeOf(static_cast<ScalarType>(change.type));
  if (change.isPresent) {
    Field field{.values = {change.name, static_cast<ScalarType>(change.type), {}}, .unit = change.unit};
    fields_.reserve(fields_.size() + 1);
    change.values.resize(change.points * bytes);
    std::swap(field.values.data, change.values);  // no memory is needed from here on
    fields_.push_back(std::move(field));
  } else {
    std::swap(fields_.back().values.data, change.values);
    fields_.pop_back();
    change.points = change.values.size() / bytes;
    if (std::ranges::all_of(change.values, [](std::byte byte) { return byte == std::byte{0}; })) change.values = {};
  }
  change.isPresent = !change.isPresent;
}

std::vector<AttributeChange> LayerAttributes::masks() const {
  std::vector<AttributeChange> flips;
  for (std::size_t role = 0; role < kMaskRoles; ++role)
    if (!masks_[role].empty())
      flips.emplace_back(MaskFlip{.role = static_cast<MaskRole>(role), .points = masks_[role]});
  return flips;
}

std::vector<AttributeChange> LayerAttributes::all() const {
  std::vector<AttributeChange> changes;
  for (const Field& field : fields_)
    changes.emplace_back(FieldPresence{.field = static_cast<std::uint32_t>(changes.size()),
                                       .name = field.values.name,
                                       .unit = field.unit,
                                       .type = static_cast<std::uint8_t>(field.values.type),
                                       .points = field.values.data.size() / sizeOf(field.values.type),
                                       .values = field.values.data});
  std::ranges::move(masks(), std::back_inserter(changes));
  std::ranges::move(strokeLayers_.all(), std::back_inserter(changes));
  return changes;
}

void LayerAttributes::follow(EditBatch& batch, const PointStates& before) {
  if (empty()) return;
  PointSet fresh;
  std::array<PointSet, kMaskRoles> flips;
  const auto isFresh = [&](std::size_t i) {
    const PointState& state = batch.points[i];
    if (state.gone || state.parent == state.number) return false;
    const PointState was = before[state.number];
    return was.gone && was.parent == state.number;
  };
  for (const std::size_t i :
       parallelCollect(batch.points.size(), 0, isFresh, [](std::size_t found) { return found; })) {
    const std::uint64_t point = batch.points[i].number, parent = batch.points[i].parent;
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

PointSet existing(const PointSet& points, std::span<const PointState> states) {
  std::vector<PointSet::Word> words = points.list();
  parallelFor(words.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint64_t gone = 0;
      words[i].forEach([&](std::uint64_t point, std::uint64_t) {
        gone |= std::uint64_t{point >= states.size() || states[point].gone} << (point - words[i].begin);
      });
      words[i].bits = gone;
    }
  });
  PointSet there = points;
  for (const PointSet::Word& word : words)
    word.forEach([&](std::uint64_t point, std::uint64_t) { there.set(point, false); });
  return there;
}

AttributeChange renumbered(const AttributeChange& change, std::span<const PointState> states) {
  std::vector<std::uint64_t> numbers(states.size());  // of those before
  for (std::size_t i = 1; i < states.size(); ++i) numbers[i] = numbers[i - 1] + !states[i - 1].gone;
  AttributeChange next = change;
  const auto points = [&](const PointSet& had, auto&& keep) {
    PointSet kept;
    std::size_t i = 0;
    had.forEach([&](std::uint64_t point) {
      const bool isThere = point < states.size() && !states[point].gone;
      if (isThere) kept.set(numbers[point]), keep(i);
      ++i;
    });
    return kept;
  };
  const auto valueAt = [](std::span<const std::byte> values, std::size_t i, std::size_t bytes) {
    return values.subspan(i * bytes, bytes);
  };
  if (auto* const strokes = std::get_if<StrokeLayerChange>(&next)) {
    *strokes = renumbered(std::move(*strokes), states, numbers);
  } else if (auto* const flip = std::get_if<MaskFlip>(&next)) {
    flip->points = points(flip->points, [](std::size_t) {});
  } else if (auto* const of = std::get_if<FieldChange>(&next)) {
    const std::vector<std::byte> had = std::exchange(of->values, {});
    const std::size_t bytes = of->points.empty() ? 1 : had.size() / of->points.count();
    of->points = points(of->points, [&](std::size_t i) {
      const auto value = valueAt(had, i, bytes);
      of->values.insert(of->values.end(), value.begin(), value.end());
    });
  } else {
    auto& made = std::get<FieldPresence>(next);
    const std::vector<std::byte> had = std::exchange(made.values, {});
    const std::size_t bytes = sizeOf(static_cast<ScalarType>(made.type));
    made.points = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (states[i].gone) continue;
      ++made.points;
      if (had.empty()) continue;
      made.values.resize(made.points * bytes);
      if ((i + 1) * bytes > had.size()) continue;
      std::ranges::copy(valueAt(had, i, bytes), made.values.end() - static_cast<std::ptrdiff_t>(bytes));
    }
  }
  return next;
}

FieldPresence initialField(const PointCloud& file, const PointStates& points, std::string_view name, ScalarType type,
                           std::size_t number) {
  FieldPresence made{.field = static_cast<std::uint32_t>(number),
                     .name = std::string(name),
                     .type = static_cast<std::uint8_t>(type),
                     .points = points.size()};
  const auto property = std::ranges::find(file.extra, name, &Attribute::name);
  if (property == file.extra.end()) return made;
  Attribute values = *property;
  values.data.resize(points.size() * sizeOf(values.type));
  for (std::uint64_t point = file.size(); point < points.size(); ++point)
    copyValue(values, points[point].parent, point);
  made.type = static_cast<std::uint8_t>(values.type);
  made.values = std::move(values.data);
  return made;
}

namespace {

// Calls use(bytes) with the value of each existing point.
void forExisting(const Attribute& values, std::span<const PointState> points, auto&& use) {
  const std::size_t bytes = sizeOf(values.type);
  const std::vector<std::byte> zero(bytes);
  for (const PointState& state : points) {
    if (state.gone) continue;
    const bool isThere = (state.number + 1) * bytes <= values.data.size();
    use(isThere ? std::span(values.data).subspan(state.number * bytes, bytes) : std::span(zero));
  }
}

}  // namespace

PointCloud editedCloud(const PointCloud& file, std::span<const PointState> points, const std::vector<Field>& fields) {
  PointCloud edited = editedCloud(file, points);
  for (const Field& field : fields) {
    auto to = std::ranges::find(edited.extra, field.values.name, &Attribute::name);
    if (to == edited.extra.end()) to = edited.extra.insert(to, {field.values.name, field.values.type, {}});
    to->type = field.values.type;
    to->data.clear();
    forExisting(field.values, points,
                [&](std::span<const std::byte> value) { to->data.insert(to->data.end(), value.begin(), value.end()); });
    if (field.values.name == kLockField && field.values.type == ScalarType::u8 && gaussiansOf(edited))
      edited.storedAs.baggage = withPointBytes(edited, kLockField, to->data);
  }
  return edited;
}

std::vector<std::uint64_t> checksumsOf(const LayerAttributes& attributes, std::span<const PointState> points) {
  std::vector<std::uint64_t> sums;
  for (std::size_t role = 0; role < kMaskRoles; ++role) {
    Checksum sum;
    existing(attributes.mask(static_cast<MaskRole>(role)), points).forWords([&](std::uint64_t k, std::uint64_t word) {
      sum.addValue(k), sum.addValue(word);
    });
    sums.push_back(sum.value());
  }
  for (const Field& field : attributes.fields()) {
    Checksum sum;
    sum.addValue(static_cast<std::uint64_t>(field.values.type));
    for (const std::string& text : {field.values.name, field.unit}) sum.add(std::as_bytes(std::span(text)));
    forExisting(field.values, points, [&](std::span<const std::byte> value) { sum.add(value); });
    sums.push_back(sum.value());
  }
  return sums;
}

std::uint64_t checksumOf(const DVec3& origin, std::span<const PointState> points, const LayerAttributes& attributes) {
  const std::uint64_t ofPoints = checksumOf(origin, points);
  const std::vector<std::uint64_t> sums = checksumsOf(attributes, points);
  if (sums == checksumsOf(LayerAttributes(), {})) return ofPoints;
  Checksum all;
  all.addValue(ofPoints);
  for (const std::uint64_t sum : sums) all.addValue(sum);
  return all.value();
}

}  // namespace palpate
