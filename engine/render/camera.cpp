#include "engine/render/camera.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <glm/trigonometric.hpp>
#include <limits>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

constexpr double kFrontElevation_deg = 12;  // elevation of the fitted eye above the horizon
constexpr double kFlatElevation_deg = 40;   // likewise, for a model without height
constexpr double kRoomElevation_deg = 30;   // likewise, at least, for a room
constexpr double kLow = 0.3;                // of the width: flatter models are seen from higher up
constexpr double kFill = 0.9;               // share of the picture that the model fills
constexpr double kClosest = 1e-2;           // of the box: minimum distance of the fitted eye from the nearest point
constexpr double kNearestShare = 1e-3;      // of what is shown: minimum near plane
constexpr double kDirectionTolerance = 1e-9;

std::array<DVec3, 8> cornersOf(const Bounds& box) {
  std::array<DVec3, 8> corners;
  for (unsigned k = 0; k < 8; ++k)
    corners[k] = {k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z};
  return corners;
}

/// Scale for relative distances, also for a box without extent.
double sizeOf(const Bounds& box) {
  const double size = glm::length(box.max - box.min);
  return size > 0 ? size : 1.0;
}

/// A camera with the axes of `camera` whose picture contains all points and touches them at two opposite borders. A
/// point at x and depth z, seen from an eye at (ex, -D), is inside if |x - ex| <= t (z + D), t being the tangent of
/// half the field of view. So each border is one linear bound, and a pair of bounds gives ex and D directly. A ball
/// around the point moves each bound outwards by its radius over the cosine of half the field of view. Orthographic
/// bounds are those of x and y alone, and give the middle and the height.
template <class Points>
Camera fitted(Camera camera, const Bounds& bounds, const Points& points, double aspect, double margin,
              bool orthographic) {
  const Camera::Axes axes = camera.axes();
  const double half = kFill * std::tan(glm::radians(camera.fov_deg) / 2);
  const double ty = orthographic ? 0 : half, tx = ty * aspect;
  const double mx = margin * std::sqrt(1 + tx * tx), my = margin * std::sqrt(1 + ty * ty);
  const DVec3 center = bounds.center();
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double right = kNone, left = kNone, top = kNone, bottom = kNone, nearest = kNone;
  for (const auto& point : points) {
    const DVec3 p = DVec3(point) - center;
    const double x = glm::dot(p, axes.right), y = glm::dot(p, axes.up), z = glm::dot(p, axes.forward);
    right = std::max(right, x - tx * z + mx);
    left = std::max(left, -x - tx * z + mx);
    top = std::max(top, y - ty * z + my);
    bottom = std::max(bottom, -y - ty * z + my);
    nearest = std::max(nearest, -z + margin);
  }
  const bool any = nearest > kNone;
  const double x = any ? (right - left) / 2 : 0, y = any ? (top - bottom) / 2 : 0;
  const double wanted = any ? std::max((right + left) / (2 * half * aspect), (top + bottom) / (2 * half)) : 0;
  const double distance = std::max(wanted, (any ? nearest : 0) + kClosest * sizeOf(bounds));
  camera.target = center + x * axes.right + y * axes.up;
  camera.eye = camera.target - distance * axes.forward;
  if (orthographic) camera.height = 2 * half / kFill * (wanted > 0 ? wanted : distance);
  camera.setDepthRange(bounds, sizeOf(bounds));
  return camera;
}

/// At the origin, looking from the front and slightly from above, or from the side that is wanted.
Camera frontCamera(const Bounds& bounds, double fov_deg, const Framing& framing) {
  const DVec3 top = directionOf(framing.up), side = bounds.max - bounds.min;
  if (framing.side) {
    // In a plan the front is at the bottom of the picture; the right side is on the right in a view from below, too.
    const bool isPlan = framing.side == ModelSide::top, isBelow = framing.side == ModelSide::bottom;
    return {.eye = directionTo(*framing.side, framing.up, framing.front),
            .up = isPlan    ? -framing.front
                  : isBelow ? framing.front
                            : top,
            .fov_deg = fov_deg};
  }
  const double height = std::abs(glm::dot(side, top)), width = bounds.longestSide();
  const double flat = width > 0 ? std::max(0.0, 1 - height / (kLow * width)) : 0;
  const double low_deg = framing.fromAbove ? kRoomElevation_deg : kFrontElevation_deg;
  const double elevation = glm::radians(std::max(low_deg, glm::mix(kFrontElevation_deg, kFlatElevation_deg, flat)));
  return {.eye = std::sin(elevation) * top + std::cos(elevation) * framing.front, .up = top, .fov_deg = fov_deg};
}

bool parallel(const DVec3& a, const DVec3& b) {
  return glm::length(glm::cross(a, b)) <= kDirectionTolerance * glm::length(a) * glm::length(b);
}

double parseNumber(std::string_view text, std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw UsageError("camera: '{}' in '{}' is not a number", text, word);
  return value;
}

