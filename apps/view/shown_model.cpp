#include "apps/view/shown_model.hpp"

#include <algorithm>
#include <utility>

#include "apps/cli/picture.hpp"
#include "apps/cli/probe_overlays.hpp"
#include "apps/view/messages.hpp"
#include "engine/cloud/length_text.hpp"

namespace palpate {

namespace {

constexpr std::array<std::uint8_t, 3> kLightBackground{236, 238, 240};

FrameOptions frameOptions(const WindowSession& session, const ViewSettings& view, const ColoredField* field,
                          bool isSoftware, bool touched) {
  const Model& model = session.model();
  FrameOptions options = frameOptionsOf(model, view.upOf(model), view.color, field, view.light,
                                        {.isSoftware = isSoftware, .barePoints = false});
  if (!view.dark) options.background = kLightBackground;
  if (view.discRadius_mm > 0) options.splatRadius = options.particles.radius = model.scale.toUnits(view.discRadius_mm);
  const RecentTicks& history = session.recentTicks();
  if (touched && !history.rows().empty())
    options.overlays = overlaysOf(history.rows().back(), model.cloud.origin, session.longestSide(), session.heldTool());
  return options;
}

}  // namespace

void ShownModel::forget() {
  mesh_.clear();
  picture_.forget();
  lines_.forget();
  guides_.forget();
  field_.forget();
  edited_ = {};
  lockedPoints_ = 0;
  saidOfGaussians_ = saidOfBacks_ = false;
  madeBefore_ = picture_.made();
}

void ShownModel::follow(WindowSession& session, ViewSettings& view, const Measure& measure, Messages& messages) {
  edited_ = session.takeBatch();
  followLock(session);
  lines_.follow(session, view, measure);
  const Model& model = session.model();
  guides_.follow(model, view.upOf(model), view.unitOf(model), view.guides);
  const bool isSeen =
      picture_.made() > madeBefore_;  // the first picture of a model may take longer than a remark stays
  if (isSeen && !saidOfGaussians_ && drawsGaussians(view.light.gaussians, model.cloud)) {
    saidOfGaussians_ = true;
    messages.say(session.drawn().gaussians()->inWords());
  }
  if (isSeen && !std::exchange(saidOfBacks_, true))
    if (const std::string note = hiddenBacksNote(model, view.light); !note.empty()) messages.say(note);
  try {
    field_.follow(session, edited_, view);
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    view.color = {};
    messages.sayError(error.what());
  }
  if (!view.mesh) return mesh_.clear();
  try {
    if (session.config().moves()) throw Error("a moving model cannot be shown as triangles");
    if (!mesh_.follow(session, static_cast<std::uint32_t>(view.resolution), edited_, field(), view.color))
      messages.say("making the triangles");
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    view.mesh = false;
    mesh_.clear();
    messages.sayError(error.what());
  }
}

void ShownModel::followLock(WindowSession& session) {
  const LayerAttributes& attributes = session.attributes();
  if (!session.session().pointHistory()) return;
  const std::size_t points = session.history().points().size();
  const auto isOfLock = [&](const AttributeChange& change) { return attributes.isOfLock(change); };
  if (lockedPoints_ == points && std::ranges::none_of(edited_.attributes, isOfLock)) return;
  lockedPoints_ = points;
  const bool locks = !attributes.mask(MaskRole::locked).empty() || attributes.hasLockField(session.model().cloud);
  DrawnAttributes& drawn = session.drawn().attributes();
  if (locks || drawn.lock()) drawn.showLock(locks ? session.session().lockWeights() : std::vector<std::uint8_t>());
}

void ShownModel::takePick() {
  if (picture_.exists()) picture_.takePick();
}

void ShownModel::choosePace(double clock_s, bool inFull) {
  constexpr double kStill_s = 0.2;  // time without motion until full resolution
  if (picture_.hasMoved()) moved_s_ = clock_s;
  picture_.choosePace(inFull || clock_s - moved_s_ > kStill_s);
}

void ShownModel::fit(const UVec2& window_px, const ViewSettings& view) {
  picture_.fit(window_px, view.smoothOutlines ? 2 : 1);
}

void ShownModel::aim(const WindowSession& session, const Camera& camera, const ViewSettings& view, bool touched,
                     const UVec2& size_px, const DVec2& cursor_px) {
  FrameOptions options = frameOptions(session, view, field(), sight_.isCpu(), touched);
  options.lines = guides_.linesWith(lines_.lines(), camera, size_px);
  picture_.aim(session, mesh_, camera, options, cursor_px);
}

Image ShownModel::picture(WindowSession& session, Camera camera, const ViewSettings& view, bool touched,
                          const UVec2& size_px, const Measure& measure) const {
  camera.center = DVec2(0.5);
  FrameOptions options = frameOptions(session, view, field(), sight_.isCpu(), touched);
  options.tintsSelected = false;
  options.lines = guides_.guides().linesWith(*lines_.lines(), camera, size_px);
  const PictureSize size{size_px.x, size_px.y};
  if (view.scaleBar) options.overlays.scale = scaleBar(camera, size);
  Image image = picture_.forFile(session, mesh_, camera, options, size_px);
  const LengthUnit unit = view.unitOf(session.model());
  Annotations annotations{.legend = legend(session, view), .labels = guides_.guides().labelsIn(camera, size_px)};
  if (view.scaleBar) annotations.scale = lengthText(scaleBarLength(camera, size), unit);
  for (PictureLabel& label : measure.labelsIn(camera, size_px, unit, view.measures))
    annotations.labels.push_back(std::move(label));
  annotate(image, annotations);
  return image;
}

std::optional<Legend> ShownModel::legend(const WindowSession& session, const ViewSettings& view) const {
  if (field()) return field()->legend(view.color);
  if (view.color.source() != ColorSource::height) return std::nullopt;
  const Model& model = session.model();
  return heightLegend(model, view.upOf(model), view.unitOf(model), view.color.mapOf());
}

void ShownModel::record(CommandList& list, WindowSession& session, const UVec2& window_px) {
  picture_.record(list, session, mesh_);
  picture_.recordPick(list, DVec2(window_px));
}

}  // namespace palpate
