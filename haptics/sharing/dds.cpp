#include "haptics/sharing/dds.hpp"

#include <dds/features.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <thread>

#include "engine/core/free_files.hpp"
#include "engine/core/free_memory.hpp"
#include "engine/core/start_thread.hpp"
#include "engine/core/system_file.hpp"
#include "haptics/sharing/security.hpp"

namespace palpate {

bool canShare() { return true; }

std::string opennessOf(const NetworkConfig& network) {
  if (!network.security.empty())
    return fmt::format(
        "encrypted, for holders of keys of '{}' on {} (domain {})", readSecurityProfile(network.security).authority,
        network.interface.empty() ? "this machine" : "the network of " + network.interface, network.domain);
  if (network.interface.empty())
    return fmt::format("only programs of this machine can join (domain {})", network.domain);
  return fmt::format(
      "every program on the network of {} can join, and nothing is encrypted (domain {}); use a network that you "
      "trust, or keys",
      network.interface, network.domain);
}

}  // namespace palpate

namespace palpate::sharing {

namespace {

#ifdef DDS_HAS_SECURITY
constexpr bool kCanEncrypt = true;
#else
constexpr bool kCanEncrypt = false;
#endif
constexpr std::string_view kHasKeys = "palpate=keys;";  // user data of participants with keys
constexpr std::uint32_t kLastDomain = 230;              // the last one that has ports
constexpr auto kWriterPatience = DDS_MSECS(0);          // for slow readers: others get their turn meanwhile
// DDS ends the program where it gets no memory, no thread or no descriptor of a socket. These are more than it was
// measured to take: stacks and heaps of its threads, of which there are five, and two more with keys.
constexpr std::uint64_t kMB = 1'000'000, kAddresses_bytes = 600 * kMB;
constexpr std::size_t kThreads = 8, kFiles = 16;

// Rejects characters that could end the XML around the word.
std::string plain(const std::string& word, const char* what) {
  const bool isPlain = !word.empty() && word.size() < 100 && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == ':' || c == '-' || c == '_' || c == '%';
  });
  if (!isPlain) throw UsageError("{}: '{}' is neither the name of an interface nor an address", what, word);
  return word;
}

// Throws NetworkError, or Error of startThread().
void requireResources() {
  if (!canOpenFiles(kFiles))
    throw NetworkError(
        "the network needs {} more open files, and this program's limit leaves fewer; raise it (ulimit -n)", kFiles);
  const std::uint64_t free_bytes = freeAddresses_bytes();
  if (free_bytes < kAddresses_bytes)
    throw NetworkError("the network needs {} MB of addresses, and this program's limit leaves {}; raise it (ulimit -v)",
                       kAddresses_bytes / kMB, free_bytes / kMB);
  std::vector<std::jthread> threads;
  while (threads.size() < kThreads)
    threads.push_back(startThread([](const std::stop_token& stop) {
      std::mutex lock;
      std::unique_lock held(lock);
      std::condition_variable_any().wait(held, stop, [] { return false; });
    }));
}