DVec3 parseVector(std::string_view text, std::string_view word) {
  DVec3 v;
  for (int k = 0; k < 3; ++k) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (k == 2))
      throw UsageError("camera: '{}' needs three numbers, as in eye=0,0,10", word);
    v[k] = parseNumber(text.substr(0, comma), word);
    text.remove_prefix(k == 2 ? text.size() : comma + 1);
  }
  return v;
}

double parseHeight(std::string_view text, std::string_view word) {
  const double height = parseNumber(text, word);
  if (!(height > 0)) throw UsageError("camera: '{}' is not a height above 0, model units", word);
  return height;
}

template <class T>
void setOnce(std::optional<T>& field, T value, std::string_view key) {
  if (field) throw UsageError("camera: '{}' is given twice", key);
  field = value;
}

}  // namespace

DVec3 directionTo(ModelSide side, UpAxis up, const DVec3& front) {
  const DVec3 top = directionOf(up), right = glm::cross(top, front);
  switch (side) {
    case ModelSide::front:
      return front;
    case ModelSide::back:
      return -front;
    case ModelSide::left:
      return -right;
    case ModelSide::right:
      return right;
    case ModelSide::top:
      return top;
    case ModelSide::bottom:
      return -top;
    case ModelSide::isometric:
      break;
  }
  return glm::normalize(front + right + top);
}

CameraRequest CameraRequest::parse(std::string_view text) {
  CameraRequest given;
  while (true) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return given;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find_first_of(" \t"));
    text.remove_prefix(word.size());
    const std::size_t equals = word.find('=');
    const std::string_view key = word.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? "" : word.substr(equals + 1);
    if (key == "eye") {
      setOnce(given.eye, parseVector(value, word), key);
    } else if (key == "target") {
      setOnce(given.target, parseVector(value, word), key);
    } else if (key == "up") {
      setOnce(given.up, parseVector(value, word), key);
    } else if (key == "fov") {
      setOnce(given.fov_deg, parseNumber(value, word), key);
    } else if (key == "ortho") {
      setOnce(given.ortho, word == key ? 0 : parseHeight(value, word), key);
    } else if (const auto side = valueNamed(kModelSides, word)) {
      setOnce(given.side, *side, "side");
    } else {
      throw UsageError(
          "camera: '{}' is not known; known are eye=x,y,z target=x,y,z up=x,y,z fov=degrees ortho=height {}", word,
          fmt::join(namesOf(kModelSides), " "));
    }
  }
}

Camera Camera::fitting(const Bounds& bounds, double aspect, double fov_deg, UpAxis up, double margin) {
  const Camera front = frontCamera(bounds, fov_deg, {.up = up, .front = frontOf(up)});
  return fitted(front, bounds, cornersOf(bounds), aspect, margin, false);
}

Camera Camera::fitting(const PointCloud& cloud, double aspect, double fov_deg, const Framing& framing) {
  const Bounds all = boundsOf(cloud), shown = framing.shown.value_or(all);
  const Camera front = frontCamera(shown, fov_deg, framing);
  if (shown == all) return fitted(front, all, cloud.positions, aspect, framing.margin, framing.orthographic);
  std::vector<Vec3> inside;
  for (const Vec3& p : cloud.positions)
    if (shown.contains(DVec3(p))) inside.push_back(p);
  Camera camera = fitted(front, shown, inside, aspect, framing.margin, framing.orthographic);
  camera.setDepthRange(all, sizeOf(shown));
  return camera;
}

Camera Camera::parse(std::string_view text, const PointCloud& cloud, double aspect, const Framing& framing) {
  return asked(CameraRequest::parse(text), cloud, aspect, framing);
}

Camera Camera::asked(const CameraRequest& given, const PointCloud& cloud, double aspect, const Framing& wanted) {
  Framing framing = wanted;
  if (given.side) framing.side = given.side;
  framing.orthographic |= given.ortho || framing.side == ModelSide::isometric;
  const double fov_deg = given.fov_deg.value_or(45);
  if (!(fov_deg >= 1 && fov_deg <= 170)) throw UsageError("camera: fov={} is not between 1 and 170 degrees", fov_deg);
  Camera camera = fitting(cloud, aspect, fov_deg, framing);
  const DVec3 fittedOffset = camera.eye - camera.target;
  if (given.ortho.value_or(0) > 0) camera.height = *given.ortho;
  if (given.target) camera.target = *given.target - cloud.origin;
  camera.eye = given.eye ? *given.eye - cloud.origin : camera.target + fittedOffset;
  const DVec3 direction = camera.target - camera.eye;
  if (glm::length(direction) == 0) throw UsageError("camera: eye and target are the same point");
  if (given.up) {
    camera.up = *given.up;
    if (glm::length(camera.up) == 0 || parallel(camera.up, direction))
      throw UsageError("camera: up must be a direction that is not along the view");
  } else if (parallel(camera.up, direction)) {
    camera.up = -framing.front;  // looking straight down or up: the model's front is at the bottom of the picture
  }
  const Bounds all = boundsOf(cloud);
  camera.setDepthRange(all, sizeOf(framing.shown.value_or(all)));
  return camera;
}

