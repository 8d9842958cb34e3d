#include "engine/select/fields.hpp"

#include <algorithm>
#include <array>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr std::array<const char*, 5> kMadeNames{"height", "density", "roughness", "curvature", "verticality"};

bool isWide(ScalarType type) { return type == ScalarType::i64 || type == ScalarType::u64; }

template <class To>
void readAttribute(const Attribute& attribute, std::size_t begin, std::span<To> to) {
  visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
    const std::byte* const from = attribute.data.data() + begin * sizeof(T);
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<To>(loadScalar<T>(from + i * sizeof(T)));
  });
}

}  // namespace

CloudFields::CloudFields(const PointCloud& cloud, const FieldOptions& options)
    : cloud_(cloud), options_(options), coordinates_(cloud) {
  using enum Field::Source;
  const auto add = [&](const char* name, Field::Source source, std::size_t index, bool isSingle) {
    fields_.push_back({.name = name, .source = source, .index = index, .isSingle = isSingle});
  };
  const StoredAs& stored = cloud.storedAs;
  const bool single = !isExact(cloud) && cloud.origin == DVec3(0) && stored.position == ScalarType::f32;
  for (std::size_t k = 0; k < 3; ++k) add(std::array{"x", "y", "z"}[k], coordinate, k, single);
  for (std::size_t k = 0; cloud.hasNormals() && k < 3; ++k)
    add(std::array{"nx", "ny", "nz"}[k], normal, k, stored.normal == ScalarType::f32);
  for (std::size_t k = 0; cloud.hasColors() && k < 3; ++k) add(std::array{"red", "green", "blue"}[k], color, k, false);
  for (std::size_t k = 0; k < cloud.extra.size(); ++k) {
    const Attribute& each = cloud.extra[k];
    fields_.push_back({.name = each.name,
                       .source = attribute,
                       .index = k,
                       .isWhole = isWide(each.type),
                       .isSingle = each.type == ScalarType::f32});
  }
  for (std::size_t k = 0; k < kMadeNames.size(); ++k)
    if (!find(kMadeNames[k])) add(kMadeNames[k], made, k, false);
}

std::vector<std::string> CloudFields::names() const {
  std::vector<std::string> names;
  for (const Field& field : fields_) names.push_back(field.name);
  return names;
}

std::optional<std::size_t> CloudFields::find(std::string_view name) const {
  const auto found = std::ranges::find(fields_, name, &Field::name);
  return found == fields_.end() ? std::nullopt : std::optional<std::size_t>(found - fields_.begin());
}

void CloudFields::compute(std::size_t field) {
  if (fields_[field].source == Field::Source::made && !made_.contains(field))
    made_[field] = madeField(cloud_, static_cast<MadeField>(fields_[field].index), options_);
}

void CloudFields::read(std::size_t field, std::size_t begin, std::span<double> to) const {
  const Field& from = fields_[field];
  const auto axis = static_cast<int>(from.index);
  switch (from.source) {
    case Field::Source::coordinate:
      if (isExact(cloud_)) {
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = coordinates_.at(begin + i)[axis];
      } else {
        const double origin = cloud_.origin[axis];
        for (std::size_t i = 0; i < to.size(); ++i)
          to[i] = origin + static_cast<double>(cloud_.positions[begin + i][axis]);
      }
      return;
    case Field::Source::normal:
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<double>(cloud_.normals[begin + i][axis]);
      return;
    case Field::Source::color:
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = cloud_.colors[begin + i][from.index];
      return;
    case Field::Source::attribute:
      return readAttribute(cloud_.extra[from.index], begin, to);
    case Field::Source::made:
      std::copy_n(made_.at(field).begin() + static_cast<std::ptrdiff_t>(begin), to.size(), to.begin());
  }
}

void CloudFields::read(std::size_t field, std::size_t begin, std::span<Whole> to) const {
  PALPATE_CHECK(fields_[field].isWhole);
  readAttribute(cloud_.extra[fields_[field].index], begin, to);
}

}  // namespace palpate
