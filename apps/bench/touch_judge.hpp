// Touch on a known surface, judged by M1 to M12, for `palpate bench touch`.
#pragma once

#include "apps/bench/bench.hpp"
#include "haptics/study/touch_metrics.hpp"
#include "haptics/study/truth_path.hpp"

namespace palpate {

/// A cloud, the surface that it samples, and where to touch it.
struct JudgeSubject {
  struct Start {
    SurfacePoint place;
    DVec3 towards;  ///< direction of a slide from there
  };
  std::string name, condition;
  Model model;
  std::shared_ptr<const void> owner;  ///< owner of the data behind `truth`
  TouchTruth truth;
  double noise = 0;  ///< deviation of the positions, model units
  std::vector<Start> starts;
};

struct JudgeOptions {
  std::vector<double> speeds_mm_per_s{5, 50, 200};
  double mainSpeed_mm_per_s = 50;  ///< one of them; its slides are drawn and repeated
  double depth_mm = 1;
  double stiffness_N_per_mm = 0.4;
};

/// All slides of one speed together.
struct SlideJudgement {
  double speed_mm_per_s = 0;
  double heldShare = 0;
  AngleError angle;            // M1
  HeightError height;          // M2
  double forceError = 0;       // M3
  Continuity continuity;       // M4: largest of all, mean of p99, fraction of the power of all
  double roughOffEdges = 0;    // M4: the same fraction, where no edge is within the widest support radius
  Lag lag;                     // M6: means; largest of all
  double tangentialShare = 0;  // M10
};

struct EditJudgement {
  std::optional<std::size_t> ticksUntilEqual;
  double largestStep_N = 0;
  std::size_t edits = 0;
};

struct Judgement {
  std::string backend, surface, subject, condition;
  std::size_t points = 0;
  double spacing_mm = 0, radius_mm = 0;  ///< the largest radius
  double noise_spacings = 0;             ///< measured noise of the positions
  double friction = 0;                   ///< requested coefficient
  std::vector<SlideJudgement> slides;    ///< by speed
  Summary step_us;                       // M7
  double lateShare = 0;                  // M7: fraction of the ticks that exceed their millisecond
  std::optional<double> free_N;          // M8
  double drift_mm = 0;                   // M10
  std::optional<EditJudgement> edit;     // M11
  bool identical = false;                // M12
  std::optional<double> fromCpu_N;       // M12: empty for the CPU itself
  std::vector<DVec2> force_N;            ///< along the first slide at the main speed: felt and true size, tick by tick
};

/// A path over a subject, with the god-object's answers along it.
struct JudgePath {
  TruthPath path;
  std::vector<IdealTick> ideal;
};
/// Shared by all surfaces and back ends, because it takes most of the time.
struct JudgePlan {
  static constexpr std::size_t kTaps = 0, kPress = 1, kSlides = 2;  ///< indices into `ways`, or the first index
  double freeMargin = 0;        ///< height above the true surface, model units, from which no force is allowed
  std::vector<JudgePath> ways;  ///< the slides from every start, speed by speed
};
/// `widestRadius`: the largest support radius of the judged surfaces, model units.
JudgePlan planFor(Context& context, const JudgeSubject& subject, double widestRadius, const JudgeOptions& options);

/// M1 to M4, M6 to M8, M10 and M12. Each path begins on a back end of its own.
Judgement judgeTouch(Context& context, const JudgeSubject& subject, const JudgePlan& plan, const BenchBackend& backend,
                     const JudgeOptions& options);

/// M11: pushes the surface at the first start, and compares it with a surface built from the resulting points.
EditJudgement judgeEdit(Context& context, const JudgeSubject& subject, const BenchBackend& backend,
                        const JudgeOptions& options);

/// M5: slightly oblique pushes through plates of two sides, until the HIP is 2 mm beyond.
struct PlateJudgement {
  std::string backend, surface;
  double thicknessOverRadius = 0, speed_mm_per_s = 0;
  std::size_t pushes = 0;
  double throughShare = 0;
};
std::vector<PlateJudgement> judgePlates(Context& context, std::size_t points, const BenchBackend& backend);

}  // namespace palpate
