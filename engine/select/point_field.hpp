// A field of the points of an edited cloud, for pictures and selections.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cloud/field.hpp"
#include "engine/core/point_state.hpp"
#include "engine/select/fields.hpp"
#include "engine/select/point_bits.hpp"

namespace palpate {

/// The numbers of a field, by the points' numbers, as a file saved now would have them. New points have those of their
/// parents; coordinates, normals and colours are the present ones; what is computed (MadeField) stays as it was before
/// the first edit. Numbers are relative to base(), so that single precision tells them apart. For one thread.
class PointField {
 public:
  /// `file`: the cloud before the first edit, which must outlive this. Computes what is not in the file. `setting`: of
  /// the option, with which errors begin; `others`: further words that it takes. Throws UsageError for an unknown
  /// field, and Stopped.
  PointField(std::string_view setting, std::string_view name, const PointCloud& file, const std::vector<Field>& fields,
             const FieldOptions& options, std::vector<std::string> others = {});

  const std::string& name() const { return name_; }
  /// Whole numbers of 64 bits, which are shown to the last digit unless they are more than 2^53 apart.
  bool isWide() const { return isWide_; }
  std::optional<CloudFields::Field> inFile() const { return source_; }
  const std::string& unit() const { return unit_; }  ///< of a field of the layer

  /// Takes all points. `states`: by number; `fields`: of the layer.
  void read(std::span<const PointState> states, const std::vector<Field>& fields);
  /// Takes these points, whose states or numbers have changed, and returns their numbers. Otherwise as read().
  std::vector<std::pair<std::uint64_t, float>> follow(std::span<const PointState> changed,
                                                      const std::vector<Field>& fields);

  /// Relative to base(). NaN: none, or an infinite one.
  std::span<const double> numbers() const { return numbers_; }
  Whole base() const { return base_; }
  double relative(double number) const { return number - static_cast<double>(base_); }
  /// The number that a text of decimals is. Empty if it is none.
  std::optional<double> relative(std::string_view text) const;
  /// With the digits that a step of `resolution` needs.
  std::string text(double relative, double resolution) const;

 private:
  double numberOf(const PointState& point, const std::vector<Field>& fields) const;
  void put(const PointState& point, const std::vector<Field>& fields);

  const PointCloud& file_;
  std::string name_, unit_;
  std::optional<CloudFields::Field> source_;  // in the file; empty: only of the layer
  std::vector<double> inFile_;                // relative to the base
  std::optional<std::size_t> layer_;          // its number among the fields of the layer
  bool isWide_ = false;
  Whole base_ = 0;
  std::vector<double> numbers_;
};

/// The names of all fields of a model: of its layer and of its file, then those that can be computed.
std::vector<std::string> fieldNames(const PointCloud& file, const std::vector<Field>& fields);

/// The ends of a range of colours, relative to a field's base, from "LOW,HIGH", each a number or a percentile as 2%.
/// `sorted`: the field's numbers, ascending. Throws UsageError that begins with `setting`.
std::pair<double, double> rangeIn(std::string_view setting, std::string_view text, const PointField& field,
                                  std::span<const double> sorted);
/// Throws what rangeIn() would throw for any field.
void checkRange(std::string_view setting, std::string_view text);

/// Those of `among` whose numbers are in the range, its ends included.
PointBits pointsInRange(const PointField& field, const PointBits& among, std::pair<double, double> range);

}  // namespace palpate
