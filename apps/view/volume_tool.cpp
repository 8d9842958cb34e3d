#include "apps/view/volume_tool.hpp"

#include <charconv>
#include <numbers>
#include <utility>

#include "apps/cli/context.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kPlaced = 0.1;   // half of a box or a ball that a click places, of the model's longest side
constexpr double kOfPlane = 0.4;  // half of the square that shows a plane
constexpr double kDragged_px = 3;

Volume::Kind kindOf(SelectShape shape) {
  return shape == SelectShape::ball    ? Volume::Kind::ball
         : shape == SelectShape::plane ? Volume::Kind::plane
                                       : Volume::Kind::box;
}

// Rotates the z axis to a direction.
DQuat rotationTo(const DVec3& direction) {
  const DVec3 to = glm::normalize(direction);
  if (to.z < -1 + 1e-12) return {0, 1, 0, 0};
  return glm::normalize(DQuat(1 + to.z, glm::cross(DVec3(0, 0, 1), to)));
}

double numberIn(const std::string& text, const char* name) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end) throw UsageError("{}: '{}' is not a number", name, text);
  return value;
}

std::string vectorText(const DVec3& v, double step) {
  return fmt::format("{},{},{}", coordinateText(v.x, step), coordinateText(v.y, step), coordinateText(v.z, step));
}

// A step of the coordinates of the file that is finer than the numbers' use.
double stepOf(const Volume& volume) { return 1e-4 * std::max({volume.half.x, volume.half.y, volume.half.z}); }

std::string remarkOfMoved(std::size_t points) {
  return fmt::format("{} moved; Ctrl+Z moves {} back", counted(points, "point"), points == 1 ? "it" : "them");
}

std::string numbersOf(const Volume& volume, const DVec3& origin) {
  const DVec3 centre = origin + volume.centre;
  const double step = stepOf(volume);
  if (volume.kind == Volume::Kind::ball) return vectorText(centre, step) + ':' + coordinateText(volume.half.x, step);
  if (volume.kind == Volume::Kind::plane) return vectorText(centre, step) + ':' + vectorText(volume.axis(2), 1e-4);
  if (volume.rotation != DQuat(1, 0, 0, 0)) return {};
  return vectorText(centre - volume.half, step) + ':' + vectorText(centre + volume.half, step);
}

}  // namespace

bool isVolume(SelectShape shape) { return shape >= SelectShape::box; }

Volume VolumeTool::present(const Pointed& at) const {
  if (isPlacing_ && shape_ != SelectShape::plane) {
    Volume placed = *volume_;
    const Camera& camera = at.viewpoint.camera();
    const auto centre_px = camera.project(placed.centre, at.size_px);
    if (centre_px && glm::distance(cursor_px_, pressed_px_) > kDragged_px)
      placed.half = DVec3(glm::distance(camera.unproject(cursor_px_, centre_px->z, at.size_px),
                                        camera.unproject(pressed_px_, centre_px->z, at.size_px)));
    return placed;
  }
  return dragged_ ? handled().dragged(*dragged_, at.viewpoint.camera(), at.size_px, pressed_px_, cursor_px_) : *volume_;
}

// The box of the selected points follows them; a volume belongs to one model, and to one shape.
void VolumeTool::follow(SelectShape shape, const Pointed& at) {
  if (isDragging()) return;
  if (std::exchange(session_, at.session) != at.session || std::exchange(shape_, shape) != shape) {
    volume_.reset();
    moved_ = {};
  }
  if (shape != SelectShape::move || !at.session) return;
  const PointSet& selected = at.session->attributes().mask(MaskRole::selected);
  const std::uint64_t version = at.session->edits();
  if (volume_ && version == version_ && selected == moved_) return;
  volume_.reset();
  version_ = version;
  moved_ = selected;
  if (selected.empty()) return;
  const PointBits points = changeable(*at.session);
  if (points.count() > 0) volume_ = boxAround(at.session->history().points(), points);
}

bool VolumeTool::press(SelectShape shape, const DVec2& cursor_px, const Pointed& at) {
  cursor_px_ = pressed_px_ = cursor_px;
  follow(shape, at);
  if (volume_) {
    dragged_ = handled().handleAt(cursor_px, at.viewpoint.camera(), at.size_px);
    return dragged_.has_value();
  }
  if (shape == SelectShape::move) throw Error("select the points to be moved first, for example with R");
  const auto place = at.viewpoint.placeAt(cursor_px, at.picked.depth, at.size_px);
  if (!place) return false;
  const double side = at.session->longestSide();
  volume_ = Volume{.kind = kindOf(shape),
                   .centre = *place,
                   .half = DVec3((shape == SelectShape::plane ? kOfPlane : kPlaced) * (side > 0 ? side : 1))};
  // A plane lies level at first, with what is above it on its side.
  if (shape == SelectShape::plane) volume_->rotation = rotationTo(glm::normalize(at.viewpoint.camera().up));
  isPlacing_ = true;
  return true;
}

