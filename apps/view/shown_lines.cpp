#include "apps/view/shown_lines.hpp"

#include "apps/cli/model_lines.hpp"
#include "haptics/session/session_setup.hpp"

namespace palpate {

namespace {

constexpr std::array<std::uint8_t, 3> kWayColor{70, 205, 130}, kMeasureColor{255, 70, 190};
constexpr double kMark = 0.02;  // half the width of the cross at a picked position, in longest sides
constexpr double kMeasureWidth_px = 2.5;
constexpr std::array<std::uint8_t, 3> kMirrorColor{255, 190, 80};
constexpr double kMirror = 0.6;   // half the side of the square that shows the plane of symmetry, in longest sides
constexpr double kStylus = 0.12;  // length of another hand's stylus, in longest sides
constexpr double kBall = 0.012;   // half the size of the octahedron at its end, in longest sides
constexpr double kStylusWidth_px = 3;
constexpr double kOnlooker = 0.08;           // length of the pyramid of another participant's camera, in longest sides
constexpr std::size_t kLongestWay = 20'000;  // positions; beyond that the older half is removed

void addMeasure(std::vector<SpaceLine>& lines, const Measure& measure, bool measures, double longestSide) {
  const auto add = [&](const DVec3& from, const DVec3& to) {
    lines.push_back({.from = from, .to = to, .color = kMeasureColor, .width_px = kMeasureWidth_px});
  };
  for (const auto& [place, resolution] : measure.picked())
    for (int axis = 0; axis < 3; ++axis) {
      DVec3 half(0);
      half[axis] = kMark * longestSide;
      add(place - half, place + half);
    }
  for (const MeasuredDistance& distance : measure.shown(measures)) add(distance.ends[0].place, distance.ends[1].place);
}

// A square around the middle of the model, with its middle lines.
void addMirror(std::vector<SpaceLine>& lines, const MirrorPlane& plane, const Model& model) {
  const Bounds bounds = model.shownBounds();
  const double half = kMirror * bounds.longestSide();
  const DVec3 middle = bounds.center() - (glm::dot(plane.normal, bounds.center()) - plane.height) * plane.normal;
  const Frame3 frame = frameAround(plane.normal);
  const auto at = [&](double u, double v) { return middle + half * (u * frame.u + v * frame.v); };
  for (const double side : {-1.0, 0.0, 1.0}) {
    lines.push_back({.from = at(side, -1), .to = at(side, 1), .color = kMirrorColor});
    lines.push_back({.from = at(-1, side), .to = at(1, side), .color = kMirrorColor});
  }
}

// A stylus at the proxy on the surface, and an octahedron at the HIP.
void addHand(std::vector<SpaceLine>& lines, const SeenHand& hand, const DVec3& origin, const DVec3& up,
             double longestSide) {
  const DVec3 at = hand.place.position - origin, held = hand.place.proxy - origin;
  const auto add = [&](const DVec3& from, const DVec3& to) {
    lines.push_back({.from = from, .to = to, .color = colorOfHand(hand.number), .width_px = kStylusWidth_px});
  };
  const DVec3 out = held - at;
  const double pressed = glm::length(out);
  const DVec3 along = pressed > 1e-9 * longestSide ? out / pressed : up;
  add(held, held + kStylus * longestSide * along);
  add(at, held);
  std::array<DVec3, 6> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (int end = 0; end < 2; ++end) {
      DVec3 offset(0);
      offset[axis] = (end ? 1 : -1) * kBall * longestSide;
      corners[2 * static_cast<std::size_t>(axis) + static_cast<std::size_t>(end)] = at + offset;
    }
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j)
      if (i / 2 != j / 2) add(corners[i], corners[j]);
}

}  // namespace

std::array<std::uint8_t, 3> colorOfHand(std::uint32_t number) {
  constexpr std::array<std::array<std::uint8_t, 3>, 6> kColors{
      {{255, 140, 20}, {40, 160, 255}, {190, 90, 255}, {255, 80, 90}, {20, 190, 160}, {235, 200, 40}}};
  return kColors[number % kColors.size()];
}

void ShownLines::followCamera(const WindowSession& session) {
  const auto view = session.session().playedView();
  if (!view || (played_ && played_->number == view->number)) return;
  if (played_ && view->number < played_->number) way_.clear();  // the recording restarted
  if (way_.size() >= kLongestWay) way_.erase(way_.begin(), way_.begin() + kLongestWay / 2);
  played_ = view;
  way_.push_back(view->frustum.centre);
}

void ShownLines::addCameras(const WindowSession& session, std::vector<SpaceLine>& lines) {
  const Model& model = session.model();
  if (!(length_ > 0)) length_ = frustumLength(model);
  const std::span<const CameraFrustum> shown =
      played_ ? std::span<const CameraFrustum>(&played_->frustum, 1) : std::span<const CameraFrustum>(model.cameras);
  cameras_ = shown.size();
  for (const CameraFrustum& camera : shown) addFrustum(lines, camera, model.cloud.origin, length_);
  for (std::size_t k = 1; k < way_.size(); ++k)
    lines.push_back({.from = way_[k - 1] - model.cloud.origin, .to = way_[k] - model.cloud.origin, .color = kWayColor});
}

void ShownLines::follow(const WindowSession& session, const ViewSettings& view, const Measure& measure) {
  followCamera(session);
  const SharedPresence* const presence = session.session().presence();
  const std::vector<SeenHand> others = presence ? presence->hands() : std::vector<SeenHand>();
  const std::vector<SeenCamera> onlookers = presence ? presence->cameras() : std::vector<SeenCamera>();
  MadeOf madeOf{.cameras = view.cameras,
                .frame = played_ ? std::optional(played_->number) : std::nullopt,
                .measure = measure.version(),
                .measures = view.measures,
                .symmetry = session.config().brush ? session.config().brush->symmetry : std::string(),
                .others = {},
                .onlookers = {}};
  for (const SeenHand& hand : others) madeOf.others.push_back(hand.place);
  for (const SeenCamera& camera : onlookers) madeOf.onlookers.push_back(camera.place);
  if (madeOf_ == madeOf) return;
  madeOf_ = std::move(madeOf);
  auto lines = std::make_shared<std::vector<SpaceLine>>();
  cameras_ = 0;
  addContainer(*lines, session.model());
  if (view.cameras) addCameras(session, *lines);
  if (session.config().brush)
    if (const auto plane = symmetryOf(*session.config().brush, session.model()))
      addMirror(*lines, *plane, session.model());
  addMeasure(*lines, measure, view.measures, session.longestSide());
  const DVec3 up = directionOf(view.upOf(session.model()));
  for (const SeenHand& hand : others) addHand(*lines, hand, session.model().cloud.origin, up, session.longestSide());
  for (const SeenCamera& camera : onlookers)
    addFrustum(*lines, frustumOf(camera.place), session.model().cloud.origin, kOnlooker * session.longestSide(),
               colorOfHand(camera.number));
  lines_ = std::move(lines);
}

}  // namespace palpate
