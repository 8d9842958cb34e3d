// The measures of touch, M1 to M12, from traces and the truth.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/core/vec.hpp"
#include "haptics/study/truth_path.hpp"
#include "haptics/trace.hpp"

namespace palpate {

/// Distribution of a signal's power over frequency.
/// Power over frequency by Welch's method (1967): segments that overlap by half, each under a Hann window, their
/// periodograms averaged. Entry k is at the frequency k / (2 (size - 1)) of the sampling rate; only ratios are
/// meaningful, not the scale. `segment` is limited to the signal's length. Empty for fewer than two samples.
std::vector<double> welchPower(std::span<const double> signal, std::size_t segment = 256);

/// Share of the signal's power, constant part included, between two frequencies, summed over its three components; 0
/// for a signal without power.
double powerShare(std::span<const DVec3> signal, double rate_Hz, double from_Hz, double to_Hz);

/// The god-object's result for a HIP. Lengths in model units.
struct IdealTick {
  bool shouldTouch = false;
  bool offEdges = true;  ///< the true surface around it is smooth (followTruth())
  SurfacePoint truth;    ///< the god-object; the closest point while nothing should be touched
  double hipHeight = 0;  ///< signed distance to the true surface, positive outside; 0 while it should touch
};

/// Follows the god-object tick by tick. `longestStep`: of the god-object, model units. The first HIP must be outside. A
/// tick is off edges where the true surface bends by less than 26 degrees within `edgeReach`, model units; with 0 it
/// always is.
std::vector<IdealTick> followTruth(std::span<const DVec3> hips, const TouchTruth& truth, double longestStep,
                                   double edgeReach = 0);

/// A tick of a trace with its ideal.
struct JudgedTick : IdealTick {
  TraceRow row;
  double proxyHeight = 0;  ///< of the proxy, as hipHeight; 0 while it does not touch
};
using JudgedTicks = std::span<const JudgedTick>;

/// `ideal` has one entry for each row of the trace, for the same HIPs.
std::vector<JudgedTick> judge(const Trace& trace, std::span<const IdealTick> ideal, const TouchTruth& truth);

/// The ticks from `from_s` on and before `to_s`.
JudgedTicks between(JudgedTicks ticks, double from_s, double to_s);

/// The share of ticks with a force among those that should have one.
double heldShare(JudgedTicks ticks);

/// M1: angle between the force and the true outward normal at the god-object, where there is a force and should be.
struct AngleError {
  std::size_t count = 0;
  double mean_deg = 0, p95_deg = 0, max_deg = 0;
};
AngleError angleError(JudgedTicks ticks);

/// M2: signed distance of the proxy to the true surface, where it touches; negative: too deep.
struct HeightError {
  std::size_t count = 0;
  double bias_mm = 0, rms_mm = 0;
};
HeightError heightError(JudgedTicks ticks, const ModelScale& scale);

/// M3: root mean square of the force's magnitude less stiffness times true depth (of the HIP under the god-object),
/// relative to that of the latter; a missing force counts as zero. 0 if nothing should be touched.
double forceError(JudgedTicks ticks, double stiffness_N_per_mm, const ModelScale& scale);

/// M4: change of the force vector between neighbouring ticks that should both touch. A contact may end a little sooner
/// or later than the true one: ticks whose HIP is within `letGo`, model units, of its end are left out.
struct Continuity {
  double p99_N_per_s = 0, max_N_per_s = 0;
  double power = 0;       ///< of dF/dt, summed over the ticks, N^2/s^2
  double roughShare = 0;  ///< of the power of dF/dt, from 50 to 500 Hz, where fingertips feel it as roughness
};
Continuity continuity(JudgedTicks ticks, double rate_Hz, double letGo = 0);
/// For ticks off edges only: crossing an edge is a click, with power at all frequencies.
Continuity continuityOffEdges(JudgedTicks ticks, double rate_Hz);

/// M5: whether a push through a plate has come out of it: at its last tick nothing is touched, or the proxy lies behind
/// the plate's middle. `outward`: normal of the face that was pushed.
bool cameThrough(const Trace& push, const DVec3& middle, const DVec3& outward);

/// M6: distance of the proxy from the god-object along the surface, and the delay that explains it best: least squares
/// of that distance against the god-object's velocity. 0 ms for a god-object at rest.
struct Lag {
  std::size_t count = 0;
  double mean_mm = 0, max_mm = 0, delay_ms = 0;
};
Lag lagBehind(JudgedTicks ticks, const ModelScale& scale);

/// M7 is summarize(Trace); this is the share of ticks whose answer took longer than `period_us`.
double lateShare(JudgedTicks ticks, double period_us);

/// M8: the maximum force while the HIP is higher than `margin` (model units) above the true surface; nothing if it
/// never is.
std::optional<double> freeForce_N(JudgedTicks ticks, double margin);

/// M10: median of tangential over normal force, by the true normal, where there is a force and should be.
double tangentialShare(JudgedTicks ticks);
/// M10: how far the proxy moves from its position at the first of `ticks`, in which the HIP rests.
double drift_mm(JudgedTicks ticks, const ModelScale& scale);

/// M11: number of ticks of `after` from index `from` on until the force stays within `tolerance_N` of that of `fresh`,
/// which follows the same path; nothing if it never does.
std::optional<std::size_t> ticksUntilEqual(const Trace& after, const Trace& fresh, std::size_t from,
                                           double tolerance_N);
/// M11: the maximum change of force from one tick to the next that also touches.
double largestForceStep_N(const Trace& trace);

/// M12: maximum difference of force between two traces of the same path; infinite if they differ in length or have a
/// value that is not a number.
double forceDifference_N(const Trace& a, const Trace& b);
/// M12: whether two traces are equal bit by bit, except for the time they took.
bool identical(const Trace& a, const Trace& b);

}  // namespace palpate
