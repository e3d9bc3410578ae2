// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Serialisation of the messages of a topic. */
enum class RosEncoding
{
  ros1,   //!< packed, little-endian
  cdr,    //!< ROS 2: aligned, after four bytes that name the byte order
  other,  //!< protobuf, JSON and others that mcap allows; not decoded
};

struct BagTopic
{
  std::string name;  //!< such as "/velodyne_points"
  std::string type;  //!< in the spelling of ROS 1: "sensor_msgs/PointCloud2"
  RosEncoding encoding = RosEncoding::other;
  std::size_t messages = 0;
  double first = 0;  //!< recording time of the first message, UNIX time [s]
  double last = 0;   //!< recording time of the last message, UNIX time [s]
};

struct BagMessage
{
  std::size_t topic = 0;  //!< index in Bag::topics()
  double recorded = 0;    //!< recording time, UNIX time [s]
  std::string_view data;  //!< serialised message; valid until the next call of next()
  std::string place;      //!< for error messages: "drive.bag: message at byte 4117"
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

  /** All topics, in the order of their first appearance in the file's index. */
  [[nodiscard]] virtual const std::vector<BagTopic>& topics() const = 0;
  /** Restarts at the first message; next() then delivers only these topics.
   * \param topics indices in topics() */
  virtual void select(const std::vector<std::size_t>& topics) = 0;
  /** As select(), for the last time: what is not read by then may be forgotten, and of a source
   * that is live, next() waits for further messages from now on. */
  virtual void selectLast(const std::vector<std::size_t>& topics) { select(topics); }
  /** Reads the next message; false at the end. \throws UserError naming file and byte of damaged
   * data. */
  [[nodiscard]] virtual bool next(BagMessage& message) = 0;
  /** Whether the messages of these topics come in the order of their recording: not, if the topics
   * stand behind each other, each in order, as where bags were merged. \param topics indices in
   * topics() */
  [[nodiscard]] virtual bool isInOrder(const std::vector<std::size_t>& /*topics*/) const
  {
    return true;
  }
  /** Fraction of the file that was read, 0 to 1. */
  [[nodiscard]] virtual double progress() const = 0;
  /** Warnings about the file for the user, one line each. */
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
};

/** State of the unpacking of a bag that is compressed as a whole, which may take minutes. */
struct BagUnpacking
{
  std::string bag;          //!< path of the packed bag
  std::string folder;       //!< for temporary files, that it is unpacked to
  double fraction = 0;      //!< of the packed bag that was read, 0 to 1
  std::uint64_t bytes = 0;  //!< that were unpacked
  bool is_done = false;
};
/** Called for each packed bag when its unpacking begins, again and again, and when it is done. An
 * exception from it ends the unpacking, and removes what was unpacked. */
using BagUnpackingProgress = std::function<void(const BagUnpacking&)>;

/** The bags in a folder, the parts of one recording, in the order of their names. Left out are
 * copies: compressed ones beside those that were unpacked, and what rosbag keeps when it rewrites a
 * bag (`drive.orig.bag`). \throws UserError if they are of several kinds, or compressed otherwise
 * than with zstd. */
[[nodiscard]] std::vector<std::string> bagParts(const std::string& folder);

/** Opens a ROS 1 bag (v2.0; plain, bz2 or lz4 chunks), a ROS 2 bag of sqlite3 (`.db3`), an mcap
 * file (plain, lz4 or zstd chunks), or a folder of such files, the parts of one recording
 * (bagParts()). Of these, those with the same topics are read behind each other, those with
 * different ones side by side, in the order of the times of recording; as are the topics of a
 * file that are not in order (Bag::isInOrder()). Finds topics and counts by
 * the index, or by reading all where there is none. Files that are compressed as a whole with zstd
 * (`.db3.zstd`) are unpacked to the folder for temporary files as long as the bag is open.
 *
 * Formats: http://wiki.ros.org/Bags/Format/2.0, https://mcap.dev/spec,
 * https://github.com/ros2/rosbag2 (storage sqlite3).
 * \throws UserError naming the file, the byte and what to do; also if the folder for temporary
 * files has less room than compressed files state to need. */
[[nodiscard]] std::unique_ptr<Bag> openBag(const std::string& path,
                                           const BagUnpackingProgress& unpacking = {});

/** Table of the topics with types, counts and rates, for scans also points and frame; the scans
 * that are used by default and the topics of IMU and odometry are marked. Then the duration, and
 * the poses of lidars in `/tf_static`. */
[[nodiscard]] std::string listingOf(Bag& bag);
}  // namespace dyslam
