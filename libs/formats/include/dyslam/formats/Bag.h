// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** How the messages of a topic are serialised. */
enum class RosEncoding
{
  ros1,   //!< packed, little-endian
  cdr,    //!< ROS 2: aligned, after four bytes that name the byte order
  other,  //!< protobuf, JSON and others that mcap allows; not decoded
};

struct BagTopic
{
  std::string name;  //!< "/velodyne_points"
  std::string type;  //!< as ROS 1 writes it: "sensor_msgs/PointCloud2"
  RosEncoding encoding = RosEncoding::other;
  std::size_t messages = 0;
  double first = 0;  //!< recording time of the first message, UNIX time [s]
  double last = 0;   //!< ... of the last message
};

struct BagMessage
{
  std::size_t topic = 0;  //!< position in Bag::topics()
  double recorded = 0;    //!< UNIX time [s]
  std::string_view data;  //!< valid until the next call of next()
  std::string place;      //!< for messages: "drive.bag: message at byte 4117"
};

/** A recording of ROS messages, read as a stream in the order of the file.
 *
 * A file that is cut short or was never closed delivers every whole chunk, with a warning. One
 * thread at a time may use it.
 */
class Bag
{
 public:
  Bag() = default;
  virtual ~Bag() = default;
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /** In the order of their first appearance in the file's index. */
  [[nodiscard]] virtual const std::vector<BagTopic>& topics() const = 0;
  /** From now on next() delivers only these topics, from the first message on.
   * \param topics positions in topics(). */
  virtual void select(const std::vector<std::size_t>& topics) = 0;
  /** False at the end. \throws UserError naming the file and the byte of damaged data. */
  [[nodiscard]] virtual bool next(BagMessage& message) = 0;
  /** Part of the file that was read, 0 to 1. */
  [[nodiscard]] virtual double progress() const = 0;
  /** What the user should know about the file, one line each. */
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
};

/** Opens a ROS 1 bag (v2.0; plain, bz2 or lz4 chunks), a ROS 2 bag of sqlite3 (`.db3`), an mcap
 * file (plain, lz4 or zstd chunks), or a folder of such files, the parts of one recording in the
 * order of their names. Finds topics and counts by the index, or by reading all where there is
 * none.
 *
 * Formats: http://wiki.ros.org/Bags/Format/2.0, https://mcap.dev/spec,
 * https://github.com/ros2/rosbag2 (storage sqlite3).
 * \throws UserError naming the file, the byte and what to do. */
[[nodiscard]] std::unique_ptr<Bag> openBag(const std::string& path);

/** Topics with types, counts and rates, of scans also points and frame, as lines of a table; the
 * scans that are taken by default and the topics of IMU and odometry are marked. Then the duration,
 * and the poses of lidars that `/tf_static` has. */
[[nodiscard]] std::string listingOf(Bag& bag);
}  // namespace dyslam
