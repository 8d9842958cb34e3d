// The C interface: sessions shared by several programs.
#include "haptics/sharing/network.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/saving.hpp"
#include "haptics/library/claims.hpp"
#include "haptics/library/held_session.hpp"
#include "haptics/library/joined_part.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/model.hpp"
#include "haptics/sharing/server_thread.hpp"

#include <palpate/palpate.h>

using namespace palpate;
using namespace palpate::library;

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

namespace palpate::library {

/// A cloud that the program serves, on a thread of its own. Thread-safe but for end().
class OpenServer {
 public:
  /// Throws Error.
  OpenServer(const CloudObject& cloud, const std::string& name, const pp_serve_options& options,
             std::shared_ptr<Watch> watch)
      : watch_(std::move(watch)),
        messages_(options.log, options.log_user, *watch_),
        network_(networkFrom(options.network)),
        model_(modelFor(cloud, options, messages_.sink())),
        thread_(model_.cloud, partsOf(cloud, model_, name, options, messages_.sink())) {}

  ~OpenServer() { end(); }
  OpenServer(const OpenServer&) = delete;
  OpenServer& operator=(const OpenServer&) = delete;

  const HomeProcess& home() const { return home_; }

  /// Stops serving and calling the program's functions. For one thread.
  void end() {
    thread_.stop();
    messages_.end();
  }

  pp_server_info info() {
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

  PointCloud points() { return editedCloud(model_.cloud, thread_.points()); }

 private:
  HomeProcess home_;
  std::shared_ptr<Watch> watch_;
  Messages messages_;
  NetworkConfig network_;
  Model model_;
  ServerThread thread_;  // destroyed first
};

}  // namespace palpate::library

namespace {

pp_served_session told(const ServedSession& seen) {
  pp_served_session session{};
  putText(seen.name, session.name);
  putText(seen.host, session.host);
  putText(seen.model, session.model);
  session.points = seen.points;
  session.round_trip_ms = seen.roundTrip_ms.value_or(-1);
  session.version = seen.version;
  session.compatible = seen.compatible;
  session.pings = seen.pings;
  session.answered = seen.answered;
  return session;
}

/// Copies items up to `capacity`, and writes their total number to `count`.
template <class Item>
void give(const std::vector<Item>& all, Item* to, std::uint64_t capacity, std::uint64_t* count, std::string_view name) {
  if (capacity > 0) required(to, name);
  required(count, "count") = all.size();
  std::copy_n(all.begin(), std::min<std::uint64_t>(all.size(), capacity), to);
}

template <class Do>
pp_status serving(pp_server server, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenServer>(server.id);
    refuseInCallback();
    found->home().require();
    act(*found);
  });
}

// For calls that may run while another thread touches, even without a budget.
template <class Do>
pp_status beside(pp_session session, Do&& act) {
  return library::with(session, Claim::look, [&](OpenSession& open) { act(open); });
}

}  // namespace

uint32_t pp_can_share(void) { return canShare() ? 1 : 0; }

pp_status pp_network_discover(const pp_network* network, double seconds, pp_served_session* sessions, uint64_t capacity,
                              uint64_t* count) {
  clear(count);
  return guarded([&] {
    constexpr double kLongest_s = 600;
    required(count, "count");
    if (capacity > 0) required(sessions, "sessions");
    if (!(seconds >= 0 && seconds <= kLongest_s))
      throw UsageError("seconds: {} is not between 0 and {}", seconds, kLongest_s);
    std::vector<pp_served_session> all;
    std::ranges::transform(discoverSessions(networkFrom(network), seconds, stopFrom(network)).sessions,
                           std::back_inserter(all), told);
    give(all, sessions, capacity, count, "sessions");
  });
}

