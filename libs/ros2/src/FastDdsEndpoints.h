// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/ros2/Ros2Domain.h>
#include <fastdds/rtps/common/SampleIdentity.h>

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <string>

#include "KnownPublishers.h"
#include "MessageQueue.h"

namespace dyslam
{
/** Puts the messages of one topic into the queue while it exists. Both others outlive it. */
class FastDdsReader : public eprosima::fastdds::dds::DataReaderListener
{
 public:
  /** \throws UserError */
  FastDdsReader(eprosima::fastdds::dds::Subscriber& subscriber,
                const std::string& topic,
                const TopicOffer& offer,
                MessageQueue& queue);
  ~FastDdsReader() override;
  FastDdsReader(const FastDdsReader&) = delete;
  FastDdsReader& operator=(const FastDdsReader&) = delete;

  [[nodiscard]] const TopicOffer& offer() const { return offer_; }

  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override;

 private:
  /** Counts the messages between the last one of a publisher and this one. */
  void noteLost(const eprosima::fastrtps::rtps::SampleIdentity& identity);

  eprosima::fastdds::dds::Subscriber& subscriber_;
  std::string topic_;
  TopicOffer offer_;
  MessageQueue& queue_;
  /** Numbers of the last messages, by publisher; of the thread that receives. */
  std::map<eprosima::fastrtps::rtps::GUID_t, std::uint64_t> last_;
  eprosima::fastdds::dds::DataReader* reader_ = nullptr;
};

class FastDdsPublisher : public Ros2Publisher
{
 public:
  /** \throws UserError */
  FastDdsPublisher(eprosima::fastdds::dds::Publisher& publisher,
                   const Ros2PublisherOptions& options);
  ~FastDdsPublisher() override;

  void publish(const std::string& data) override;
  [[nodiscard]] std::size_t subscriptions() const override;

 private:
  eprosima::fastdds::dds::Publisher& publisher_;
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
};
}  // namespace dyslam
