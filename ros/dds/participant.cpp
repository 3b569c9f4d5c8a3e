// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/participant.hpp"

#include <algorithm>
#include <array>

#include "dds/names.hpp"
#include "edged/core/check.hpp"

namespace edged::ros2 {
namespace {

constexpr std::string_view kEnclave = "enclave=/;";
constexpr std::size_t kTakenAtOnce = 16;
constexpr std::size_t kMostWriters = 64;  // that a reader remembers

using QosHandle = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

QosHandle new_qos(std::string_view user_data) {
  QosHandle qos(dds_create_qos(), &dds_delete_qos);
  if (!user_data.empty()) dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  return qos;
}

QosHandle endpoint_qos(const Qos& wanted, std::string_view type) {
  QosHandle qos = new_qos(type_hash_data(type));
  dds_qset_reliability(qos.get(), wanted.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       wanted.longest_block.count());
  dds_qset_durability(qos.get(), wanted.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  return qos;
}

/// A policy that readers ask for and writers offer.
std::string policy_name(std::uint32_t id) {
  static const std::map<std::uint32_t, const char*> kNames = {{DDS_RELIABILITY_QOS_POLICY_ID, "reliability"},
                                                              {DDS_DURABILITY_QOS_POLICY_ID, "durability"},
                                                              {DDS_DEADLINE_QOS_POLICY_ID, "deadline"},
                                                              {DDS_LIVELINESS_QOS_POLICY_ID, "liveliness"},
                                                              {DDS_OWNERSHIP_QOS_POLICY_ID, "ownership"}};
  const auto found = kNames.find(id);
  return found == kNames.end() ? "policy " + std::to_string(id) : found->second;
}

std::pair<Entity, const ddsi_sertype*> make_topic(const Participant& participant, const std::string& topic,
                                                  std::string_view type) {
  ddsi_sertype* raw_type = make_raw_type(dds_type(type));
  Entity entity(
      dds_create_topic_sertype(participant.handle(), dds_topic(topic).c_str(), &raw_type, nullptr, nullptr, nullptr),
      topic);
  return {std::move(entity), raw_type};  // which may be one that was there
}

}  // namespace

Entity::Entity(dds_entity_t handle, const std::string& what) : handle_(handle) {
  if (handle < 0) throw InputError::format("DDS: {}: {}", what, dds_strretcode(handle));
}

Guid guid_of(dds_entity_t entity) {
  dds_guid_t guid;
  EDGED_CHECK(dds_get_guid(entity, &guid) == DDS_RETCODE_OK, "no guid of {}", entity);
  return Guid(std::begin(guid.v), std::end(guid.v));
}

Participant::Participant(const Discovery& discovery) {
  const dds_entity_t domain = dds_create_domain(discovery.domain, cyclone_config(discovery).c_str());
  if (domain != DDS_RETCODE_PRECONDITION_NOT_MET)  // else the process has it
    domain_ = Entity(domain, "no network interface is up, or CYCLONEDDS_URI is wrong");
  const QosHandle qos = new_qos(kEnclave);
  participant_ = Entity(dds_create_participant(discovery.domain, qos.get(), nullptr),
                        fmt::format("no network for domain {}; is an interface up?", discovery.domain));
}

Guid Participant::guid() const { return guid_of(handle()); }

Writer::Writer(const Participant& participant, const std::string& topic, std::string_view type, const Qos& qos) {
  std::tie(topic_, type_) = make_topic(participant, topic, type);
  const QosHandle wanted = endpoint_qos(qos, type);
  const auto depth = static_cast<std::int32_t>(qos.depth);
  // Cyclone never waits for the readers of a writer that keeps the last messages.
  const bool keeps_all = qos.reliable && qos.longest_block > Duration(0);
  dds_qset_history(wanted.get(), keeps_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_durability_service(wanted.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(wanted.get(), false);
  writer_ = Entity(dds_create_writer(participant.handle(), topic_.handle(), wanted.get(), nullptr), topic);
}

bool Writer::write(std::string_view cdr) const {
  return dds_writecdr(writer_.handle(), make_raw_message(type_, cdr)) == DDS_RETCODE_OK;
}

std::size_t Writer::readers() const {
  dds_publication_matched_status_t status = {};
  dds_get_publication_matched_status(writer_.handle(), &status);
  return status.current_count;
}

std::string Writer::refused_policy() const {
  dds_offered_incompatible_qos_status_t status = {};
  dds_get_offered_incompatible_qos_status(writer_.handle(), &status);
  return status.total_count == 0 ? "" : policy_name(status.last_policy_id);
}

void Writer::flush(Duration longest) const { dds_wait_for_acks(writer_.handle(), longest.count()); }

Guid Writer::guid() const { return guid_of(handle()); }

Reader::Reader(const Participant& participant, const std::string& topic, std::string_view type, const Qos& qos)
    : reliable_(qos.reliable), topic_(make_topic(participant, topic, type).first) {
  const QosHandle wanted = endpoint_qos(qos, type);
  const auto depth = static_cast<std::int32_t>(qos.depth);
  dds_qset_history(wanted.get(), DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_resource_limits(wanted.get(), depth, DDS_LENGTH_UNLIMITED, depth);
  reader_ = Entity(dds_create_reader(participant.handle(), topic_.handle(), wanted.get(), nullptr), topic);
}

std::vector<std::unique_ptr<RawMessage>> Reader::take() {
  std::array<ddsi_serdata*, kTakenAtOnce> taken;
  std::array<dds_sample_info_t, kTakenAtOnce> infos;
  const dds_return_t count = dds_takecdr(reader_.handle(), taken.data(), kTakenAtOnce, infos.data(), DDS_ANY_STATE);
  std::vector<std::unique_ptr<RawMessage>> messages;
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    auto message = std::make_unique<RawMessage>(taken[i]);
    if (!infos[i].valid_data) continue;  // a writer has left
    note(message->origin());
    messages.push_back(std::move(message));
  }
  return messages;
}

/// A writer that is new may have sent before.
void Reader::note(const Origin& origin) {
  if (origin.number == 0) return;
  if (newest_.size() >= kMostWriters) newest_.clear();
  const auto [entry, is_new] = newest_.try_emplace(origin.writer, origin.number);
  if (!is_new && origin.number > entry->second) missing_ += origin.number - entry->second - 1;
  entry->second = origin.number;
}

std::size_t Reader::writers() const {
  dds_subscription_matched_status_t status = {};
  dds_get_subscription_matched_status(reader_.handle(), &status);
  return status.current_count;
}

std::size_t Reader::lost() const {
  if (!reliable_) {  // what was refused is missing, too
    const std::size_t missing = missing_, refused = this->refused();
    return missing - std::min(missing, refused);
  }
  dds_sample_lost_status_t status = {};
  dds_get_sample_lost_status(reader_.handle(), &status);
  return status.total_count;
}

std::size_t Reader::refused() const {
  dds_sample_rejected_status_t status = {};
  dds_get_sample_rejected_status(reader_.handle(), &status);
  return status.total_count;
}

std::string Reader::refused_policy() const {
  dds_requested_incompatible_qos_status_t status = {};
  dds_get_requested_incompatible_qos_status(reader_.handle(), &status);
  return status.total_count == 0 ? "" : policy_name(status.last_policy_id);
}

Guid Reader::guid() const { return guid_of(handle()); }

}  // namespace edged::ros2
