#pragma once

#include <string>

#include "apps/view/commands.hpp"
#include "apps/view/session.hpp"

namespace palpate {

/// Carries out a command about layers of strokes; those without a name that needs one are about the open layer. Returns
/// a remark for the user, or an empty text. Throws Error where the model refuses it, or has no layer of that name.
std::string carryOut(const LayerCommand& command, WindowSession& session);

}  // namespace palpate
