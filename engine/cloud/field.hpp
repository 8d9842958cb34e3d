#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A number for each point of a layer.
struct Field {
  Attribute values;  ///< by the points' numbers; name and type of the field
  std::string unit;  ///< empty if it has none, or none is known
};

/// Values in native byte order, as colours of a picture read them.
inline std::vector<float> floatsOf(ScalarType type, std::span<const std::byte> values) {
  std::vector<float> floats(values.size() / sizeOf(type));
  visitScalar(type, [&]<class T>(std::type_identity<T>) {
    for (std::size_t i = 0; i < floats.size(); ++i)
      floats[i] = static_cast<float>(loadScalar<T>(values, i * sizeof(T)));
  });
  return floats;
}

}  // namespace palpate
