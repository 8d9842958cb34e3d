// Where the tool is while a hand sculpts: the same for every back end, in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/core/brush.hpp"
#include "engine/core/contact_query.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

/// Sums over the points that a tool measures, of shaders/shared/brush.h. Whole numbers that may run over: what an edit
/// adds is their difference.
struct SurfaceMeasure {
  std::uint32_t weights = 0;
  std::array<std::uint32_t, 3> normals{};
  std::uint32_t heights = 0;

  void add(const shared::MeasuredPoint& point);
  friend SurfaceMeasure operator-(const SurfaceMeasure& a, const SurfaceMeasure& b);
};

/// One stroke after another. The tool is fixed to the hand: it follows the way of the HIP, no faster than the points
/// can yield, and goes on when the hand has left until it has gone all of it, so that the result does not depend on how
/// many edits a machine gets done. Its axis is the normal of the surface as the stroke found it, averaged over the
/// brush: never the way from HIP to proxy, since in a drag the proxy trails. While a hand withdraws nothing yields, but
/// to grab. One press of the button is a stroke, or one contact of a hand that always sculpts, with gaps of up to 0.3
/// s. Places are relative to the cloud's origin, model units. Allocates nothing.
class BrushStroke {
 public:
  using Tool = shared::BrushToolOf<double>;

  /// `support`: support radius, model units.
  explicit BrushStroke(double support) : support_(support) {}

  /// Another brush from now on. Ends the stroke.
  void setBrush(const BrushOptions& brush);
  /// An answer to a pose, whose HIP is at `hip`; the contact's proxy is `spring` from there. In order of time.
  void feel(const Contact& contact, const DVec3& hip, const DVec3& spring, bool sculpts, double time_s);
  /// Whether something of the way is left that the hand has gone.
  bool hasWay() const { return wayCount_ > 0; }
  /// The stroke goes no further: what is left of its way is forgotten.
  void end();
  /// The hand is put down elsewhere: the tool does not go through what lies between. What is left of its way is still
  /// gone.
  void lift();

  /// Whether a stroke is going on, or something of its way is left.
  bool isGoingOn() const { return open_ || hasWay(); }
  /// Whether an edit with next() would do anything.
  bool acts() const { return acts_ || hasWay(); }
  /// Takes the tool on along its way, for an edit at `time_s`. Where nothing acts the tool does not either.
  const Tool& next(double time_s);
  /// The tool of the last next().
  const Tool& tool() const { return tool_; }
  /// What the edit with that tool has measured.
  void note(const SurfaceMeasure& measure);

  std::uint32_t number() const { return number_; }

 private:
  static constexpr std::size_t kMaxWay = 1024;
  struct Place {
    DVec3 hip{0};
    bool jumps = false;  // nothing yielded on the way here, and then
    DVec3 outward{0};    // the surface lies so,
    DVec3 found{0};      // and here
  };

  void begin(const Place& place);
  void goOnTo(const Place& place);
  void advance(double most);
  double longestStep(double share) const;
  double found() const { return glm::dot(foundAt_ - place_, outward_); }
  std::uint32_t sampling() const;
  void placeTool();
  DVec3 held() const;

  double support_;
  BrushOptions brush_;
  std::uint32_t number_ = 0;
  bool open_ = false, acts_ = false, knowsLast_ = false, touched_ = false, isLifted_ = false;
  double lastTouch_s_ = 0, lastEdit_s_ = 0;
  bool edited_ = false;            // in this stroke
  DVec3 lastHip_{0};               // of the last answer
  DVec3 outward_{0, 0, 1};         // of the surface as the stroke found it
  DVec3 foundAt_{0};               // a place of it
  DVec3 place_{0};                 // of the hand, where the tool has come to
  DVec3 heldAt_{0}, heldFrom_{0};  // grab: where the surface was that it holds, and the hand
  // What is left of the way, a ring.
  std::array<Place, kMaxWay> way_;
  std::size_t wayFirst_ = 0, wayCount_ = 0;
  Tool tool_{};
};

/// A brush in double precision, as the formulas read it. `support`: support radius, model units. Checks the ranges of
/// its options.
shared::BrushOf<double> brushOf(const BrushOptions& options, double support);
/// The same, and the tool, as shaders read them.
shared::Brush sharedBrush(const BrushOptions& options, double support);
shared::BrushTool sharedTool(const BrushStroke::Tool& tool);

}  // namespace palpate
