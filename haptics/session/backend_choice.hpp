// `auto` in real time: measures whether the GPU or the CPU answers sooner, and remembers it.
#pragma once

#include <optional>
#include <string>

#include "haptics/session/backends.hpp"
#include "haptics/session/measured_backends.hpp"

namespace palpate {

/// How a back end answered while it was measured.
struct BackendTime {
  std::optional<double> p99_us;  ///< 99th percentile of a tick; empty: it was not measured
  std::string failure;           ///< why it cannot be used; empty: it can
};

/// The measurement of a session's two back ends.
struct BackendTimes {
  BackendTime gpu, cpu;
  std::string gpuName;               ///< in messages
  bool edits = false;                ///< each tick edited the points
  std::optional<double> measured_s;  ///< duration; empty: an earlier program has measured
};

/// One of both, and a sentence that says why.
struct BackendChoice {
  bool gpu = true;
  std::string sentence;
};
/// The one that answers sooner; the GPU unless the CPU is sooner by more than a tenth. A back end that failed loses; if
/// both failed, it is the GPU.
BackendChoice soonerOf(const BackendTimes& times);

struct BackendCandidates {
  const BackendKind& gpu;
  const BackendKind& cpu;
  unsigned threads = 0;  ///< on the CPU; 0: one per core
  Log& log;              ///< receives the choice and its reason
  MeasuredBackends memory = MeasuredBackends();
  /// Brush of ticks with an edit, where the session has none at the start; empty: it never has one.
  std::optional<BrushConfig> laterBrush = {};
};
/// The back end for a session in real time on this model. Measures for up to two seconds, with the session's own tool
/// and brush around one spot of the model, without a device and so without any force; the session's back end is made
/// afterwards. Measures nothing, and takes the GPU, for points that move or are shared and for a configuration that
/// the CPU refuses.
const BackendKind& soonerBackend(const SessionConfig& config, const Model& model, const BackendCandidates& candidates);

}  // namespace palpate
