#include "apps/cli/sharing_results.hpp"

namespace palpate {

namespace {

using Value = std::optional<Json>;

constexpr Reported<SharedCounts> kShared[]{
    {"sent", "", "states of points sent, that this hand changed",
     [](const SharedCounts& s) -> Value { return s.sent; }},
    {"received", "", "states of points changed by others that took effect here",
     [](const SharedCounts& s) -> Value { return s.received; }},
    {"resent", "", "pieces of strokes sent more than once", [](const SharedCounts& s) -> Value { return s.resent; }},
    {"resumed", "", "requests for missing messages, the first included",
     [](const SharedCounts& s) -> Value { return s.resumed; }},
    {"differed", "", "times that the points at rest differed from the server's and were requested again",
     [](const SharedCounts& s) -> Value { return s.differed; }},
    {"longest_silence_s", "s", "longest time without a message",
     [](const SharedCounts& s) -> Value { return s.longestSilent_s; }},
    {"age_s", "s", "age of the information at the end", [](const SharedCounts& s) -> Value { return s.age_s; }},
    {"oldest_s", "s", "largest age of the information", [](const SharedCounts& s) -> Value { return s.oldest_s; }},
    {"force_share", "1", "share of the force that this age allows",
     [](const SharedCounts& s) -> Value { return s.force; }},
    {"pings", "", "pings sent", [](const SharedCounts& s) -> Value { return s.link.pings; }},
    {"answered", "", "pings answered", [](const SharedCounts& s) -> Value { return s.link.answered; }},
    {"lost", "", "pings lost", [](const SharedCounts& s) -> Value { return s.link.lost; }},
    {"lost_percent", "%", "the same as a share; null: no ping was sent",
     [](const SharedCounts& s) -> Value { return orNull(s.link.lost_percent); }},
    {"round_trip_ms", "ms", "round trip of a ping; null: none was answered",
     [](const SharedCounts& s) -> Value { return orNull(s.link.roundTrip_ms); }},
    {"delivered", "", "whether all edits have reached the server",
     [](const SharedCounts& s) -> Value { return s.delivered; }},
    {"idle", "", "whether all edits of the others were in effect at the end",
     [](const SharedCounts& s) -> Value { return s.idle; }},
    {"same", "", "whether the points at rest equal the server's, bit by bit",
     [](const SharedCounts& s) -> Value { return s.same; }},
};

constexpr Reported<FarReport> kPartial[]{
    {"ticks", "", "ticks of the session", [](const FarReport& f) -> Value { return f.ticks.ticks; }},
    {"ticks_without_points", "", "ticks without force, as the points around a hand were missing",
     [](const FarReport& f) -> Value { return f.ticks.without; }},
    {"points", "", "points received", [](const FarReport& f) -> Value { return f.counts.points; }},
    {"steps", "", "updates of the known points", [](const FarReport& f) -> Value { return f.counts.updates; }},
    {"samples", "", "samples received from the network", [](const FarReport& f) -> Value { return f.counts.samples; }},
    {"resumed", "", "times that everything was requested again",
     [](const FarReport& f) -> Value { return f.counts.resumed; }},
    {"servers", "", "successive servers", [](const FarReport& f) -> Value { return f.counts.servers; }},
    {"restarts", "", "restarts of the motion at the server",
     [](const FarReport& f) -> Value { return f.counts.restarts; }},
    {"bricks", "", "bricks held at the end", [](const FarReport& f) -> Value { return f.counts.bricks; }},
    {"known", "", "points held at the end", [](const FarReport& f) -> Value { return f.counts.known; }},
    {"max_known", "", "largest number of points held", [](const FarReport& f) -> Value { return f.counts.mostKnown; }},
    {"sent", "", "states of points that hands here have changed",
     [](const FarReport& f) -> Value { return f.counts.sent; }},
    {"resent", "", "pieces of their strokes sent more than once",
     [](const FarReport& f) -> Value { return f.counts.resent; }},
    {"delivered", "", "whether all edits have reached the server",
     [](const FarReport& f) -> Value { return f.counts.delivered; }},
    {"longest_silence_s", "s", "longest time without a message",
     [](const FarReport& f) -> Value { return f.counts.longestSilent_s; }},
    {"pings", "", "pings sent", [](const FarReport& f) -> Value { return f.counts.pings; }},
    {"answered", "", "pings answered", [](const FarReport& f) -> Value { return f.counts.answered; }},
    {"round_trip_ms", "ms", "round trip of a ping; null: none was answered",
     [](const FarReport& f) -> Value { return orNull(f.counts.roundTrip_ms); }},
};

constexpr Reported<SeenHand> kHands[]{
    {"name", "", "its name", field<&SeenHand::name>},
    {"number", "", "its number, the same in all programs", field<&SeenHand::number>},
    {"position", "model units", "HIP", [](const SeenHand& h) -> Value { return vectorJson(h.place.position); }},
    {"proxy", "model units", "proxy; the HIP where nothing is touched",
     [](const SeenHand& h) -> Value { return vectorJson(h.place.proxy); }},
    {"touching", "", "whether it touches the surface", [](const SeenHand& h) -> Value { return h.place.touching; }},
    {"sculpts", "", "whether it has a brush", [](const SeenHand& h) -> Value { return h.place.sculpts; }},
    {"age_s", "s", "age of the information", field<&SeenHand::age_s>},
};

constexpr Reported<SeenCamera> kCameras[]{
    {"name", "", "name of its hand", field<&SeenCamera::name>},
    {"position", "model units", "its position",
     [](const SeenCamera& c) -> Value { return vectorJson(c.place.position); }},
    {"orientation", "", "quaternion w x y z",
     [](const SeenCamera& c) -> Value {
       const DQuat& turn = c.place.turn;
       return Json{turn.w, turn.x, turn.y, turn.z};
     }},
    {"fov_deg", "degrees", "vertical field of view",
     [](const SeenCamera& c) -> Value { return glm::degrees(c.place.fovY_rad); }},
    {"aspect", "1", "width of its picture over the height",
     [](const SeenCamera& c) -> Value { return c.place.aspect; }},
    {"age_s", "s", "age of the information", field<&SeenCamera::age_s>},
};

}  // namespace

Json toJson(const SharedCounts& counts) { return jsonBy(kShared, counts); }
Json toJson(const FarReport& report) { return jsonBy(kPartial, report); }
Json toJson(std::span<const SeenHand> hands) { return arrayBy(kHands, hands); }
Json toJson(std::span<const SeenCamera> cameras) { return arrayBy(kCameras, cameras); }

void listSharingResults(std::vector<ResultFacts>& all, std::string_view command) {
  listResults(all, command, "shared.", kShared);
  listResults(all, command, "partial.", kPartial);
  listResults(all, command, "other_hands[].", kHands);
}

void listCameraResults(std::vector<ResultFacts>& all, std::string_view command) {
  listResults(all, command, "other_cameras[].", kCameras);
}

}  // namespace palpate
