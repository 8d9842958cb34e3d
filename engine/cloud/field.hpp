#pragma once

#include <string>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A number for each point of a layer.
struct Field {
  Attribute values;  ///< by the points' numbers; name and type of the field
  std::string unit;  ///< empty if it has none, or none is known
};

}  // namespace palpate