// Collects the log messages of DDS; the last one is added to our exceptions.
class Remarks {
 public:
  // Never destroyed: threads of the library's user may still be in calls when the program ends.
  static Remarks& all() {
    static Remarks& remarks = *new Remarks;
    return remarks;
  }
  Remarks() {
    dds_set_log_sink(
        [](void* to, const dds_log_data_t* said) {
          static_cast<Remarks*>(to)->hear({said->message, said->size});
        },
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

// Within this machine a datagram holds several samples; elsewhere it is one frame, so that a loss costs only that
// frame.
constexpr const char* kWholeDatagrams = "<MaxMessageSize>65500B</MaxMessageSize>";
constexpr const char* kFrames = "<MaxMessageSize>1400B</MaxMessageSize><FragmentSize>1344B</FragmentSize>";

// On the loopback participants find each other without multicast, by their ports. All that a client has requested, some
// megabytes, may be in flight at once and be reassembled in any order. One receive thread: several are woken through
// the network at shutdown, which never returns if the interface has gone.
// Lost samples are requested at the next heartbeat: 5 ms after a write, otherwise at least every 500 ms (default: 8 s).
// They are requested again 10 ms after each further heartbeat, and without one after 300 ms (default: 3 s). On longer
// round trips they are sent more than once, which helps on a link with losses.
std::string configOf(const NetworkConfig& network) {
  if (network.domain > kLastDomain) throw UsageError("domain: {} is not between 0 and {}", network.domain, kLastDomain);
  const bool isHere = network.interface.empty();
  std::string peers;
  for (const std::string& peer : network.peers) peers += fmt::format("<Peer address=\"{}\"/>", plain(peer, "peer"));
  if (isHere) peers = "<Peer address=\"127.0.0.1\"/>" + peers;
  const std::string interface =
      isHere ? "address=\"127.0.0.1\""
             : fmt::format("{}=\"{}\"",
                           std::isdigit(static_cast<unsigned char>(network.interface[0])) ? "address" : "name",
                           plain(network.interface, "network"));
  return fmt::format(
      "<CycloneDDS><Domain id=\"any\"><General><Interfaces><NetworkInterface {}/></Interfaces>"
      "<AllowMulticast>{}</AllowMulticast>{}</General>"
      "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>40</MaxAutoParticipantIndex>"
      "<Peers>{}</Peers></Discovery>"
      "<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads><Watermarks><WhcHigh>16MB</WhcHigh></Watermarks>"
      "<PrimaryReorderMaxSamples>8192</PrimaryReorderMaxSamples><SecondaryReorderMaxSamples>8192</"
      "SecondaryReorderMaxSamples>"
      "<NackDelay>10ms</NackDelay><AutoReschedNackDelay>300ms</AutoReschedNackDelay>"
      "<HeartbeatInterval min=\"5ms\" minsched=\"20ms\" "
      "max=\"500ms\">100ms</HeartbeatInterval><MaxQueuedRexmitBytes>4MB</MaxQueuedRexmitBytes>"
      "<MaxQueuedRexmitMessages>8192</MaxQueuedRexmitMessages></Internal>"
      "</Domain></CycloneDDS>",
      interface, isHere ? "false" : "default", isHere ? kWholeDatagrams : kFrames, peers);
}

// DDS gets the contents of the files, not their paths: what was checked is what is used, whatever the folder's name.
void secure(dds_qos_t& qos, const SecurityProfile& profile) {
  if (!kCanEncrypt) throw NetworkError("this palpate's Cyclone DDS was built without security, and encrypts nothing");
  constexpr std::array<const char*, SecurityProfile::kFiles.size()> kNames{
      "dds.sec.auth.identity_ca",      "dds.sec.auth.identity_certificate", "dds.sec.auth.private_key",
      "dds.sec.access.permissions_ca", "dds.sec.access.governance",         "dds.sec.access.permissions"};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    dds_qset_prop(&qos, kNames[i], ("data:," + profile.contents[i]).c_str());
  constexpr std::array<std::array<std::string_view, 3>, 3> kPlugins{{{"auth", "dds_security_auth", "authentication"},
                                                                     {"access", "dds_security_ac", "access_control"},
                                                                     {"crypto", "dds_security_crypto", "crypto"}}};
  for (const auto& [part, library, function] : kPlugins) {
    const std::string name = fmt::format("dds.sec.{}.library.", part);
    dds_qset_prop(&qos, (name + "path").c_str(), std::string(library).c_str());
    dds_qset_prop(&qos, (name + "init").c_str(), fmt::format("init_{}", function).c_str());
    dds_qset_prop(&qos, (name + "finalize").c_str(), fmt::format("finalize_{}", function).c_str());
  }
}

void setPartition(dds_qos_t& qos, const std::string& partition) {
  if (partition.empty()) return;
  const char* name = partition.c_str();
  dds_qset_partition(&qos, 1, &name);
}

}  // namespace

dds_return_t checked(dds_return_t result, const char* what) {
  if (result < 0) throw NetworkError("{}: {}", what, dds_strretcode(-result));
  return result;
}

Qos reliableQos(bool lasting, const std::string& partition) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kWriterPatience);
  dds_qset_durability(qos.get(), lasting ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), lasting ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, lasting ? 1 : 0);
  setPartition(*qos, partition);
  return qos;
}

Qos bestEffortQos(const std::string& partition) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 64);
  setPartition(*qos, partition);
  return qos;
}

