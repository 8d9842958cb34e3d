// Replaces engine/study/gathers.cpp if palpate is built without PALPATE_STUDY.
#include "engine/contact/gather.hpp"

namespace palpate {

std::span<const GatherKind> gatherKinds() { return {}; }

}  // namespace palpate
