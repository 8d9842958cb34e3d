// Which of a device's axes a person sees as right, up and towards them.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/vec.hpp"

namespace palpate {

/// A signed permutation. It may mirror, as the poses of a device that is set up for the other hand do.
class DeviceAxes {
 public:
  /// Right, up and towards the user: 1 is the device's +x, -3 its -z. The default is the device's own axes.
  DeviceAxes() = default;
  /// Empty if they are not a permutation.
  static std::optional<DeviceAxes> of(const std::array<int, 3>& axes);
  /// From a text as in "x,z,-y"; empty if it is not a permutation.
  static std::optional<DeviceAxes> named(std::string_view text);

  const std::array<int, 3>& numbers() const { return axes_; }
  /// "x,z,-y".
  std::string text() const;
  bool isUnchanged() const { return *this == DeviceAxes(); }
  bool mirrors() const;
  /// From the device's coordinates to the person's; its inverse is its transpose.
  glm::dmat3 matrix() const;
  /// These axes, of a device whose own axes were changed by `inner` before.
  DeviceAxes after(const DeviceAxes& inner) const;

  bool operator==(const DeviceAxes&) const = default;

 private:
  explicit DeviceAxes(const std::array<int, 3>& axes) : axes_(axes) {}

  std::array<int, 3> axes_{1, 2, 3};
};

/// Empty if the text names axes, or is empty; else a sentence that says how to name them.
std::string axesComplaint(const std::string& axes);

}  // namespace palpate
