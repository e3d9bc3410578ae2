// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <string>

namespace dyslam
{
/** A type of messages that are passed on as they are on the network: a std::string with the
 * serialised message. */
class RawMessageType : public eprosima::fastdds::dds::TopicDataType
{
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

  /** \param dds_type as ddsTypeOf() */
  explicit RawMessageType(const std::string& dds_type);

  bool serialize(void* data, Payload* payload) override;
  bool deserialize(Payload* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new std::string(); }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void* /*data*/,
              eprosima::fastrtps::rtps::InstanceHandle_t* /*handle*/,
              bool /*force_md5*/) override
  {
    return false;  // topics of ROS 2 have no keys
  }
};
}  // namespace dyslam
