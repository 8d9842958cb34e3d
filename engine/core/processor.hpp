#pragma once

#include <string>

namespace palpate {

/// The processor's model name; "CPU" where the system does not say.
std::string processorName();

}  // namespace palpate
