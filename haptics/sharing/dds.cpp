#include "haptics/sharing/dds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <string_view>

namespace palpate {

bool canShare() { return true; }

std::string opennessOf(const NetworkConfig& network) {
  if (network.interface.empty())
    return fmt::format("programs of this machine alone can join (domain {})", network.domain);
  return fmt::format(
      "whoever is on the network of {} can join, and nothing is encrypted (domain {}); use a network that you trust, or a "
      "tunnel",
      network.interface, network.domain);
}

}  // namespace palpate

namespace palpate::sharing {

namespace {

constexpr std::uint32_t kLastDomain = 230;  // of those that have ports
constexpr auto kPatience = DDS_MSECS(2);  // of a writer whose readers do not keep up: it is tried again

// Without characters that would end what they stand in.
std::string plain(const std::string& word, const char* what) {
  const bool isPlain = !word.empty() && word.size() < 100 && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == ':' || c == '-' || c == '_' || c == '%';
  });
  if (!isPlain) throw UsageError("{}: '{}' is neither the name of an interface nor an address", what, word);
  return word;
}

// What DDS says to a person, who did not ask it: the last line goes into what we throw.
class Remarks {
 public:
  // Never destroyed: threads of who uses the library may still be in calls as the program ends.
  static Remarks& all() {
    static Remarks& remarks = *new Remarks;
    return remarks;
  }
  Remarks() {
    dds_set_log_sink([](void* to, const dds_log_data_t* said) { static_cast<Remarks*>(to)->hear({said->message, said->size}); },
                     this);
  }
  std::string take() {
    const std::scoped_lock hold(lock_);
    return std::exchange(last_, {});
  }

 private:
  void hear(std::string_view line) {
    const std::scoped_lock hold(lock_);
    last_ = line.substr(0, line.find_last_not_of(" .\n") + 1);
  }
  std::mutex lock_;
  std::string last_;
};

// Several samples go into a datagram within this machine; elsewhere it is one frame, which is lost alone.
constexpr const char* kWholeDatagrams = "<MaxMessageSize>65500B</MaxMessageSize>";
constexpr const char* kFrames = "<MaxMessageSize>1400B</MaxMessageSize><FragmentSize>1344B</FragmentSize>";

// On this machine alone participants find one another without multicast, by their ports. What a client has asked for, some
// megabytes, may be under way at once, and be put together in any order. One thread receives: several are woken at the end
// through the network, for ever where the interface has gone.
std::string configOf(const NetworkConfig& network) {
  if (network.domain > kLastDomain) throw UsageError("domain: is {}; there are 0 to {}", network.domain, kLastDomain);
  const bool isHere = network.interface.empty();
  std::string peers;
  for (const std::string& peer : network.peers) peers += fmt::format("<Peer address=\"{}\"/>", plain(peer, "peer"));
  if (isHere) peers = "<Peer address=\"127.0.0.1\"/>" + peers;
  const std::string interface =
      isHere ? "address=\"127.0.0.1\"" : fmt::format("{}=\"{}\"", std::isdigit(static_cast<unsigned char>(network.interface[0])) ? "address" : "name",
                                         plain(network.interface, "network"));
  return fmt::format(
      "<CycloneDDS><Domain id=\"any\"><General><Interfaces><NetworkInterface {}/></Interfaces>"
      "<AllowMulticast>{}</AllowMulticast>{}</General>"
      "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>40</MaxAutoParticipantIndex>"
      "<Peers>{}</Peers></Discovery>"
      "<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads><Watermarks><WhcHigh>16MB</WhcHigh></Watermarks>"
      "<PrimaryReorderMaxSamples>8192</PrimaryReorderMaxSamples><SecondaryReorderMaxSamples>8192</SecondaryReorderMaxSamples>"
      "<NackDelay>10ms</NackDelay><AutoReschedNackDelay>300ms</AutoReschedNackDelay>"
      "<HeartbeatInterval min=\"5ms\" minsched=\"20ms\" max=\"500ms\">100ms</HeartbeatInterval><MaxQueuedRexmitBytes>4MB</MaxQueuedRexmitBytes>"
      "<MaxQueuedRexmitMessages>8192</MaxQueuedRexmitMessages></Internal>"
      "</Domain></CycloneDDS>",
      interface, isHere ? "false" : "default", isHere ? kWholeDatagrams : kFrames, peers);
}

}  // namespace

dds_return_t checked(dds_return_t result, const char* what) {
  if (result < 0) throw NetworkError("{}: {}", what, dds_strretcode(-result));
  return result;
}

Qos reliableQos(bool lasting, const std::string& partition) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kPatience);
  dds_qset_durability(qos.get(), lasting ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), lasting ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, lasting ? 1 : 0);
  if (!partition.empty()) {
    const char* name = partition.c_str();
    dds_qset_partition(qos.get(), 1, &name);
  }
  return qos;
}

Qos bestEffortQos() {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 64);
  return qos;
}

struct Participant::Domain {
  explicit Domain(const std::string& given, std::uint32_t id)
      : config(given), entity(dds_create_domain(id, given.c_str()), "the network") {}
  std::string config;
  Entity entity;

  static std::shared_ptr<Domain> of(const NetworkConfig& network) {
    static std::mutex& lock = *new std::mutex;  // as Remarks
    static auto& all = *new std::map<std::uint32_t, std::weak_ptr<Domain>>;
    const std::string config = configOf(network);
    Remarks::all().take();
    std::shared_ptr<Domain> there;
    const std::scoped_lock hold(lock);
    there = all[network.domain].lock();
    if (!there) {
      try {
        there = std::make_shared<Domain>(config, network.domain);
      } catch (const NetworkError& error) {
        const std::string why = Remarks::all().take();
        throw NetworkError("the network of {} cannot be used: {}; is there such an interface, and does it carry IPv4?",
                           network.interface.empty() ? "this machine" : network.interface, why.empty() ? error.what() : why);
      }
      all[network.domain] = there;
    }
    if (there->config != config)
      throw UsageError("domain: this program is on domain {} of another network already", network.domain);
    return there;
  }
};

Participant::Participant(const NetworkConfig& network, const Qos& qos)
    : domain_(Domain::of(network)),
      participant_(dds_create_participant(network.domain, qos.get(), nullptr), "the network") {}

void ReaderWait::attach(dds_entity_t reader) {
  conditions_.emplace_back(dds_create_readcondition(reader, DDS_ANY_STATE), "a condition");
  checked(dds_waitset_attach(wait_, conditions_.back(), 0), "a condition");
}

void ReaderWait::sleep(double most_s) const {
  checked(dds_waitset_wait(wait_, nullptr, 0, static_cast<dds_duration_t>(most_s * 1e9)), "the network");
}

}  // namespace palpate::sharing
