// SPDX-License-Identifier: BSD-3-Clause
// Common parts of the readers of bags, and the functions that make the readers.
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Number of messages of a topic or connection, and the times of the first and the last. */
struct MessageSpan
{
  std::size_t messages = 0;
  double first = 0;  //!< recording time, UNIX time [s]
  double last = 0;   //!< recording time of the last message, UNIX time [s]

  /** Adds a message. \param recorded its recording time, UNIX time [s] */
  void add(double recorded) { add(MessageSpan{1, recorded, recorded}); }
  void add(const MessageSpan& other)
  {
    if (other.messages > 0)
    {
      first = messages == 0 ? other.first : std::min(first, other.first);
      last = messages == 0 ? other.last : std::max(last, other.last);
      messages += other.messages;
    }
  }
};

/** Adds messages to those that a topic has. */
inline void addMessages(const MessageSpan& added, BagTopic& topic)
{
  MessageSpan all{topic.messages, topic.first, topic.last};
  all.add(added);
  topic.messages = all.messages;
  topic.first = all.first;
  topic.last = all.last;
}

/** Whether two topics, of connections or of parts of a recording, are the same. */
[[nodiscard]] inline bool isSameTopic(const BagTopic& a, const BagTopic& b)
{
  return a.name == b.name && a.type == b.type && a.encoding == b.encoding;
}

/** Seconds of a time; whole seconds and the rest are converted separately, to lose no digits. */
template <typename Integer>
[[nodiscard]] double secondsOfNanoseconds(Integer nanoseconds)
{
  constexpr Integer second = 1000000000;
  return static_cast<double>(nanoseconds / second) +
         1e-9 * static_cast<double>(nanoseconds % second);
}

/** Whether a bag is compressed as a whole with zstd, as rosbag2 does; such bags are read. */
[[nodiscard]] inline bool isZstdBag(const std::string& path)
{
  return isPackedBag(path) && unpackCommand(path) == "zstd -d";
}

/** "sensor_msgs/PointCloud2" for ROS 2's "sensor_msgs/msg/PointCloud2". */
[[nodiscard]] std::string plainRosType(std::string type);

/** A bag to read. */
struct BagFile
{
  std::string path;  //!< of the bag, or of what it was unpacked to
  std::string name;  //!< path of the bag as given, for messages
};

[[nodiscard]] std::unique_ptr<Bag> openRos1Bag(const BagFile& file);
[[nodiscard]] std::unique_ptr<Bag> openMcap(const BagFile& file);
[[nodiscard]] std::unique_ptr<Bag> openSqliteBag(const BagFile& file);
/** Opens the files of one recording, see openBag(). */
[[nodiscard]] std::unique_ptr<Bag> openParts(const std::vector<std::string>& paths,
                                             const BagUnpackingProgress& unpacking);
}  // namespace dyslam
