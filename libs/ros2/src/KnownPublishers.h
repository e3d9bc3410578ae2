// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/ros2/Ros2Domain.h>
#include <fastdds/rtps/common/Guid.h>

#include <cstddef>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** What all publishers of a topic offer, and a subscription may therefore ask for. */
struct TopicOffer
{
  std::string dds_type;
  bool reliable = true;
  bool latched = true;  //!< transient local
};

inline bool operator==(const TopicOffer& a, const TopicOffer& b)
{
  return a.dds_type == b.dds_type && a.reliable == b.reliable && a.latched == b.latched;
}

/** The publishers of ROS 2 topics that a participant has found. Of several types of a topic, the
 * first one counts. */
class KnownPublishers : public eprosima::fastdds::dds::DomainParticipantListener
{
 public:
  /** \param changed is called after each change, in a thread of the middleware */
  explicit KnownPublishers(std::function<void()> changed) : changed_(std::move(changed)) {}

  [[nodiscard]] std::vector<Ros2Topic> topics() const;
  /** Of a topic without publishers, that of the last one; nothing if it was never published. */
  [[nodiscard]] std::optional<TopicOffer> offerOf(const std::string& topic) const;
  /** Number of changes so far. */
  [[nodiscard]] std::size_t changes() const;

  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  struct Known
  {
    TopicOffer offer;
    std::map<eprosima::fastrtps::rtps::GUID_t, TopicOffer> publishers;
  };

  std::function<void()> changed_;
  mutable std::mutex mutex_;
  std::map<std::string, Known> topics_;  //!< by name
  std::size_t changes_ = 0;
};
}  // namespace dyslam
