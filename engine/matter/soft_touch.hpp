// Hands on a soft body: they feel the ordinary surface of its points, and press on it.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "engine/core/shape_strokes.hpp"
#include "engine/matter/contact_keeper.hpp"
#include "engine/matter/soft_source.hpp"
#include "engine/touch/probe_group.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

struct SoftTouchOptions {
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);  ///< one per hand, model units
  double friction = 0;                                       ///< friction of the felt surface
  std::optional<BrushOptions> brush;                         ///< of the first hand, model units
};

/// Base of SoftTouch, so that its back end is destroyed before the source that it feels.
struct HeldSoftSource {
  std::unique_ptr<SoftSource> source_;
};

/// Wraps the back end that feels the points of a SoftSource: it sends the source the hands' contacts and positions, so
/// that the body is pressed by the spring and damper that each hand feels. If an answer's points are older than the
/// tick, as against the clock, they are where they would have moved had the hand continued straight; the surface
/// yields, according to its compliance, to the hand's depth beyond that. A brush changes the rest shape of the body
/// (soft_source.hpp), whose strokes are changes of the shape, and not of points.
class SoftTouch final : private HeldSoftSource, public TouchDecorator, private ShapeStrokes {
 public:
  /// `surface` feels the points of `source`, as its own source.
  SoftTouch(std::unique_ptr<SoftSource> source, std::unique_ptr<TouchBackend> surface, const SoftTouchOptions& options);

  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return hands_[hand].points; }
  void resetHand(std::size_t hand) noexcept override;
  void begin(bool realtime, std::span<const HandSpring> springs) override;
  /// Also throws Error if the simulation has failed.
  void finish() override;
  void setContact(SurfaceKind surface, double friction, std::string_view method) override;
  /// Throws UsageError for a brush that does not change the shape of a soft body.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  EditStream* edits() noexcept override { return nullptr; }
  SimulationControl* simulation() noexcept override { return source_.get(); }
  ShapeStrokes* shapeStrokes() noexcept override { return this; }
  BackendReport report() const override;

 private:
  static constexpr std::size_t kRemembered = 64;  // number of ticks
  struct Hand {
    ProbeGroup probes;  // used only for the positions of its points
    HandSpring spring;
    std::vector<PointContact> points;  // as returned by points()
    std::array<DVec3, kRemembered> hips{};
    std::vector<ContactKeeper> keepers;  // for the hand, or for each point of its tool
    std::vector<Contact> contacts;       // contacts after the keepers
  };
  void keep(std::span<const Pose> poses, std::span<const Contact> answers);
  Contact keptBy(ContactKeeper& keeper, const Contact& felt, const PressedPlace& pressed,
                 const ContactKeeper::Tick& tick);
  // `isThere`: the surface is known to be of this time.
  void lookAtScene(double time_s, bool isThere);
  void tell(std::span<const Pose> poses);
  void remember(std::span<const Pose> poses, std::span<const Contact> answers);
  void answer(std::span<const Pose> poses, std::span<const Contact> answers);
  void rememberBrush(const Pose& pose, const Contact& answer);
  void take(std::vector<ShapeStroke>& strokes) override { source_->takeStrokes(strokes); }
  void exchange(ShapeStroke& stroke) override;
  // Deviation of a hand from straight motion since the time of the points.
  DVec3 strayed(const Hand& hand, const Pose& pose, double age_s) const;
  DVec3 hipAt(const Hand& hand, double time_s) const;
  Contact givenWay(Contact contact, const DVec3& strayed, double share) const;

  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  std::vector<Pose> poses_;  // poses of the last question
  SurfaceQuestion question_;
  PressedPlaces pressed_;                      // the latest positions
  std::array<double, kRemembered> times_s_{};  // times of the remembered ticks, in a ring
  std::size_t ticks_ = 0;
  std::uint32_t beginnings_ = 0;  // the scene's beginnings(), as known to the hands
  bool isPaused_ = false;
  bool isQuiet_ = false;  // hands feel nothing now
  double quietUntil_s_ = 0;
};

}  // namespace palpate