pp_status pp_session_join(const char* name, const pp_join_options* join, const pp_session_options* options,
                          pp_session* session) {
  clear(session);
  return guarded([&] {
    const std::string called = &required(name, "name");
    openSession(options, session, [&] {
      Subject subject;
      subject.model.file = called;
      subject.join = joinFrom(optionsFrom(join, "join"));
      subject.model.join = subject.join->network;
      return subject;
    });
  });
}

pp_status pp_session_get_sharing(pp_session session, pp_sharing* sharing) {
  clear(sharing);
  return beside(session, [&](OpenSession& open) { giveInfo(sharing, open.sharing(), "sharing"); });
}

pp_status pp_session_other_hands(pp_session session, pp_other_hand* hands, uint64_t capacity, uint64_t* count) {
  clear(count);
  return beside(session, [&](OpenSession& open) { give(open.otherHands(), hands, capacity, count, "hands"); });
}

pp_status pp_session_cameras(pp_session session, pp_other_camera* cameras, uint64_t capacity, uint64_t* count) {
  clear(count);
  return beside(session, [&](OpenSession& open) { give(open.cameras(), cameras, capacity, count, "cameras"); });
}

pp_status pp_session_publish_camera(pp_session session, const pp_camera_place* camera) {
  return beside(session, [&](OpenSession& open) { open.publishCamera(camera); });
}

pp_status pp_session_settle(pp_session session, double seconds, uint32_t* same) {
  clear(same);
  return lasting(session, [&](OpenSession& open) {
    if (!(seconds >= 0 && seconds <= bounds::kLongest_s))
      throw UsageError("seconds: {} is not between 0 and {}", seconds, bounds::kLongest_s);
    const bool isSame = open.settleShared(seconds);
    if (!isSame && isStopWanted()) throw Stopped("stopped before all was settled");
    if (same) *same = isSame ? 1 : 0;
  });
}

pp_status pp_session_save_at_server(pp_session session, double seconds, pp_server_save* save) {
  clear(save);
  return commanding(session, [&](OpenSession& open) {
    checkSize(required(save, "save").size, sizeof(pp_server_save), alignof(pp_server_save), "save");
    if (!(seconds >= 0 && seconds <= bounds::kLongest_s))
      throw UsageError("seconds: {} is not between 0 and {}", seconds, bounds::kLongest_s);
    const ServerSave answer = open.saveAtServer(seconds);
    pp_server_save given = usual<pp_server_save>();
    given.written = answer.written ? 1 : 0;
    given.points = answer.points;
    putText(answer.words, given.text);
    giveInfo(save, given, "save");
  });
}

pp_status pp_serve(pp_cloud cloud, const char* name, const pp_serve_options* options, pp_server* server) {
  clear(server);
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    const std::string called = &required(name, "name");
    required(server, "server");
    const pp_serve_options given = optionsFrom(options, "options");
    const auto watch = std::make_shared<Watch>(given.watch);
    std::shared_ptr<OpenServer> made;
    watch->runCut([&] { made = std::make_shared<OpenServer>(*found, called, given, watch); });
    *server = library::opened<pp_server>(std::move(made));
  });
}

pp_status pp_server_get_info(pp_server server, pp_server_info* info) {
  clear(info);
  return serving(server, [&](OpenServer& open) {
    checkSize(required(info, "info").size, sizeof(pp_server_info), alignof(pp_server_info), "info");
    giveInfo(info, open.info(), "info");
  });
}

pp_status pp_server_cloud(pp_server server, pp_cloud* cloud) {
  clear(cloud);
  return serving(server, [&](OpenServer& open) {
    required(cloud, "cloud");
    *cloud = library::opened<pp_cloud>(std::make_shared<CloudObject>(open.points()));
  });
}

pp_status pp_server_close(pp_server server) {
  return guarded([&] {
    refuseInCallback();
    if (!objectOf<OpenServer>(server.id)->home().isThis()) return handles().abandon(HandleKind::server, server.id);
    const auto closed = std::static_pointer_cast<OpenServer>(handles().remove(HandleKind::server, server.id));
    closed->end();
  });
}
