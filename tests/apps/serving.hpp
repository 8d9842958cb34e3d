// A model served by the program, for tests of those that join it.
#pragma once

#include <filesystem>
#include <string>

#include "tests/apps/running_program.hpp"
#include "tests/own_domain.hpp"

namespace palpate {

// A domain that no other test uses at the same time.
inline std::string domain() { return " --domain " + std::to_string(ownDomain()); }

inline bool isBuilt() {
  if (palpate("doctor --network" + domain()).code == 0) return true;
  MESSAGE("skipped: this palpate was built without PALPATE_NETWORK");
  return false;
}

class Serving {
 public:
  Serving(const std::string& arguments, const std::filesystem::path& said)
      : program("serve " + arguments + domain(), said) {
    REQUIRE_MESSAGE(program.waitFor([&] { return contentOf(said).find("serving") != std::string::npos; }),
                    contentOf(said));
  }
  RunningProgram program;
};

/// The points of a cloud's file, bit by bit.
inline std::string pointsOf(const std::filesystem::path& cloud) {
  const std::filesystem::path numbers = cloud.string() + ".npy";
  works("convert " + cloud.string() + " " + numbers.string() + " --force");
  return contentOf(numbers);
}

}  // namespace palpate