std::string VolumeTool::release(const Pointed& at) {
  if (!isDragging()) return {};
  const Volume before = *volume_;
  volume_ = present(at);
  isPlacing_ = false;
  const bool isDragged = std::exchange(dragged_, std::nullopt).has_value() && cursor_px_ != pressed_px_;
  if (shape_ != SelectShape::move || !isDragged) return {};
  const DQuat rotation = glm::normalize(volume_->rotation * glm::conjugate(before.rotation));
  const double had = std::max({before.half.x, before.half.y, before.half.z});
  const double scale = had > 0 ? std::max({volume_->half.x, volume_->half.y, volume_->half.z}) / had : 1;
  const bool isRotated = volume_->rotation != before.rotation;
  moveChangeable(*at.session, MovePoints::about(before.centre, isRotated ? rotation : DQuat(1, 0, 0, 0), scale,
                                                volume_->centre - before.centre));
  version_ = at.session->edits();  // the box has moved with its points, and keeps its axes
  return remarkOfMoved(changeable(*at.session).count());
}

void VolumeTool::endDrag() {
  if (std::exchange(isPlacing_, false)) volume_.reset();
  dragged_.reset();
}

void VolumeTool::cancel() {
  if (!isDragging()) volume_.reset();
  endDrag();
}

void VolumeTool::select(SelectShape shape, Combine how, const Pointed& at) {
  follow(shape, at);
  if (shape_ == SelectShape::move) return;
  if (!volume_) throw Error("there is no {}: click the model to place one", nameOf(kSelectShapes, shape));
  palpate::select(*at.session, pointsIn(at.session->history().points(), selectable(*at.session), *volume_), how);
}

void VolumeTool::flip() {
  if (volume_ && shape_ == SelectShape::plane) volume_->rotation = volume_->rotation * DQuat(0, 1, 0, 0);
}

void VolumeTool::set(SelectShape shape, const std::string& typed, const Pointed& at) {
  if (!isVolume(shape) || shape == SelectShape::move) throw Error("choose box, ball or plane first");
  std::string numbers = typed;
  std::erase(numbers, ' ');
  endDrag();
  follow(shape, at);
  const std::string name(nameOf(kSelectShapes, shape));
  const std::size_t colon = numbers.find(':');
  if (colon == std::string::npos)
    throw UsageError("{}: '{}' lacks a colon: {}", name, numbers,
                     shape == SelectShape::ball    ? "type centre and radius, x,y,z:r"
                     : shape == SelectShape::plane ? "type a position and a direction, x,y,z:x,y,z"
                                                   : "type two corners, x,y,z:x,y,z");
  const DVec3 first = parseVec3(numbers.substr(0, colon), name), origin = at.session->model().cloud.origin;
  const std::string second = numbers.substr(colon + 1);
  Volume volume{.kind = kindOf(shape), .centre = first - origin};
  if (shape == SelectShape::ball) {
    volume.half = DVec3(numberIn(second, "radius"));
    if (!(volume.half.x > 0) || !isFinite(volume.half))
      throw UsageError("radius: '{}' is not a positive number", second);
  } else if (shape == SelectShape::plane) {
    const DVec3 direction = parseVec3(second, name);
    if (!(glm::length(direction) > 0)) throw UsageError("{}: a direction of length 0 is none", name);
    volume.rotation = rotationTo(direction);
    volume.half = DVec3(kOfPlane * at.session->longestSide());
  } else {
    const DVec3 other = parseVec3(second, name) - origin;
    volume = {.centre = 0.5 * (volume.centre + other), .half = 0.5 * glm::abs(other - volume.centre)};
  }
  volume_ = volume;
}

DrawnVolume VolumeTool::drawn(SelectShape shape, const Pointed& at) {
  follow(shape, at);
  DrawnVolume drawn;
  if (!volume_) return drawn;
  const Camera& camera = at.viewpoint.camera();
  const HandledVolume shown{present(at), shape_ == SelectShape::move};
  for (const auto& [from, to] : shown.edges(camera)) {
    const auto from_px = camera.project(from, at.size_px), to_px = camera.project(to, at.size_px);
    if (from_px && to_px) drawn.lines.push_back({DVec2(*from_px), DVec2(*to_px)});
  }
  const auto hot = isDragging() ? dragged_ : shown.handleAt(cursor_px_, camera, at.size_px);
  for (const VolumeHandle& handle : shown.handles())
    if (const auto place_px = camera.project(shown.placeOf(handle, camera), at.size_px))
      drawn.knobs.push_back({DVec2(*place_px), handle, hot == handle});
  drawn.numbers = numbersOf(shown.volume, at.session->model().cloud.origin);
  return drawn;
}

std::string moveSelection(WindowSession& session, const MoveSelection& numbers) {
  const DVec3 way = numbers.way.empty() ? DVec3(0) : parseVec3(numbers.way, "move");
  const DVec3 angles_deg = numbers.angles_deg.empty() ? DVec3(0) : parseVec3(numbers.angles_deg, "rotate");
  const double scale = numbers.factor.empty() ? 1 : numberIn(numbers.factor, "scale");
  DQuat rotation(1, 0, 0, 0);
  for (int k = 0; k < 3; ++k) {
    if (angles_deg[k] == 0) continue;
    DVec3 axis(0);
    axis[k] = 1;
    const double half = angles_deg[k] * std::numbers::pi / 360;
    rotation = glm::normalize(DQuat(std::cos(half), std::sin(half) * axis) * rotation);
  }
  const PointBits points = changeable(session);
  const DVec3 centre = boxAround(session.history().points(), points).centre;
  moveChangeable(session, MovePoints::about(centre, rotation, scale, way));
  return remarkOfMoved(points.count());
}

}  // namespace palpate
