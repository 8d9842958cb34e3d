#pragma once

#include <string>

namespace palpate {

/// The processor's model name; "CPU" where the system does not say.
std::string processorName();

/// How many cores the calling thread may use.
int coresToUse() noexcept;

/// The core that the calling thread runs on now.
int currentCore() noexcept;

}  // namespace palpate
