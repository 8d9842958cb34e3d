// Objects shared by a whole test program: destroyed after the last test, while every library is still loaded. A static
// object may outlive those of a validation layer, which aborts then.
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace palpate {

inline std::vector<std::shared_ptr<void>>& keptUntilEnd() {
  static std::vector<std::shared_ptr<void>> kept;
  return kept;
}

template <class T, class... Arguments>
T& makeUntilEnd(Arguments&&... arguments) {
  auto made = std::make_shared<T>(std::forward<Arguments>(arguments)...);
  keptUntilEnd().push_back(made);
  return *made;
}

}  // namespace palpate
