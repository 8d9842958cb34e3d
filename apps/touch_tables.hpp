// What `palpate bench touch` found, as tables and as JSON.
#pragma once

#include <cstdio>

#include "apps/touch_judge.hpp"

namespace palpate {

struct TouchResults {
  std::vector<Judgement> judgements;
  std::vector<PlateJudgement> plates;
};

/// Tables of at most 160 characters a line; those of the slides at `mainSpeed_mm_per_s`, then all speeds.
void printTouchTables(std::FILE* out, const TouchResults& results, double mainSpeed_mm_per_s);
Json toJson(const TouchResults& results);

}  // namespace palpate
