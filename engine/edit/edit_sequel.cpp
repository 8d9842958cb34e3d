#include "engine/edit/edit_sequel.hpp"

#include "engine/edit/edit_pipelines.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

EditSequel::EditSequel(Device& device, const HashUpdate& update, const EditLog& log, double radius)
    : update_(update),
      log_(log),
      radius_(radius),
      refit_(device, shader_code::edit_refit_normals, editPipeline(sizeof(shared::RefitNormalsArgs), update)),
      logGone_(device, shader_code::edit_log_gone, editPipeline(sizeof(shared::RefitNormalsArgs), update)),
      settle_(device, shader_code::edit_settle, editPipeline(sizeof(shared::SettleArgs), update)) {}

void EditSequel::recordLogging(CommandList& list, const ComputePipeline& pass, CountedDispatch::Step step,
                               std::uint64_t groups, const Io& io) const {
  const shared::HashUpdateArgs update = update_.args(io.cloud, io.parity);
  update_.dispatch()(list, pass, step, update_.counters(), groups,
                     shared::RefitNormalsArgs{.cloud = io.cloud,
                                              .update = update.update,
                                              .changed = io.scratch.changed,
                                              .fitted = io.scratch.fitted,
                                              .entries = log_.entries(),
                                              .head = log_.head(),
                                              .tables = io.tables,
                                              .lists = io.lists,
                                              .capacityMask = static_cast<std::uint32_t>(log_.capacity() - 1),
                                              .radius = static_cast<float>(radius_)});
}

void EditSequel::recordGone(CommandList& list, const Io& io) const {
  recordLogging(list, logGone_, CountedDispatch::Step::invocation, offsetof(shared::HashUpdate, moveGroups), io);
}

void EditSequel::record(CommandList& list, const Io& io, const shared::EditEnd& end) const {
  using Step = CountedDispatch::Step;
  constexpr std::uint64_t kGroups = offsetof(shared::HashUpdate, changedGroups);
  const shared::HashUpdateArgs update = update_.args(io.cloud, io.parity);
  const auto section = list.section("refit normals");
  recordLogging(list, refit_, Step::subgroup, kGroups, io);
  update_.dispatch()(list, settle_, Step::invocation, update_.counters(), kGroups,
                     shared::SettleArgs{.cloud = io.cloud,
                                        .update = update.update,
                                        .changed = io.scratch.changed,
                                        .fitted = io.scratch.fitted,
                                        .head = log_.head(),
                                        .lists = io.lists,
                                        .end = end});
}

}  // namespace palpate
