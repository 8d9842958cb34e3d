// Hands on a soft body: they feel the ordinary surface of its points, and press on it.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/shape_strokes.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/touch/contact_keeper.hpp"
#include "engine/touch/probe_group.hpp"
#include "engine/touch/soft_source.hpp"

namespace palpate {

struct SoftTouchOptions {
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);  ///< one for each hand, model units
  double friction = 0;                                       ///< of the surface that is felt
  std::optional<BrushOptions> brush;                         ///< of the first hand, model units
  std::string bodyMachine;                                   ///< that moves the body, where it is another one
};

/// Stands before the back end that feels the points of a SoftSource: it tells the source where hands were and are, so
/// that the body is pressed by the spring and damper that each hand feels. Where an answer is of points that are
/// older than the tick, as against the clock, they are where they would have gone by themselves had the hand gone
/// straight on; by what the hand has gone deeper than that the surface gives way, with its compliance. A brush
/// changes the shape in which the body rests (soft_brush.hpp), which no journal of points knows of: its strokes are
/// taken back as those of a shape.
class SoftTouch final : public TouchBackend, private ShapeStrokes {
 public:
  /// `surface` feels the points of `source`, which it has as its own.
  SoftTouch(std::unique_ptr<SoftSource> source, std::unique_ptr<TouchBackend> surface, const SoftTouchOptions& options);

  std::size_t hands() const noexcept override { return surface_->hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void prepare() noexcept override { surface_->prepare(); }
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return hands_[hand].points; }
  void resetHand(std::size_t hand) noexcept override;
  /// Throws Error where the simulation has failed, too.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override { return surface_->readBack(cloud); }
  bool takeFrame(CloudFrame& frame) override { return surface_->takeFrame(frame); }
  FramePipeline* framesOn(const Device& sight) override { return surface_->framesOn(sight); }
  SimulationControl* simulation() override { return source_.get(); }
  void setRealtime(bool realtime) override { source_->setLeavesOut(realtime); }
  ShapeStrokes* shapeStrokes() override { return this; }
  const ShapeStrokes* shapeStrokes() const override { return this; }
  std::optional<PointsTime> pointsTime() const noexcept override { return surface_->pointsTime(); }
  void setSprings(std::span<const HandSpring> springs) override;

  bool keepsEdits() const override { return true; }
  void keepEdits() override {}
  void takeEdits(EditBatch&) override {}
  EditScope editScope() const override { return {.edits = false, .paints = false, .newPoints = 0}; }
  /// Throws UsageError for one that does not change the shape of a soft body.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void setContact(SurfaceKind surface, double friction, std::string_view method) override;

  std::string machine() const override {
    return bodyMachine_.empty() ? surface_->machine() : surface_->machine() + "; the body on " + bodyMachine_;
  }
  double buildTime_us() const override { return surface_->buildTime_us(); }
  const std::vector<double>& editTimes_us() const override { return surface_->editTimes_us(); }
  std::span<const double> bridgeTimes_us() const override { return surface_->bridgeTimes_us(); }
  std::optional<double> firstEditTime_s() const override { return std::nullopt; }
  const TouchShortfalls& shortfalls() const override { return surface_->shortfalls(); }
  IndexWork indexWork() const override { return surface_->indexWork(); }
  BackendMemory memory() const override { return surface_->memory(); }
  std::vector<PassRecord> passes() const override { return surface_->passes(); }
  double cell() const override { return surface_->cell(); }

 private:
  static constexpr std::size_t kRemembered = 64;  // ticks
  struct Hand {
    ProbeGroup probes;  // for the places of its points alone
    HandSpring spring;
    std::vector<PointContact> points;  // as it gets them
    std::array<DVec3, kRemembered> hips{};
    std::vector<ContactKeeper> keepers;  // of the hand, or of each point of its tool
    std::vector<Contact> contacts;       // as they keep them
  };
  void keep(std::span<const Pose> poses, std::span<const Contact> answers);
  Contact keptBy(ContactKeeper& keeper, const Contact& felt, const PressedPlace& pressed,
                 const ContactKeeper::Tick& tick);
  // `isThere`: the surface is known to be that of this time.
  void lookAtScene(double time_s, bool isThere);
  void tell(std::span<const Pose> poses);
  void remember(std::span<const Pose> poses, std::span<const Contact> answers);
  void answer(std::span<const Pose> poses, std::span<const Contact> answers);
  void rememberBrush(const Pose& pose, const Contact& answer);
  bool undo() override { return turned(source_->undo()); }
  bool redo() override { return turned(source_->redo()); }
  StrokeCounts counts() const override { return source_->strokes(); }
  bool turned(bool done);
  // What a hand has gone from where it would be had it gone straight on since the points were true.
  DVec3 strayed(const Hand& hand, const Pose& pose, double age_s) const;
  DVec3 hipAt(const Hand& hand, double time_s) const;
  Contact givenWay(Contact contact, const DVec3& strayed, double share) const;

  std::unique_ptr<SoftSource> source_;
  std::unique_ptr<TouchBackend> surface_;  // goes before the source that it feels
  std::string bodyMachine_;
  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  std::vector<Pose> poses_;  // of the last question
  SurfaceQuestion question_;
  PressedPlaces pressed_;                      // the latest
  std::array<double, kRemembered> times_s_{};  // of the ticks that are remembered, in a ring
  std::size_t ticks_ = 0;
  std::uint32_t beginnings_ = 0;  // of the scene, as far as hands know
  bool isHeld_ = false;
  bool isQuiet_ = false;  // hands feel nothing
  double quietUntil_s_ = 0;
};

}  // namespace palpate
