// What a whole test program shares: it goes when the last test has run, while every library is still whole. An object
// that is static may outlive those of a validation layer, which calls that abort.
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
