// SPDX-License-Identifier: BSD-3-Clause
#include "FastDdsEndpoints.h"

#include <dyslam/base/Error.h>

#include <chrono>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <memory>
#include <utility>

#include "RawMessageType.h"
#include "Ros2Names.h"

namespace dyslam
{
namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

namespace
{
double now()
{
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/** The topic of a participant. \throws UserError, also if it has the topic with another type. */
dds::Topic* topicOf(dds::DomainParticipant& participant,
                    const std::string& topic,
                    const std::string& dds_type)
{
  if (participant.find_type(dds_type).empty())
  {
    dds::TypeSupport(new RawMessageType(dds_type)).register_type(&participant);
  }
  const std::string name = ddsTopicOf(topic);
  if (auto* known = dynamic_cast<dds::Topic*>(participant.lookup_topicdescription(name)))
  {
    if (known->get_type_name() == dds_type)
    {
      return known;
    }
    (void)participant.delete_topic(known);  // fails if it is in use
  }
  dds::Topic* made = participant.create_topic(name, dds_type, dds::TOPIC_QOS_DEFAULT);
  if (made == nullptr)
  {
    throw UserError(topic + ": cannot be opened with the type " + typeOfDds(dds_type) +
                    ", as it is open with another one");
  }
  return made;
}

/** The same of readers and writers. \param depth number of messages */
template <typename Qos>
void setCommon(Qos& qos, bool reliable, bool latched, int depth)
{
  qos.reliability().kind =
      reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  qos.resource_limits().max_samples = depth;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = depth;
  qos.resource_limits().allocated_samples = 1;
  // Messages have any size; shared memory works between equal versions of the middleware only.
  qos.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
}
}  // namespace

FastDdsReader::FastDdsReader(dds::Subscriber& subscriber,
                             const std::string& topic,
                             const TopicOffer& offer,
                             MessageQueue& queue)
    : subscriber_(subscriber), topic_(topic), offer_(offer), queue_(queue)
{
  constexpr int depth = 1000;  // messages that wait for missing parts or for this thread
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  setCommon(qos, offer.reliable, offer.latched, depth);
  auto& participant = const_cast<dds::DomainParticipant&>(*subscriber.get_participant());
  reader_ = subscriber.create_datareader(topicOf(participant, topic, offer.dds_type), qos, this,
                                         dds::StatusMask::data_available());
  if (reader_ == nullptr)
  {
    throw UserError(topic + ": the middleware has made no subscription");
  }
}

FastDdsReader::~FastDdsReader()
{
  (void)reader_->set_listener(nullptr);
  (void)subscriber_.delete_datareader(reader_);
}

void FastDdsReader::on_data_available(dds::DataReader* reader)
{
  std::string data;
  dds::SampleInfo info;
  while (reader->take_next_sample(&data, &info) == ReturnCode_t::RETCODE_OK)
  {
    noteLost(info.sample_identity);
    if (info.valid_data)
    {
      queue_.put({topic_, now(), std::move(data)});
    }
    data.clear();
  }
}

void FastDdsReader::noteLost(const eprosima::fastrtps::rtps::SampleIdentity& identity)
{
  const std::uint64_t number = identity.sequence_number().to64long();
  const auto [last, is_first] = last_.emplace(identity.writer_guid(), number);
  if (!is_first && number > last->second + 1)
  {
    queue_.noteLost(topic_, static_cast<std::size_t>(number - last->second - 1));
  }
  last->second = number;
}

FastDdsPublisher::FastDdsPublisher(dds::Publisher& publisher, const Ros2PublisherOptions& options)
    : publisher_(publisher)
{
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  setCommon(qos, options.reliable, options.latched, static_cast<int>(options.depth));
  qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;  // needed for more than one datagram
  auto& participant = const_cast<dds::DomainParticipant&>(*publisher.get_participant());
  writer_ = publisher.create_datawriter(
      topicOf(participant, options.topic, ddsTypeOf(options.type)), qos);
  if (writer_ == nullptr)
  {
    throw UserError(options.topic + ": the middleware does not publish it");
  }
}

FastDdsPublisher::~FastDdsPublisher()
{
  (void)publisher_.delete_datawriter(writer_);
}

void FastDdsPublisher::publish(const std::string& data)
{
  (void)writer_->write(const_cast<std::string*>(&data));  // is copied
}

std::size_t FastDdsPublisher::subscriptions() const
{
  dds::PublicationMatchedStatus status;
  (void)writer_->get_publication_matched_status(status);
  return static_cast<std::size_t>(status.current_count);
}
}  // namespace dyslam
