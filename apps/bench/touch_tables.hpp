// Results of `palpate bench touch`, as tables and as JSON.
#pragma once

#include <cstdio>

#include "apps/bench/touch_judge.hpp"

namespace palpate {

/// The largest stiffness that a hand holds stably on an exact plane (M9), N/mm.
struct StabilityJudgement {
  double delay_ms = 0, damping_N_s_per_mm = 0;
  bool controlled = false;  ///< with the passivity controller
  double largest_N_per_mm = 0;
  double leastEnergy_mJ = 0;  ///< at 0.4 N/mm
};

struct TouchResults {
  std::vector<Judgement> judgements;
  std::vector<PlateJudgement> plates;
  std::vector<StabilityJudgement> stability;
};

/// Tables of at most 160 characters a line; the slides at `mainSpeed_mm_per_s`, then all speeds.
void printTouchTables(std::FILE* out, const TouchResults& results, double mainSpeed_mm_per_s);
Json toJson(const TouchResults& results);

}  // namespace palpate
