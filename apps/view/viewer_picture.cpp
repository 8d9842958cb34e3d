// The part of Viewer that makes pictures.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "apps/mesh_options.hpp"
#include "apps/picture.hpp"
#include "apps/probe_overlays.hpp"
#include "apps/view/viewer.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

namespace {

constexpr double kSlow_ms = 90;   // a picture that takes longer is drawn smaller while things move
constexpr double kStill_s = 0.4;  // without motion, and it is drawn in full
constexpr std::uint32_t kDark = 0xff241f1cu, kLight = 0xfff2f0eeu;  // RGBA8, red lowest: where no model is
constexpr std::array<std::uint8_t, 3> kLightBackground{236, 238, 240};

}  // namespace

FrameOptions Viewer::frameOptions() const {
  FrameOptions options;
  options.color = view_.color;
  if (!view_.dark) options.background = kLightBackground;
  const Model& model = session_->model();
  options.up = directionOf(up());
  options.shown = model.shown;
  options.splatRadius = loneDiscRadius(model);
  if (view_.discRadius_mm > 0) options.splatRadius = model.scale.toUnits(view_.discRadius_mm);
  const TickHistory& history = session_->history();
  if ((stylus_ || options_.session.device || session_->isPlaying()) && !history.rows().empty())
    options.overlays =
        overlaysOf(history.rows().back(), model.cloud.origin, session_->longestSide(), session_->brush());
  return options;
}

// The bar is drawn with the panels: a part of the picture would be as coarse as that is while something moves.
ViewStatus::ScaleBar Viewer::scaleOfPicture() const {
  const double length = scaleBarLength(camera_, pictureSize());
  const double depth = glm::distance(camera_.eye, camera_.target);
  return {.width_px = length * camera_.focal_px(pictureSize().height) / depth, .length = length};
}

void Viewer::updateMesh() {
  if (!view_.mesh) {
    mesh_.reset();
    announcesMesh_ = false;
    return;
  }
  const Stopwatch watch;
  try {
    const Model& model = session_->model();
    const auto lattice = static_cast<std::uint32_t>(view_.lattice);
    if (!mesh_ || meshLattice_ != lattice) {
      // A software driver holds the picture up for it: one that says so comes first.
      if (sight_.isCpu() && !std::exchange(announcesMesh_, true)) return say("making the triangles");
      announcesMesh_ = false;
      mesh_.reset();
      const MeshPlan plan = planMesh(session_->bounds(), model.spacing, {.lattice = lattice, .room = 0.2});
      const auto points = session_->journal().points();
      const std::uint64_t spare = std::max<std::uint64_t>(points.size() - model.cloud.size(), model.cloud.size() / 4);
      mesh_ = std::make_unique<MarchingCubes>(sight_, model.cloud, plan, static_cast<std::uint32_t>(spare), true);
      meshLattice_ = lattice;
      mesh_->build();
      if (session_->edits() > 0) mesh_->update(points);
    } else if (!edited_.points.empty()) {
      mesh_->update(edited_.points);
    } else {
      return;
    }
    ++meshes_;
    meshTime_ms_ = watch.elapsed_us() * 1e-3;
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    view_.mesh = false;
    mesh_.reset();
    say(error.what());
  }
}

void Viewer::recordScene(CommandList& list) {
  camera_.setDepthRange(session_->bounds());
  const bool drawsMesh = mesh_ && mesh_->triangleCount() > 0;
  const Scene scene{camera_, frameOptions(), session_->edits(), drawsMesh ? meshes_ : 0};
  if (scene_ == scene) return;
  scene_ = scene;
  madeScene_ = true;
  ++scenes_;
  if (drawsMesh) {
    const DrawnMesh drawn{.vertices = mesh_->vertices().address(),
                          .triangles = mesh_->triangles().address(),
                          .triangleCount = mesh_->triangleCount(),
                          .hasColors = mesh_->hasColors(),
                          .bounds = session_->bounds(),
                          .cell = static_cast<double>(mesh_->plan().lattice.cell)};
    frame_->record(list, drawn, camera_, scene.options);
  } else {
    frame_->record(list, session_->drawn(), camera_, scene.options);
  }
}

void Viewer::recordPick(CommandList& list) {
  const UVec2 at(glm::clamp(glm::floor(cursor_px_), DVec2(0), size() - 1.0) / double(shrink_));
  asked_ = {.place_px = cursor_px_};
  list.copy(frame_->depthImage(), pick_, sizeof(float), sizeof(float) * (std::uint64_t{at.y} * frame_->width() + at.x));
}

void Viewer::takePick() {
  picked_ = asked_;
  picked_.depth = static_cast<double>(pick_.mapped<float>()[0]);
}

// Of the panels, in a window that has another size now: curves that would lie on the model close.
void Viewer::keepClear(const UVec2& before_px, const UVec2& now_px) {
  const double roomy_px = panels_.roomyWidth_px();
  if (before_px.x >= roomy_px && now_px.x < roomy_px) view_.plots = false;
  if (now_px.x > 0) camera_.center.x = freeCenter(now_px.x);
}

// Of what the panels leave free, as a share of the width.
double Viewer::freeCenter(double width_px) const {
  const DVec2 free = panels_.freeWidth_px(view_, width_px);
  return 0.5 * (free.x + free.y) / width_px;
}

