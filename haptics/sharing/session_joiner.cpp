#include "haptics/sharing/session_joiner.hpp"

#include "engine/cloud/length_unit.hpp"
#include "engine/core/counted.hpp"
#include "engine/touch/touch_backend.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/presence.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "haptics/sharing/shared_edits.hpp"

namespace palpate {

namespace {

JoinedCloud join(const std::string& name, const JoinConfig& config, const Joining& how, Log& log, bool present) {
  const NetworkConfig network{
      .interface = config.network, .peers = config.peers, .domain = config.domain, .security = config.security};
  JoinedCloud joined = joinCloud(name, {.network = network,
                                        .present = present,
                                        .partial = config.partial,
                                        .timeout_s = how.timeout_s,
                                        .log = &log,
                                        .stop = how.stop});
  if (joined.far)
    log.say("{}: of the {} points of {}, served by {}, only those around the hands are fetched{}; {}", name,
            joined.facts->extent.points, joined.model, joined.host, joined.facts->moves ? "; they move" : "",
            opennessOf(network));
  else
    log.say("{}: {} of {}, served by {}; {}", name, counted(joined.cloud.size(), "point"), joined.model, joined.host,
            opennessOf(network));
  if (!joined.unsent.empty() && !joined.far)
    log.say("{}: these stay with the server: {}; palpate serve --save writes them, a file saved here lacks them", name,
            joined.unsent);
  sayScale(joined.cloud.storedAs.comments, joined.mm_per_unit);
  return joined;
}

JoinedModel modelOf(JoinedCloud& joined) {
  return {.cloud = std::move(joined.cloud),
          .host = joined.host,
          .source = joined.model,
          .far = std::move(joined.far),
          .facts = joined.facts};
}

}  // namespace

SessionJoiner sessionJoiner(const Joining& how) {
  return [how](const std::string& name, const JoinConfig& config, Log& log) {
    JoinedCloud joined = join(name, config, how, log, false);
    auto presence = sharePresence(joined.session, how.hand, joined.cloud);
    JoinedModel model = modelOf(joined);
    model.presence = std::move(presence);
    if (!joined.sculptable && !model.far)
      log.say("{}: served read-only; it is felt even while the network is interrupted", name);
    if (joined.sculptable)
      model.share = [session = joined.session, &log](const PointCloud& cloud, TouchBackend& backend) {
        return shareEdits({.session = session,
                           .cloud = cloud,
                           .edits = *backend.edits(),
                           .cell = backend.report().cell,
                           .log = &log});
      };
    return model;
  };
}

SessionJoiner pointsJoiner(const Joining& how) {
  return [how](const std::string& name, const JoinConfig& config, Log& log) {
    JoinedCloud joined = join(name, config, how, log, true);
    return modelOf(joined);
  };
}

}  // namespace palpate
