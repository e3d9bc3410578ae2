// SPDX-License-Identifier: BSD-3-Clause
#include "RawMessageType.h"

#include <cstdint>
#include <cstring>

namespace dyslam
{
RawMessageType::RawMessageType(const std::string& dds_type)
{
  constexpr std::uint32_t first_room = 1024;  // grows with the messages [bytes]
  setName(dds_type.c_str());
  m_typeSize = first_room;
  m_isGetKeyDefined = false;
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

bool RawMessageType::serialize(void* data, Payload* payload)
{
  const auto& message = *static_cast<const std::string*>(data);
  if (message.size() > payload->max_size || message.size() < 4)
  {
    return false;
  }
  std::memcpy(payload->data, message.data(), message.size());
  payload->length = static_cast<std::uint32_t>(message.size());
  payload->encapsulation = message[1] % 2 == 0 ? CDR_BE : CDR_LE;
  return true;
}

bool RawMessageType::deserialize(Payload* payload, void* data)
{
  static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data),
                                          payload->length);
  return true;
}

std::function<std::uint32_t()> RawMessageType::getSerializedSizeProvider(void* data)
{
  const auto size = static_cast<std::uint32_t>(static_cast<const std::string*>(data)->size());
  return [size] { return size; };
}
}  // namespace dyslam