void Camera::setDepthRange(const Bounds& bounds, double size) {
  DVec2 range = depthRangeOf(*this, bounds);
  const double least = kNearestShare * (size > 0 ? size : 1);
  if (isOrthographic() && range.x < 2 * least) {
    const double back = 0.5 * sizeOf(bounds) - range.x;
    eye -= back * axes().forward;
    range += back;
  }
  nearDepth = std::max(0.5 * range.x, least);
  farDepth = std::max(2 * range.y, nearDepth + sizeOf(bounds));
}

Camera::Axes Camera::axes() const {
  const DVec3 forward = glm::normalize(target - eye);
  const DVec3 right = glm::normalize(glm::cross(forward, up));
  return {right, glm::cross(right, forward), forward};
}

double Camera::focal_px(double height_px) const {
  return isOrthographic() ? height_px / height : 0.5 * height_px / std::tan(glm::radians(fov_deg) / 2);
}

DVec3 Camera::towardsViewer(const DVec3& position) const {
  return isOrthographic() ? -axes().forward : glm::normalize(eye - position);
}

DVec3 Camera::unproject(const DVec2& place_px, double depth, const DVec2& size_px) const {
  const Axes a = axes();
  const DVec2 offset = pixelSize(depth, size_px.y) * (place_px - center * size_px);
  return eye + depth * a.forward + offset.x * a.right - offset.y * a.up;
}

std::optional<DVec3> Camera::project(const DVec3& position, const DVec2& size_px) const {
  const Axes a = axes();
  const DVec3 p = position - eye;
  const double depth = glm::dot(p, a.forward);
  if (depth < nearDepth) return std::nullopt;
  const double scale = focal_px(size_px.y) / divisorAt(depth);
  const DVec2 middle_px = center * size_px;
  return DVec3(middle_px.x + scale * glm::dot(p, a.right), middle_px.y - scale * glm::dot(p, a.up), depth);
}

Mat4 Camera::view() const {
  const Axes a = axes();
  const DVec3 rows[3] = {a.right, a.up, -a.forward};
  Mat4 m(1);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[column][row] = static_cast<float>(rows[row][column]);
    m[3][row] = static_cast<float>(-glm::dot(rows[row], eye));
  }
  return m;
}

Mat4 Camera::projection(double aspect) const {
  const double f = focal_px(2.0);
  const double range = farDepth - nearDepth;
  Mat4 m(0);
  m[0][0] = static_cast<float>(f / aspect);
  m[1][1] = static_cast<float>(-f);
  if (isOrthographic()) {
    m[2][2] = static_cast<float>(-1 / range);
    m[3] = {static_cast<float>(2 * center.x - 1), static_cast<float>(2 * center.y - 1),
            static_cast<float>(-nearDepth / range), 1};
    return m;
  }
  m[2][0] = static_cast<float>(1 - 2 * center.x);  // depth is the negative of z
  m[2][1] = static_cast<float>(1 - 2 * center.y);
  m[2][2] = static_cast<float>(-farDepth / range);
  m[2][3] = -1;
  m[3][2] = static_cast<float>(-farDepth * nearDepth / range);
  return m;
}

std::string textOf(const Camera& camera, const DVec3& origin) {
  const auto vector = [](const DVec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
  return fmt::format("eye={} target={} up={} fov={}", vector(camera.eye + origin), vector(camera.target + origin),
                     vector(camera.up), camera.fov_deg) +
         (camera.isOrthographic() ? fmt::format(" ortho={}", camera.height) : "");
}

Camera cameraOf(std::string_view text, const DVec3& origin, const Camera& present) {
  const CameraRequest request = CameraRequest::parse(text);
  if (!request.eye || !request.target || !request.up)
    throw UsageError("camera: '{}' does not have eye, target and up", text);
  Camera camera = present;
  camera.eye = *request.eye - origin;
  camera.target = *request.target - origin;
  camera.up = *request.up;
  camera.fov_deg = request.fov_deg.value_or(present.fov_deg);
  camera.height = request.ortho.value_or(0);
  const DVec3 direction = camera.target - camera.eye;
  if (glm::length(direction) == 0 || glm::length(camera.up) == 0 || parallel(camera.up, direction))
    throw UsageError("camera: '{}' has no direction of view, or up is along it", text);
  return camera;
}

DVec2 depthRangeOf(const Camera& camera, const Bounds& bounds) {
  const DVec3 forward = camera.axes().forward;
  DVec2 range(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
  for (const DVec3& corner : cornersOf(bounds)) {
    const double depth = glm::dot(corner - camera.eye, forward);
    range = {std::min(range.x, depth), std::max(range.y, depth)};
  }
  return range;
}

}  // namespace palpate
