// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace dyslam
{
/** A topic that a BagWriter writes. */
struct BagWriterTopic
{
  std::string name;        //!< such as "/points"
  std::string type;        //!< as ROS 2 spells it: "sensor_msgs/msg/PointCloud2"
  std::string definition;  //!< of the type and all types in it, see rosDefinition()
  /** Offered as transient_local: whoever subscribes after the message was played gets it, too. */
  bool latched = false;
};

/** Writes a ROS 2 bag as one mcap file, as a stream: at most one chunk is in memory.
 *
 * Messages are in chunks of about 4 MB, compressed with zstd, with indexes and checksums; the
 * profile is `ros2`, and topics have the `offered_qos_profiles` that `ros2 bag play` publishes them
 * with. The same messages give the same bytes.
 *
 * The file is written to `<path>.tmp` and renamed by close(); without close() it is removed, and an
 * earlier file of the name stays.
 *
 * Formats: https://mcap.dev/spec, https://github.com/ros2/rosbag2 (storage mcap).
 */
class BagWriter
{
 public:
  /** Creates the file. \throws UserError if it cannot be created. */
  explicit BagWriter(const std::string& path);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /** Adds a topic, which is in the file if it has messages. \return its number, for write() */
  std::size_t addTopic(const BagWriterTopic& topic);

  /** Writes a message. Its time of recording is that of its publication or, if that is later, the
   * time of the message before: the messages of the file are in the order of these times.
   * \param topic from addTopic() \param published nanoseconds since 1970 \param data in CDR
   * \throws UserError if the disk is full. */
  void write(std::size_t topic, std::uint64_t published, std::string_view data);

  /** Completes and renames the file. \throws UserError if that fails. */
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
