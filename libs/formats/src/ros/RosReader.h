// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>

#include "ByteReader.h"

namespace dyslam
{
/** A std_msgs/Header. */
struct RosHeader
{
  double stamp = 0;  //!< UNIX time [s]
  std::string frame;
};

/** A reader that stands at the first field of a message, whichever way it is serialised.
 * \throws UserError if it is neither ROS 1 nor plain CDR. */
inline ByteReader rosReader(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader(message.data, message.place + " of " + topic.name);
  if (topic.encoding == RosEncoding::cdr)
  {
    const auto head = reader.take(4);
    const auto kind = static_cast<unsigned char>(head[1]);
    const bool second =
        kind == 6 || kind == 7;  // XCDR2: numbers of 8 bytes stand at multiples of 4
    if (head[0] != 0 || (kind > 1 && !second))
    {
      reader.fail("is not in plain CDR (kind " + std::to_string(kind) + ")");
    }
    reader.setBigEndian(kind % 2 == 0);
    reader.alignFromHere(second ? 4 : 8);
  }
  return reader;
}

inline std::string rosString(ByteReader& reader)
{
  std::string text(reader.block());
  while (!text.empty() && text.back() == '\0')
  {
    text.pop_back();  // CDR counts the final zero
  }
  return text;
}

inline RosHeader rosHeader(ByteReader& reader, RosEncoding encoding)
{
  if (encoding == RosEncoding::ros1)
  {
    (void)reader.u32();  // sequence number
  }
  RosHeader header;
  header.stamp = reader.rosTime();
  header.frame = plainFrame(rosString(reader));
  return header;
}
}  // namespace dyslam
