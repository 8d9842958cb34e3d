#include "haptics/devices/device_axes.hpp"

#include <cstdlib>
#include <glm/matrix.hpp>

namespace palpate {

std::optional<DeviceAxes> DeviceAxes::of(const std::array<int, 3>& axes) {
  std::array<bool, 3> used{};
  for (const int axis : axes) {
    if (axis == 0 || std::abs(axis) > 3) return std::nullopt;
    bool& isUsed = used[static_cast<std::size_t>(std::abs(axis) - 1)];
    if (isUsed) return std::nullopt;
    isUsed = true;
  }
  return DeviceAxes(axes);
}

std::optional<DeviceAxes> DeviceAxes::named(std::string_view text) {
  std::array<int, 3> axes{};
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::size_t end = text.find(',');
    std::string_view word = text.substr(0, end);
    if ((end == text.npos) != (k + 1 == axes.size())) return std::nullopt;
    if (end != text.npos) text.remove_prefix(end + 1);
    const int sign = word.starts_with('-') ? -1 : 1;
    if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
    if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return std::nullopt;
    axes[k] = sign * (word[0] - 'x' + 1);
  }
  return of(axes);
}

std::string DeviceAxes::text() const {
  std::string text;
  for (const int axis : axes_) {
    if (!text.empty()) text += ',';
    if (axis < 0) text += '-';
    text += static_cast<char>('x' + std::abs(axis) - 1);
  }
  return text;
}

bool DeviceAxes::mirrors() const { return glm::determinant(matrix()) < 0; }

glm::dmat3 DeviceAxes::matrix() const {
  glm::dmat3 matrix(0);  // a column for each of the device's axes
  for (int k = 0; k < 3; ++k) {
    const int axis = axes_[static_cast<std::size_t>(k)];
    matrix[std::abs(axis) - 1][k] = axis < 0 ? -1 : 1;
  }
  return matrix;
}

DeviceAxes DeviceAxes::after(const DeviceAxes& inner) const {
  std::array<int, 3> axes{};
  for (std::size_t k = 0; k < axes.size(); ++k)
    axes[k] = (axes_[k] < 0 ? -1 : 1) * inner.axes_[static_cast<std::size_t>(std::abs(axes_[k]) - 1)];
  return DeviceAxes(axes);
}

std::string axesComplaint(const std::string& axes) {
  if (axes.empty() || DeviceAxes::named(axes)) return {};
  return "'" + axes +
         "' is not a permutation of x,y,z; name the axes that point right, up and towards the user, as in x,z,-y";
}

}  // namespace palpate
