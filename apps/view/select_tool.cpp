#include "apps/view/select_tool.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/select/screen_select.hpp"
#include "engine/select/surface_select.hpp"

namespace palpate {

namespace {

constexpr double kApart_px = 2;  // of the positions of a lasso or a brush

/// The points of a model, and those that may be selected.
struct Selectable {
  std::span<const PointState> points;
  PointBits among;

  explicit Selectable(const WindowSession& session) : points(session.history().points()), among(selectable(session)) {}
};

// Noise scatters the points of the first surface behind the foremost of them.
double toleranceOf(const Model& model) { return model.spacing * (1 + 2 * std::min(model.noise, 0.25)); }

// Of the balls of a brush along a path.
std::vector<Vec3> centresAlong(std::span<const DVec2> path_px, double radius, const DepthPicture& picture) {
  constexpr double kApart = 0.2;  // of the balls, radii
  std::vector<Vec3> centres;
  const auto add = [&](const DVec2& place_px) {
    const double depth = picture.depthAt(place_px);
    if (!(depth > 0)) return;
    const Vec3 centre(picture.camera.unproject(place_px, depth, picture.size_px));
    if (centres.empty() || glm::distance(DVec3(centres.back()), DVec3(centre)) > kApart * radius)
      centres.push_back(centre);
  };
  add(path_px.front());
  for (std::size_t k = 1; k < path_px.size(); ++k) {
    const DVec2 from = path_px[k - 1], along = path_px[k] - from;
    const int steps = std::max(1, static_cast<int>(glm::length(along) / kApart_px));
    for (int step = 1; step <= steps; ++step) add(from + double(step) / steps * along);
  }
  return centres;
}

// Of the class that the clicked point has, if the model has classes.
std::optional<PointBits> ofSameClass(const WindowSession& session, const Selectable& field, std::size_t clicked) {
  const auto number = session.attributes().fieldNamed("classification");
  const auto& extra = session.model().cloud.extra;
  const auto property = std::ranges::find(extra, "classification", &Attribute::name);
  if (!number && property == extra.end()) return std::nullopt;
  const Attribute& values = number ? session.attributes().fields()[*number].values : *property;
  const std::size_t bytes = sizeOf(values.type);
  const auto valueOf = [&](std::size_t point) {
    const std::size_t at = number ? point : static_cast<std::size_t>(field.points[point].parent);
    return std::span(values.data).subspan(at * bytes, bytes);
  };
  const auto wanted = valueOf(clicked);
  return PointBits::where(field.points.size(), 0,
                          [&](std::size_t i) { return field.among.test(i) && std::ranges::equal(valueOf(i), wanted); });
}

PointBits likeClicked(const SelectSettings& settings, SelectShape shape, const Pointed& at, const DVec2& place_px) {
  const WindowSession& session = *at.session;
  const Selectable field(session);
  const DepthPicture picture = at.surface().picture();
  const double depth = picture.depthAt(place_px);
  const auto clicked =
      depth > 0 ? nearestPoint(field.points, field.among, picture.camera.unproject(place_px, depth, picture.size_px))
                : std::nullopt;
  if (!clicked) throw Error("nothing is selected: the model is not under the cursor");
  const PointState& point = field.points[*clicked];
  if (shape == SelectShape::same) {
    if (auto same = ofSameClass(session, field, *clicked)) return *same;
    return pointsLike(field.points, field.among, point, {.normal_deg = {}, .color = settings.colorStep});
  }
  const Likeness likeness = settings.floodsByColor ? Likeness{.normal_deg = {}, .color = settings.colorStep}
                                                   : Likeness{.normal_deg = settings.angle_deg, .color = {}};
  constexpr double kReach = 2.5;  // between connected points, spacings
  PointBits seed(field.points.size());
  seed.set(*clicked);
  return connectedWith(field.points, pointsLike(field.points, field.among, point, likeness), seed,
                       kReach * std::max(session.model().spacing, session.model().wideSpacing));
}

}  // namespace

bool SelectTool::press(MouseButton button, const Keys& keys, const SelectSettings& settings, const Pointed& at) {
  if (stage_ == Stage::corners && button == MouseButton::right) {
    close(settings, at);
    return true;
  }
  if (button != MouseButton::left) return isDrawing();
  at.session->session().require(Action::select, "select");
  if (isVolume(settings.shape)) return volume_.press(settings.shape, cursor_px_, at);
  if (stage_ == Stage::corners)
    keys.alt ? takeBack() : path_px_.push_back(cursor_px_);
  else if (settings.shape == SelectShape::flood || settings.shape == SelectShape::same)
    select(*at.session, likeClicked(settings, settings.shape, at, cursor_px_), combineBy(keys.shift, keys.control));
  else
    begin(settings.shape == SelectShape::polygon ? Stage::corners : Stage::dragging, keys, settings);
  return true;
}

void SelectTool::begin(Stage stage, const Keys& keys, const SelectSettings& settings) {
  stage_ = stage;
  how_ = combineBy(keys.shift, keys.control);
  shape_ = settings.shape;
  path_px_ = {cursor_px_};
  moves_ = false;
}

void SelectTool::moveTo(const DVec2& place_px) {
  const DVec2 way_px = place_px - std::exchange(cursor_px_, place_px);
  volume_.moveTo(place_px);
  if (stage_ == Stage::idle) return;
  if (moves_)
    for (DVec2& each : path_px_) each += way_px;
  else if (stage_ == Stage::dragging && shape_ != SelectShape::rectangle &&
           glm::distance(path_px_.back(), place_px) >= kApart_px)
    path_px_.push_back(place_px);
}

std::string SelectTool::release(MouseButton button, const SelectSettings& settings, const Pointed& at) {
  if (button != MouseButton::left) return {};
  if (stage_ == Stage::dragging) close(settings, at);
  return volume_.release(at);
}

void SelectTool::takeBack() {
  if (stage_ != Stage::corners) return;
  path_px_.pop_back();
  if (path_px_.empty()) stage_ = Stage::idle;
}

void SelectTool::carryOut(SelectCommand command, const SelectSettings& settings, const Pointed& at) {
  if (command == SelectCommand::closeOutline && stage_ == Stage::corners) close(settings, at);
  if (command == SelectCommand::takeBack) takeBack();
  if (command == SelectCommand::cancelOutline) {
    if (stage_ == Stage::idle) volume_.cancel();
    stage_ = Stage::idle;
  }
  if (command == SelectCommand::holdOutline) moves_ = stage_ != Stage::idle;
  if (command == SelectCommand::letOutlineGo) moves_ = false;
}

// A closed polygon ends at its last corner, and not at the cursor.
std::vector<DVec2> SelectTool::corners() const {
  if (shape_ != SelectShape::rectangle) return path_px_;
  const DVec2 from = path_px_.front(), to = cursor_px_;
  return {from, {to.x, from.y}, to, {from.x, to.y}};
}

PointBits SelectTool::found(const SelectSettings& settings, const Pointed& at) const {
  const WindowSession& session = *at.session;
  const Selectable field(session);
  const bool isBrush = isBall(shape_);
  const FoundSurface front = isBrush || !settings.through ? at.surface() : FoundSurface();
  const double radius = session.model().scale.toUnits(settings.brush_mm);
  const PointBits inside =
      isBrush ? pointsInBalls(field.points, field.among, centresAlong(path_px_, radius, front.picture()), radius)
              : pointsInOutline(field.points, field.among, ScreenOutline(corners()),
                                settings.through ? at.viewpoint.camera() : front.picture().camera, at.size_px);
  if (settings.through) return inside;
  return firstSurface(field.points, inside, front.picture(), toleranceOf(session.model()));
}

// More than before, or with Ctrl less.
void SelectTool::lockBrushed(const SelectSettings& settings, const Pointed& at) const {
  const PointBits inside = found(settings, at);
  const double radius = at.session->model().scale.toUnits(settings.brush_mm);
  const std::vector<std::uint8_t> under =
      weightsInBalls(at.session->history().points(), inside, centresAlong(path_px_, radius, at.surface().picture()),
                     radius, settings.falloff);
  std::vector<std::uint8_t> weights = at.session->session().lockWeights();
  for (std::size_t i = 0; i < weights.size(); ++i)
    weights[i] = how_ == Combine::remove ? std::min(weights[i], static_cast<std::uint8_t>(PointLock::kWhole - under[i]))
                                         : std::max(weights[i], under[i]);
  at.session->setLockWeights(weights);
}

void SelectTool::close(const SelectSettings& settings, const Pointed& at) {
  stage_ = Stage::idle;
  if (!at.session) return;
  if (shape_ == SelectShape::lock)
    lockBrushed(settings, at);
  else if (shape_ == SelectShape::label)
    remark_ = label(*at.session, found(settings, at), {settings.field.data(), settings.value.data()});
  else
    select(*at.session, found(settings, at), how_);
}

DrawnOutline SelectTool::drawn(const SelectSettings& settings, const Pointed& at) const {
  if (!at.session) return {};
  const bool isDrawing = stage_ != Stage::idle;
  const SelectShape shape = isDrawing ? shape_ : settings.shape;
  if (isBall(shape)) {
    const double depth = at.picked.depth > 0 ? at.picked.depth : at.viewpoint.targetDistance();
    const double radius = at.session->model().scale.toUnits(settings.brush_mm);
    DrawnOutline drawn{.ball_px = radius / at.viewpoint.camera().pixelSize(depth, at.size_px.y)};
    if (isDrawing) drawn.corners_px = path_px_;
    drawn.corners_px.push_back(cursor_px_);
    return drawn;
  }
  if (!isDrawing) return {};
  DrawnOutline drawn{.corners_px = corners(), .isClosed = shape != SelectShape::polygon};
  if (shape == SelectShape::polygon && !moves_) drawn.corners_px.push_back(cursor_px_);
  return drawn;
}

}  // namespace palpate