void Viewer::draw(double dt_s) {
  const UVec2 window_px = window_.size_px();
  if (window_px != presenter_->size_px()) keepClear(presenter_->size_px(), window_px);
  if (window_px != presenter_->size_px() || view_.waitsForDisplay != presenter_->waitsForDisplay())
    presenter_->change(window_px, view_.waitsForDisplay);
  const UVec2 size_px = presenter_->size_px();
  wasShown_ = true;
  if (size_px.x == 0 || size_px.y == 0) return;

  gui_.begin(size_px, dt_s);
  const ViewWishes wishes = panels_.draw(status(), view_, tool_, feel_, forcesOn_);
  const PanelShapes shapes = gui_.end();
  obey(wishes);
  applySettings();
  // What the last picture was made of is written anew from here on.
  presenter_->waitForLast();
  if (frame_ && pictures_ > 0 && session_) takePick();
  if (session_) session_->drawn().closeSurface();

  const bool moves = drag_ != Drag::none || (session_ && !edited_.points.empty()) || stylus_;
  if (moves) moved_s_ = clock_s();
  // By a clock of its own a script sees the same pictures on any machine.
  const bool still = ownClock() || clock_s() - moved_s_ > kStill_s;
  if (still)
    shrink_ = 1;
  else if (scene_ms_ > kSlow_ms && shrink_ < 3)
    ++shrink_;
  const UVec2 picture_px = (size_px + (shrink_ - 1)) / shrink_;
  const std::uint32_t supersample = view_.smoothOutlines ? 2 : 1;
  if (session_ && (!frame_ || frame_->width() != picture_px.x || frame_->height() != picture_px.y ||
                   frameSupersample_ != supersample)) {
    frame_.reset();
    scene_.reset();
    frame_ = std::make_unique<Frame>(sight_, picture_px.x, picture_px.y, supersample);
    frameSupersample_ = supersample;
  }
  const std::uint64_t bytes = std::uint64_t{4} * size_px.x * size_px.y;
  if (shown_.bytes() != bytes) shown_ = Buffer(sight_, bytes, Memory::device, "shown");
  const bool hasPicture = session_ && frame_;
  {
    // A software driver hands the picture to the display in one long call; the servo thread may need its core
    // meanwhile.
    const AwayFromCore away(session_ && sight_.isCpu() ? session_->servoCore() : -1);
    wasShown_ = presenter_->show(list_, shown_, [&] {
      if (hasPicture) {
        recordScene(list_);
        recordPick(list_);
      }
      panelPass_.record(list_, hasPicture ? &frame_->image() : nullptr, shrink_, shapes, size_px, shown_,
                        view_.dark ? kDark : kLight, presenter_->blueFirst());
    });
  }
  if (!pendingScreenshot_.empty()) {
    const std::string file = std::exchange(pendingScreenshot_, {});
    tryTo([&] {
      writeShown(file, size_px);
      if (tellsOfScreenshot_) say("the picture is in " + file);
    });
  }
}

void Viewer::writeShown(const std::string& file, const UVec2& size_px) {
  presenter_->waitForLast();
  Image image{size_px.x, size_px.y, {}};
  image.rgba.resize(std::size_t{size_px.x} * size_px.y);
  const Buffer staging(sight_, shown_.bytes(), Memory::readback, "screenshot");
  CommandList list(sight_, sight_.window(), "screenshot");
  list.begin();
  list.copy(shown_, staging, shown_.bytes());
  list.end();
  sight_.window().run(list);
  std::memcpy(image.rgba.data(), staging.mapped<std::byte>().data(), shown_.bytes());
  if (presenter_->blueFirst())
    for (auto& pixel : image.rgba) std::swap(pixel[0], pixel[2]);
  writeImage(file, image);
}

void Viewer::screenshot(const std::string& file) {
  tellsOfScreenshot_ = file.empty();  // a script knows where it is
  if (!file.empty()) {
    pendingScreenshot_ = file;
    return;
  }
  pendingScreenshot_ = freeName("", "png");
}

std::string Viewer::freeName(const std::string& what, const std::string& ending) const {
  const std::string stem = session_ ? std::filesystem::path(session_->file()).stem().string() : std::string("palpate");
  const std::filesystem::path folder = std::filesystem::current_path();
  for (int number = 1;; ++number) {
    const std::filesystem::path file = folder / fmt::format("{}{}-{}.{}", stem, what, number, ending);
    if (!std::filesystem::exists(file)) return file.string();
  }
}

ViewStatus Viewer::status() {
  ViewStatus status;
  status.session = session_.get();
  if (loader_.isLoading()) {
    status.loading = loader_.progress();
    status.loadingWhat = loader_.stage();
  }
  for (const Message& message : messages_) status.messages.push_back(message.text);
  status.models = options_.models;
  status.recent = recent_.files();
  if (session_) status.model = session_->file();
  if (session_ && view_.scaleBar && presenter_->size_px().x > 0) status.scaleBar = scaleOfPicture();
  if (session_) status.upright = session_->model().upright;
  status.unit = unit();
  if (session_ && view_.color == ColorBy::height) status.heights = heightsOf(session_->model(), up());
  status.asksAboutChanges = asksAboutChanges();
  status.saveQuestion = saveQuestion_;
  status.saveFile = saveFile_;
  status.stylus = stylus_;
  status.device = options_.session.deviceFacts.model;
  status.gpu = sight_.name();
  status.meshTime_ms = meshTime_ms_;
  status.meshTriangles = mesh_ ? mesh_->triangleCount() : 0;
  status.pictures_ms = &pictures_ms_;
  status.fps = fps_;
  if (pictures_ > 0 && presenter_->size_px().x > 0) {
    presenter_->waitForLast();
    if (std::exchange(passesAreNew_, false)) passes_ = list_.passes();
    status.passes = passes_;
  }
  return status;
}

}  // namespace palpate
