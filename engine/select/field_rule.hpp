// Rules that set a field of a cloud, as in "classification = 6 if z > 3".
#pragma once

#include <string_view>

#include "engine/select/fields.hpp"

namespace palpate {

struct RuleEffect {
  std::size_t set = 0;        ///< number of points
  std::size_t notFinite = 0;  ///< of them, set to inf, -inf or nan, as by a division by zero
};

/// Applies "[TYPE] NAME = NUMBER [if CONDITION]" to a cloud. A new field
/// has the type that is named (float64 without one, int64 for whole numbers), and NaN or 0 at the other points. A field
/// of the file keeps its type, and whole ones are rounded. red, green and blue are 0 to 255; x, y and z move points;
/// all other points keep their coordinates bit by bit. `name`: of the option, with which errors begin. Throws Error,
/// with the cloud unchanged, for a text that is not a rule, a type that the field does not have, normals, and a value
/// that the type does not hold, which is named with its point.
RuleEffect applyRule(std::string_view name, std::string_view rule, PointCloud& cloud, const FieldOptions& options);

/// Whether a rule sets a coordinate. Throws Error for a text that is not a rule.
bool movesPoints(std::string_view name, std::string_view rule);

}  // namespace palpate
