// The C interface: session logs, written, read and replayed.
#include <algorithm>
#include <vector>

#include "haptics/library/failures.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/held_session.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/session_replay.hpp"

namespace palpate::library {

/// A log in memory; immutable.
struct LogObject {
  std::vector<pp_recording_tick> ticks;
  std::vector<pp_recording_edit> edits;
  std::string header, missing;
  pp_recording_content view{};
};

namespace {

pp_recording_tick tickOf(const LoggedTick& tick) {
  pp_recording_tick told{};
  told.t_s = tick.time_s;
  putVector(tick.device, told.device);
  told.orientation[0] = tick.turn.w;
  told.orientation[1] = tick.turn.x;
  told.orientation[2] = tick.turn.y;
  told.orientation[3] = tick.turn.z;
  putVector(tick.proxy, told.proxy);
  putVector(tick.force_N, told.force_N);
  told.edits = tick.edits;
  told.neighbours = tick.neighbours;
  told.buttons = tick.buttons();
  told.contact = tick.has(LoggedTick::kContact);
  told.fresh = tick.has(LoggedTick::kFresh);
  told.valid = tick.has(LoggedTick::kValid);
  told.put_down = tick.has(LoggedTick::kPutDown);
  told.forceless = tick.has(LoggedTick::kForceless);
  told.edit_dropped = tick.has(LoggedTick::kEditLeftOut);
  return told;
}

pp_recording_edit editOf(const PointState& state) {
  pp_recording_edit told{};
  told.point = state.number;
  told.parent = state.parent;
  for (int k = 0; k < 3; ++k) {
    told.position[k] = state.position[k];
    told.normal[k] = state.normal[k];
  }
  std::memcpy(told.color, &state.color, sizeof told.color);
  told.gone = state.gone ? 1 : 0;
  return told;
}

std::shared_ptr<LogObject> logOf(const std::string& file) {
  const SessionRecord record = readSessionLog(file);
  const RecordedSession session = parseHeader(file, record.text);
  auto log = std::make_shared<LogObject>();
  std::ranges::transform(record.ticks, std::back_inserter(log->ticks), tickOf);
  std::ranges::transform(record.edits.points, std::back_inserter(log->edits), editOf);
  log->header = record.text;
  for (const std::string& sentence : whatIsMissing(record)) log->missing += sentence + "\n";
  pp_recording_content& view = log->view;
  view.ticks = log->ticks.size();
  view.edits = log->edits.size();
  view.tick = log->ticks.data();
  view.edit = log->edits.data();
  view.header = log->header.c_str();
  view.missing = log->missing.c_str();
  view.points = session.points;
  view.lost_ticks = record.end ? record.end->lostTicks : 0;
  view.merged_edits = record.mergedEdits;
  view.map_scale = session.map.scale;
  putVector(session.map.offset, view.map_offset);
  view.ended = record.end.has_value();
  return log;
}

/// Back ends of this build; a GPU is opened when it is needed.
Backends backendsOn(GpuHalf& gpu) {
  std::vector<std::unique_ptr<BackendKind>> kinds;
  kinds.push_back(cpuBackend());
  if (!gpuNames().empty()) kinds.push_back(gpu.backend());
  return Backends(std::move(kinds));
}

pp_replay_result replayed(const std::string& file, const pp_replay_options& options, Watch& watch) {
  const auto cloud = options.cloud.id == 0 ? nullptr : objectOf<CloudObject>(options.cloud.id);
  if (!(options.tolerance >= 0)) throw UsageError("tolerance: {} is not a number of at least 0", options.tolerance);
  Messages messages(options.log, options.log_user, watch);
  GpuHalf gpu({.gpu = options.gpu});
  const Backends backends = backendsOn(gpu);
  const ReplayParts parts{.backends = backends,
                          .log = messages.sink(),
                          .threads = options.threads,
                          .model = textOf(options.model),
                          .cloud = cloud ? &cloud->cloud : nullptr};
  Recorded recorded = loadRecorded(file, parts);
  const SessionAgain again = runAgain(recorded, parts);
  const ReplayOutcome outcome = compareRuns(recorded, again, options.tolerance);
  const Differences& found = outcome.differences;
  pp_replay_result result = usual<pp_replay_result>();
  result.identical = outcome.isWhole(recorded) && recorded.endsAsRecorded.value_or(false);
  result.ticks = recorded.record.ticks.size();
  result.compared = found.ticks;
  result.force_ticks = found.forceTicks;
  result.edit_ticks = found.editTicks;
  result.points = found.points;
  result.largest_force_N = found.largestForce_N;
  result.first_difference_s = found.first_s.value_or(-1);
  result.ends_compared = found.ends;
  if (recorded.endsAsRecorded) result.recorded_edits = *recorded.endsAsRecorded ? 1 : 2;
  putText(reasonOf(outcome, recorded), result.reason);
  putText(backends.named(recorded.session.config.backend.name).machine(options.threads), result.machine);
  putText(recorded.session.machine, result.recorded_on);
  return result;
}

}  // namespace

}  // namespace palpate::library

using namespace palpate;
using namespace palpate::library;

pp_status pp_session_record(pp_session session, const char* file) {
  return commanding(session, [&](OpenSession& open) { open.record(&required(file, "file")); });
}

pp_status pp_recording_read(const char* file, pp_recording* log) {
  clear(log);
  return guarded([&] {
    const std::string name = &required(file, "file");
    required(log, "log") = opened<pp_recording>(logOf(name));
  });
}

pp_status pp_recording_view(pp_recording log, pp_recording_content* content) {
  clear(content);
  return guarded([&] { required(content, "content") = objectOf<LogObject>(log.id)->view; });
}

pp_status pp_recording_close(pp_recording log) {
  return guarded([&] { handles().remove(HandleKind::log, log.id); });
}

pp_status pp_recording_replay(const char* file, const pp_replay_options* options, pp_replay_result* result) {
  clear(result);
  return guarded([&] {
    const std::string name = &required(file, "file");
    checkSize(required(result, "result").size, sizeof(pp_replay_result), alignof(pp_replay_result), "result");
    const pp_replay_options given = optionsFrom(options, "options");
    Watch watch(given.watch);
    watch.runCut([&] { giveInfo(result, replayed(name, given, watch), "result"); });
  });
}