// Every participant is discovered, even if its data cannot be decrypted.
bool seesKeyHolders(dds_entity_t participant) {
  const Entity reader(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr), "a reader");
  dds_guid_t own{};
  checked(dds_get_guid(participant, &own), "the network");
  constexpr std::uint32_t kAtOnce = 256;
  std::array<void*, kAtOnce> samples{};
  std::array<dds_sample_info_t, kAtOnce> about;
  const auto count = checked(dds_take(reader, samples.data(), about.data(), kAtOnce, kAtOnce), "received data");
  bool sees = false;
  for (dds_return_t i = 0; i < count; ++i) {
    void* data = nullptr;
    std::size_t size = 0;
    const auto* other = static_cast<const dds_builtintopic_participant_t*>(samples[i]);
    if (!about[i].valid_data || std::memcmp(&other->key, &own, sizeof own) == 0) continue;
    if (!dds_qget_userdata(other->qos, &data, &size)) continue;
    sees = sees || std::string_view(static_cast<const char*>(data), size) == kHasKeys;
    dds_free(data);
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
  return sees;
}

Qos keepingLast(Qos qos, std::int32_t samples) {
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, samples);
  return qos;
}

Qos keepingInstances(Qos qos, std::int32_t instances) {
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  dds_qset_resource_limits(qos.get(), DDS_LENGTH_UNLIMITED, instances, DDS_LENGTH_UNLIMITED);
  return qos;
}

struct Participant::Domain {
  Domain(const NetworkConfig& given, const std::string& config)
      : network(given), entity(dds_create_domain(given.domain, config.c_str()), "the network") {}
  NetworkConfig network;
  Entity entity;
  int users = 0;

  // A process opens each domain once: the last user closes it under the lock under which the next one opens it.
  struct All {
    std::mutex lock;
    std::map<std::uint32_t, Domain> open;
    std::atomic<int> process = 0;  // whose domains they are; 0: none is open
  };

  // The threads of DDS, and what its locks guard, remain in the parent.
  static void requireOwn(const All& all) {
    const int process = all.process;
    if (process != 0 && process != processNumber())
      throw NetworkError(
          "this process was forked while its parent used the network, which it cannot use itself; start it as a "
          "program of its own, or before the parent serves or joins");
  }

  static std::shared_ptr<Domain> of(const NetworkConfig& network) {
    static All& all = *new All;  // never destroyed, like Remarks
    const std::string config = configOf(network);
    requireOwn(all);
    const std::scoped_lock hold(all.lock);
    Remarks::all().take();
    auto found = all.open.find(network.domain);
    if (found == all.open.end()) {
      requireResources();
      try {
        found = all.open.try_emplace(network.domain, network, config).first;
        all.process = processNumber();
      } catch (const NetworkError& error) {
        const std::string why = Remarks::all().take();
        throw NetworkError("the network of {} cannot be used: {}; is there such an interface, and does it carry IPv4?",
                           network.interface.empty() ? "this machine" : network.interface,
                           why.empty() ? error.what() : why);
      }
    }
    if (found->second.network != network)
      throw UsageError("domain: this program is already on domain {} of another network, or with other keys",
                       network.domain);
    ++found->second.users;
    return {&found->second, [found](Domain* domain) {
              const std::scoped_lock last(all.lock);
              if (--domain->users == 0) all.open.erase(found);
              if (all.open.empty()) all.process = 0;
            }};
  }
};

Participant::Participant(const NetworkConfig& network, Qos qos) : domain_(Domain::of(network)) {
  if (network.security.empty()) {
    participant_ = Entity(dds_create_participant(network.domain, qos.get(), nullptr), "the network");
    return;
  }
  if (!qos) qos.reset(dds_create_qos());
  secure(*qos, readSecurityProfile(network.security));
  std::size_t said = 0;
  if (!dds_qget_userdata(qos.get(), nullptr, &said) || said == 0)
    dds_qset_userdata(qos.get(), kHasKeys.data(), kHasKeys.size());
  Remarks::all().take();
  const dds_entity_t made = dds_create_participant(network.domain, qos.get(), nullptr);
  if (made < 0) {
    const std::string why = Remarks::all().take();
    throw NetworkError("{}: these keys cannot be used: {}", network.security,
                       why.empty() ? dds_strretcode(-made) : why);
  }
  participant_ = Entity(made, "the network");
}

void ReaderWait::attach(dds_entity_t reader) {
  conditions_.emplace_back(dds_create_readcondition(reader, DDS_ANY_STATE), "a condition");
  checked(dds_waitset_attach(wait_, conditions_.back(), 0), "a condition");
}

void ReaderWait::attach(const WakeUp& wakeUp) { checked(dds_waitset_attach(wait_, wakeUp, 0), "a condition"); }

void ReaderWait::sleep(double most_s) const {
  checked(dds_waitset_wait(wait_, nullptr, 0, static_cast<dds_duration_t>(most_s * 1e9)), "the network");
}

}  // namespace palpate::sharing
