// SPDX-License-Identifier: BSD-3-Clause
// A domain of ROS 2 by Fast DDS, its default middleware.
#include <dyslam/base/Error.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/base/Version.h>
#include <dyslam/ros2/Ros2Domain.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "FastDdsEndpoints.h"
#include "KnownPublishers.h"
#include "MessageQueue.h"

namespace dyslam
{
namespace dds = eprosima::fastdds::dds;

namespace
{
/** Shared memory of another version of the middleware is not understood, so that only UDP is
 * offered. */
dds::DomainParticipantQos participantQos(bool localhost_only)
{
  constexpr std::uint32_t buffer = 32U << 20U;  // of a socket, as far as the system grants it
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->sendBufferSize = buffer;
  udp->receiveBufferSize = buffer;
  if (localhost_only)
  {
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
  }
  dds::DomainParticipantQos qos =
      dds::DomainParticipantFactory::get_instance()->get_default_participant_qos();
  qos.name("dyslam");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {udp};
  return qos;
}

class FastDdsDomain : public Ros2Domain
{
 public:
  explicit FastDdsDomain(const Ros2DomainOptions& options)
      : id_(options.id), known_([this] { queue_.wake(); })
  {
    dds::Log::ClearConsumers();  // what it prints would be among the results
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;  // own topics: no need
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
    auto* factory = dds::DomainParticipantFactory::get_instance();
    (void)factory->load_profiles();
    participant_ = factory->create_participant(options.id, participantQos(options.localhost_only),
                                               &known_, dds::StatusMask::none());
    if (participant_ == nullptr)
    {
      throw UserError("ROS 2 domain " + std::to_string(options.id) +
                      ": cannot be joined; is there a network?");
    }
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  }
  ~FastDdsDomain() override
  {
    subscribed_.clear();
    (void)participant_->set_listener(nullptr);
    (void)participant_->delete_contained_entities();
    (void)dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  [[nodiscard]] unsigned id() const override { return id_; }
  [[nodiscard]] std::vector<Ros2Topic> topics() const override { return known_.topics(); }

  void subscribe(const std::string& topic) override
  {
    (void)subscribed_[topic];
    openReaders();
  }
  void unsubscribe(const std::string& topic) override { subscribed_.erase(topic); }

  [[nodiscard]] bool receive(Ros2Message& message, std::chrono::milliseconds wait) override
  {
    if (known_.changes() != seen_changes_)
    {
      openReaders();
    }
    return queue_.take(message, wait);
  }
  [[nodiscard]] std::size_t lost(const std::string& topic) const override
  {
    return queue_.lost(topic);
  }
  [[nodiscard]] std::unique_ptr<Ros2Publisher> advertise(
      const Ros2PublisherOptions& options) override
  {
    return std::make_unique<FastDdsPublisher>(*publisher_, options);
  }

 private:
  /** Opens those of topics whose publishers were found, or offer something else now. */
  void openReaders()
  {
    seen_changes_ = known_.changes();
    for (auto& [topic, reader] : subscribed_)
    {
      const auto offer = known_.offerOf(topic);
      if (offer && (!reader || !(reader->offer() == *offer)))
      {
        reader.reset();
        reader = std::make_unique<FastDdsReader>(*subscriber_, topic, *offer, queue_);
      }
    }
  }

  unsigned id_;
  MessageQueue queue_;
  KnownPublishers known_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  std::map<std::string, std::unique_ptr<FastDdsReader>> subscribed_;  //!< null: not found yet
  std::size_t seen_changes_ = 0;
};
}  // namespace
}  // namespace dyslam

// The functions of the module `ros2`.
extern "C"
{
  dyslam::RuntimeModuleVersion dyslam_module_version;
  dyslam::OpenRos2Domain dyslam_open_ros2_domain;

  const char* dyslam_module_version()
  {
    return DYSLAM_VERSION;
  }

  dyslam::Ros2Domain* dyslam_open_ros2_domain(const dyslam::Ros2DomainOptions& options)
  {
    return std::make_unique<dyslam::FastDdsDomain>(options).release();
  }
}
