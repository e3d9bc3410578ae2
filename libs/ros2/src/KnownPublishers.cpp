// SPDX-License-Identifier: BSD-3-Clause
#include "KnownPublishers.h"

#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>

#include "Ros2Names.h"

namespace dyslam
{
namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

std::vector<Ros2Topic> KnownPublishers::topics() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<Ros2Topic> topics;
  for (const auto& [name, known] : topics_)
  {
    topics.push_back({name, typeOfDds(known.offer.dds_type), known.publishers.size()});
  }
  return topics;
}

std::optional<TopicOffer> KnownPublishers::offerOf(const std::string& topic) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto known = topics_.find(topic);
  return known == topics_.end() ? std::nullopt : std::optional(known->second.offer);
}

std::size_t KnownPublishers::changes() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return changes_;
}

void KnownPublishers::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                             rtps::WriterDiscoveryInfo&& info)
{
  const std::string name = topicOfDds(info.info.topicName().to_string());
  if (name.empty())
  {
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto& qos = info.info.m_qos;
    const TopicOffer offer{info.info.typeName().to_string(),
                           qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS,
                           qos.m_durability.kind >= dds::TRANSIENT_LOCAL_DURABILITY_QOS};
    const bool is_gone = info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER;
    if (is_gone && topics_.count(name) == 0)
    {
      return;
    }
    Known& known = topics_.try_emplace(name, Known{offer, {}}).first->second;
    if (is_gone)
    {
      known.publishers.erase(info.info.guid());
    }
    else
    {
      known.publishers[info.info.guid()] = offer;
    }
    bool is_first = true;
    for (const auto& [guid, other] : known.publishers)
    {
      known.offer.reliable = other.reliable && (is_first || known.offer.reliable);
      known.offer.latched = other.latched && (is_first || known.offer.latched);
      is_first = false;
    }
    ++changes_;
  }
  changed_();
}
}  // namespace dyslam
