#include "haptics/library/open_server.hpp"

#include <filesystem>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/saving.hpp"
#include "haptics/library/joined_part.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate::library {

namespace {

Model modelFor(const CloudObject& cloud, const pp_serve_options& options, Log& log) {
  if (cloud.cloud.empty()) throw UsageError("the cloud contains no points");
  SessionConfig config{.model = cloud.source};
  config.model.mm_per_unit = options.mm_per_unit;
  if (options.estimate_normals) config.model.normals = NormalSource::estimate;
  validate(config);
  if (options.read_only && options.save)
    throw UsageError("save, read_only: a read-only session has no strokes to save; leave one of them out");
  if (options.read_only && options.journal)
    throw UsageError("journal, read_only: a read-only session has no strokes to write; leave one of them out");
  return modelOf(cloud.cloud, config.model, {.log = log, .threads = options.threads});
}

CloudServer::Parts partsOf(const CloudObject& cloud, const Model& model, const std::string& name,
                           const pp_serve_options& options, Log& log) {
  return {.network = networkFrom(options.network),
          .name = name,
          .model = options.model ? options.model : std::filesystem::path(cloud.source.file).filename().string(),
          .mm_per_unit = model.scale.mm_per_unit,
          .sculptable = options.read_only == 0,
          .journal = textOf(options.journal),
          .log = &log,
          .save = saverTo(textOf(options.save)),
          .stop = stopFrom(options.network)};
}

}  // namespace

OpenServer::OpenServer(const CloudObject& cloud, const std::string& name, const pp_serve_options& options,
                       std::shared_ptr<Watch> watch)
    : watch_(std::move(watch)),
      messages_(options.log, options.log_user, *watch_),
      network_(networkFrom(options.network)),
      model_(modelFor(cloud, options, messages_.sink())),
      thread_(model_.cloud, partsOf(cloud, model_, name, options, messages_.sink())) {}

void OpenServer::end() {
  thread_.stop();
  messages_.end();
}

pp_server_info OpenServer::info() {
  pp_server_info info = usual<pp_server_info>();
  const ServedCounts counts = thread_.counts();
  info.serving = thread_.isServing();
  info.points = model_.cloud.size();
  info.clients = counts.clients;
  info.sculptors = counts.sculptors;
  info.pieces = counts.pieces;
  info.states = counts.states;
  info.sent = counts.sent;
  info.refused = counts.refused;
  info.mm_per_unit = model_.scale.mm_per_unit;
  putText(opennessOf(network_), info.access);
  try {
    thread_.check();
  } catch (const std::exception& error) {
    putText(error.what(), info.fault);
  }
  return info;
}

PointCloud OpenServer::points() { return editedCloud(model_.cloud, thread_.points()); }

}  // namespace palpate::library
