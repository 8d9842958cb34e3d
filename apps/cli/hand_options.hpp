// Options for the source of a HIP's poses.
#pragma once

#include "apps/cli/context.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct HandChoices {
  std::string option = "--device ";  ///< text before the name of the device on the command line
  std::string device = "path", scheduler = "device";
  HandConfig hand;        ///< mapping, passivity, simulated hand, rumbling
  double duration_s = 0;  ///< 0: that of the path

  /// `path`: for a script or a simulated hand.
  HandConfig config(const std::string& path, double penetration_mm) const;
};
void addHandOptions(Options& command, HandChoices& options);
/// Validator for the name of a device.
Check deviceValidator();
/// Throws UsageError for incompatible options; before anything is loaded or opened.
void checkHandOptions(const HandChoices& options, bool realtime);

/// A hand after the first, as --hand describes it.
struct FurtherHand {
  std::string device = "path", path, traceFile;
};
/// Adds --hand, which may be repeated.
void addFurtherHandOption(Options& command, std::vector<std::string>& hands);
/// The hands after the first. Throws UsageError for an invalid one, for too many, and for a device of another hand.
std::vector<FurtherHand> furtherHands(const std::vector<std::string>& hands, const HandChoices& first, bool realtime);
/// Choices of a hand after the first: those of the first hand, as far as they apply.
HandChoices choicesFor(HandChoices first, const FurtherHand& hand);

}  // namespace palpate
