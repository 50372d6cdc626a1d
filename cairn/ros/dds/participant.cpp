// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/ros/dds/participant.hpp>

#include <dds/dds.h>
#include <unistd.h>

#include <cairn/core/error.hpp>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>

#include <cairn/ros/dds/cdr_type.hpp>

namespace cairn::ros {
namespace {

/// Larger domains have no ports (7400 + 250 · domain).
constexpr unsigned kLastDomain = 232;
/// How long a writer waits for slow readers; the same as in ROS.
constexpr dds_duration_t kMaxBlocking = DDS_MSECS(100);

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::uint32_t domain_id() {
  const std::string text = environment("ROS_DOMAIN_ID");
  if (text.empty()) return 0;
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc{} || end != text.data() + text.size() || id > kLastDomain)
    throw Error("ROS_DOMAIN_ID: found " + text + ", expected 0 ... " + std::to_string(kLastDomain));
  return id;
}

std::string configured(const std::string& domain) {
  return "<CycloneDDS><Domain>" + domain + "</Domain></CycloneDDS>";
}

/// Unicast to this computer only, as loopback has no multicast.
std::string localhost_discovery(const std::string& general) {
  return configured("<General>" + general +
                    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto"
                    "</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
                    R"(<Peers><Peer address="127.0.0.1"/></Peers></Discovery>)");
}

/// As requested by ROS_LOCALHOST_ONLY (up to Humble) and ROS_AUTOMATIC_DISCOVERY_RANGE (from Iron on).
std::string discovery_range() {
  const std::string localhost_only = environment("ROS_LOCALHOST_ONLY");
  if (localhost_only == "1") {
    return localhost_discovery(R"(<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>)");
  }
  if (!localhost_only.empty() && localhost_only != "0")
    throw Error("ROS_LOCALHOST_ONLY: found " + localhost_only + ", expected 0 or 1");
  const std::string range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  if (range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT") return "";
  if (range == "LOCALHOST") return localhost_discovery("");
  if (range == "OFF") {
    return configured(
        "<General><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>none"
        "</ParticipantIndex><Tag>cairn_alone_" +
        std::to_string(::getpid()) + "</Tag></Discovery>");
  }
  throw Error("ROS_AUTOMATIC_DISCOVERY_RANGE: found " + range +
              ", expected SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
}

/// The prefix of errors that concern the whole domain.
std::string domain_words(std::uint32_t id) {
  const std::string uri = environment("CYCLONEDDS_URI");
  return "DDS domain " + std::to_string(id) + (uri.empty() ? "" : " with CYCLONEDDS_URI=" + uri);
}

/// Cyclone prints a line for each packet that a link without network refuses, 25 a second: each text once in ten seconds.
void print_seldom(void* /*unused*/, const dds_log_data_t* line) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kInterval = std::chrono::seconds(10);
  constexpr std::size_t kMostTexts = 100;
  constexpr std::size_t kCompared = 60;  // addresses and error codes follow
  static std::mutex mutex;
  static std::map<std::string, Clock::time_point> last;
  const std::string text(line->message, std::strcspn(line->message, "\n"));
  {
    const std::lock_guard lock(mutex);
    if (last.size() > kMostTexts) last.clear();
    Clock::time_point& before = last[text.substr(0, kCompared)];
    if (before != Clock::time_point{} && Clock::now() - before < kInterval) return;
    before = Clock::now();
  }
  std::fprintf(stderr, "cairn: DDS: %s\n", text.c_str());
}

/// The configuration of a domain in this process: created with the first participant, destroyed with the
/// last.
std::shared_ptr<Entity> domain_of(const DomainSettings& settings) {
  struct Known {
    std::weak_ptr<Entity> domain;
    std::string configuration;
  };
  static std::mutex mutex;
  static std::map<std::uint32_t, Known> all;
  if (settings.configuration.empty()) return nullptr;
  const auto refuse = [&] {
    throw Error("DDS domain " + std::to_string(settings.id) +
                ": this process uses it for ROS topics, expected another one for agents (--fleet-domain)");
  };
  const std::lock_guard lock(mutex);
  Known& known = all[settings.id];
  if (auto domain = known.domain.lock()) {
    if (settings.is_own && known.configuration != settings.configuration) refuse();
    return domain;
  }
  if (settings.is_own) dds_set_log_sink(&print_seldom, nullptr);
  const dds_entity_t domain = dds_create_domain(settings.id, settings.configuration.c_str());
  if (domain == DDS_RETCODE_PRECONDITION_NOT_MET) {  // created elsewhere in this process
    if (settings.is_own) refuse();
    return nullptr;
  }
  auto made = std::make_shared<Entity>(domain, domain_words(settings.id));
  known = {made, settings.configuration};
  return made;
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos make_qos(std::string_view ros_type, bool reliable, int depth, bool latched) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kMaxBlocking);
  dds_qset_durability(qos.get(), latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  if (latched) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  if (const std::string_view hash = type_hash(ros_type); !hash.empty()) {
    const std::string data = "typehash=" + std::string(hash) + ";";
    dds_qset_userdata(qos.get(), data.data(), data.size());
  }
  return qos;
}

struct Topic {
  Entity entity;
  const ddsi_sertype* type = nullptr;
};

Topic make_topic(const Participant& participant, const std::string& topic, const TopicType& topic_type) {
  ddsi_sertype* type = make_cdr_type(dds_type_name(topic_type.ros), topic_type.key);
  const dds_entity_t handle = dds_create_topic_sertype(participant.handle(), ("rt" + topic).c_str(), &type,
                                                       nullptr, nullptr, nullptr);
  if (handle < 0) ddsi_sertype_unref(type);
  return {Entity(handle, topic), type};
}

}  // namespace

// ---- handles ----

Entity::Entity(std::int32_t handle, const std::string& what) : handle_(handle) {
  if (handle < 0) {
    handle_ = 0;
    throw Error(what + ": DDS refuses it: " + dds_strretcode(handle));
  }
}

Entity& Entity::operator=(Entity&& other) noexcept {
  if (this != &other) {
    reset();
    handle_ = std::exchange(other.handle_, 0);
  }
  return *this;
}

void Entity::reset() {
  if (handle_ > 0) dds_delete(handle_);
  handle_ = 0;
}

// ---- domain ----

DomainSettings domain_of_environment() {
  DomainSettings settings{domain_id(), discovery_range()};
  if (const std::string uri = environment("CYCLONEDDS_URI"); !settings.configuration.empty() && !uri.empty())
    settings.configuration += "," + uri;
  return settings;
}

DomainSettings domain_of_fleet(std::uint32_t id, const std::string& interface) {
  if (id > kLastDomain) {
    throw Error("fleet domain: found " + std::to_string(id) + ", expected 0 ... " +
                std::to_string(kLastDomain));
  }
  if (interface.find_first_of("<>&\"'") != std::string::npos)
    throw Error("fleet interface: found " + interface + ", expected the name of a network interface");
  std::string settings =
      interface.empty()
          ? localhost_discovery(R"(<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>)")
          : configured("<General><Interfaces><NetworkInterface name=\"" + interface +
                       "\"/></Interfaces></General>");
  settings += "," + configured("<Discovery><SPDPInterval>1s</SPDPInterval></Discovery>");
  if (const std::string uri = environment("CYCLONEDDS_URI"); !uri.empty()) settings += "," + uri;
  return {id, settings, true};
}

Participant::Participant(const DomainSettings& settings)
    : id_(settings.id),
      domain_(domain_of(settings)),
      participant_(dds_create_participant(settings.id, nullptr, nullptr), domain_words(settings.id)) {}

std::string checked_name(const std::string& name, const std::string& option) {
  const std::string full = name.starts_with('/') ? name : "/" + name;
  bool is_name = full.size() > 1;
  char before = 0;
  for (const char c : full) {
    const bool begins = before == '/' || before == 0;
    const bool fits = c == '/' ? before != '/'
                               : (std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_' ||
                                  (!begins && std::isdigit(static_cast<unsigned char>(c)) != 0));
    is_name = is_name && fits;
    before = c;
  }
  if (!is_name || before == '/') {
    throw Error(option + ": found \"" + name +
                "\", expected a ROS name: letters, digits and _ between slashes, not beginning with a "
                "digit");
  }
  return full;
}

std::string dds_type_name(std::string_view ros_type) {
  const std::size_t first = ros_type.find('/');
  const std::size_t last = ros_type.rfind('/');
  return std::string(ros_type.substr(0, first)) +
         "::" + std::string(ros_type.substr(first + 1, last - first - 1)) +
         "::dds_::" + std::string(ros_type.substr(last + 1)) + "_";
}

// ---- writing ----

BytesWriter::BytesWriter(const Participant& participant, const std::string& topic, const TopicType& type,
                         WriterQos qos) {
  Topic made = make_topic(participant, topic, type);
  const Qos how = make_qos(type.ros, true, qos.depth, qos.latched);
  if (qos.lease) dds_qset_liveliness(how.get(), DDS_LIVELINESS_MANUAL_BY_TOPIC, qos.lease->count());
  // What a reader holds of a writer that has gone is still true.
  dds_qset_writer_data_lifecycle(how.get(), false);
  writer_ = Entity(dds_create_writer(participant.handle(), made.entity.handle(), how.get(), nullptr), topic);
  topic_ = std::move(made.entity);
  type_ = made.type;
}

bool BytesWriter::has_reader() const {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(writer_.handle(), &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

bool BytesWriter::write(Bytes message) {
  ddsi_serdata* const data = make_cdr_data(static_cast<const ddsi_sertype*>(type_), std::move(message));
  return data != nullptr && dds_writecdr(writer_.handle(), data) == DDS_RETCODE_OK;
}

void BytesWriter::assert_alive() const {
  dds_assert_liveliness(writer_.handle());
}

bool BytesWriter::wait_for_readers(std::chrono::nanoseconds timeout) const {
  return dds_wait_for_acks(writer_.handle(), timeout.count()) == DDS_RETCODE_OK;
}

// ---- reading ----

BytesReader::BytesReader(const Participant& participant, const std::string& topic, const TopicType& type,
                         ReaderQos qos) {
  Topic made = make_topic(participant, topic, type);
  reader_ = Entity(dds_create_reader(participant.handle(), made.entity.handle(),
                                     make_qos(type.ros, qos.reliable, qos.depth, qos.latched).get(), nullptr),
                   topic);
  topic_ = std::move(made.entity);
}

std::optional<BytesReader::Change> BytesReader::take_change() {
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info{};
  if (dds_takecdr(reader_.handle(), &data, 1, &info, DDS_ANY_STATE) <= 0 || data == nullptr)
    return std::nullopt;
  const std::unique_ptr<ddsi_serdata, decltype(&ddsi_serdata_unref)> owned(data, &ddsi_serdata_unref);
  const auto bytes = bytes_of(data);
  const bool is_alive = info.instance_state == DDS_IST_ALIVE;
  return Change{{bytes.begin(), bytes.end()}, info.valid_data, is_alive};
}

std::optional<Bytes> BytesReader::take() {
  while (std::optional<Change> change = take_change()) {
    if (change->has_message) return std::move(change->bytes);  // else a writer disappeared
  }
  return std::nullopt;
}

std::uint64_t BytesReader::lost() const {
  dds_sample_lost_status_t status{};
  return dds_get_sample_lost_status(reader_.handle(), &status) == DDS_RETCODE_OK ? status.total_count : 0;
}

bool BytesReader::has_writer() const {
  dds_subscription_matched_status_t status{};
  return dds_get_subscription_matched_status(reader_.handle(), &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

ReaderWait::ReaderWait(const Participant& participant, const std::vector<const BytesReader*>& readers)
    : waitset_(dds_create_waitset(participant.handle()), "DDS") {
  const auto attach = [&](std::int32_t condition) {
    if (const dds_return_t done = dds_waitset_attach(waitset_.handle(), condition, 0); done != DDS_RETCODE_OK)
      throw Error(std::string("DDS: cannot wait for messages: ") + dds_strretcode(done));
  };
  for (const BytesReader* reader : readers) {
    conditions_.emplace_back(dds_create_readcondition(reader->handle(), DDS_ANY_STATE), "DDS");
    attach(conditions_.back().handle());
  }
}

bool ReaderWait::wait(std::chrono::nanoseconds timeout) const {
  return dds_waitset_wait(waitset_.handle(), nullptr, 0, timeout.count()) > 0;
}

}  // namespace cairn::ros
