// The result of each case of this program.
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct FailedCase {
  std::string name;
  bool measuresClock = false;
};

/// Cases that have failed since the last call, in order.
std::vector<FailedCase> takeFailedCases();

}  // namespace palpate
