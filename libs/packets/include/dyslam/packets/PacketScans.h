// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Scan.h>
#include <dyslam/packets/LidarPacket.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Ring of each beam: rank by elevation, 0: lowest. */
[[nodiscard]] std::vector<std::uint16_t> ringsByElevation(const std::vector<double>& elevations);

/** Makes scans of the packets of one lidar: one for each revolution, with time, ring and intensity
 * of every point. */
class PacketScans
{
 public:
  PacketScans() = default;
  virtual ~PacketScans() = default;
  PacketScans(const PacketScans&) = delete;
  PacketScans& operator=(const PacketScans&) = delete;

  /** Whether a datagram is a data packet of this kind of lidar. */
  [[nodiscard]] virtual bool takes(const LidarPacket& packet) const = 0;
  /** \pre takes(packet), and the packets are of one lidar in the order in which they were received.
   * \throws UserError for a lidar that cannot be decoded. */
  virtual void add(const LidarPacket& packet) = 0;
  /** To be called after the last packet. \throws UserError for a lidar that can't be decoded. */
  virtual void finish() = 0;
  /** The next complete scan; nothing until more packets are added. */
  [[nodiscard]] virtual std::optional<Scan> take() = 0;
  /** Whether the packets of the IMU in this kind of lidar are decoded. */
  [[nodiscard]] virtual bool readsImu() const { return false; }
  /** Whether a datagram is a packet of the IMU in this lidar. */
  [[nodiscard]] virtual bool takesImu(const LidarPacket& /*packet*/) const { return false; }
  /** \pre takesImu(packet), and the packet was received after those of the lidar added before. */
  virtual void addImu(const LidarPacket& /*packet*/) {}
  /** Samples of the IMU since the last call, in the order of their packets, with stamps by the
   * clock of the scans. T_vehicle_imu is their pose in the frame of the points. */
  [[nodiscard]] virtual std::vector<ImuSample> takeImu() { return {}; }
  /** Name of the lidar, such as "VLP16" or "OS-1-128". */
  [[nodiscard]] virtual std::string sensor() const = 0;
  /** Notes and warnings about the packets, one line each. */
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
};

/** Queue of revolutions. Each one waits for the next, so that the last is known as such: recordings
 * often begin and end within a revolution, and incomplete scans are left out. */
class RevolutionQueue
{
 public:
  /** \param keep_partial deliver also incomplete first and last revolutions.
   * \param usual_begin, usual_end angles where complete ones begin and end, in turns from the cut,
   * as long as no others tell */
  explicit RevolutionQueue(bool keep_partial, double usual_begin = 0, double usual_end = 1)
      : keep_partial_(keep_partial), usual_begin_(usual_begin), usual_end_(usual_end)
  {
  }

  /** Adds a revolution. \param begin, end angles where it begins and ends, in turns from the cut */
  void push(Scan scan, double begin, double end);
  /** To be called after the last revolution. */
  void finish() { finished_ = true; }
  /** The next complete revolution; nothing until more are pushed. */
  [[nodiscard]] std::optional<Scan> take();

 private:
  struct Revolution
  {
    Scan scan;
    double begin;
    double end;
  };
  [[nodiscard]] bool isWhole(const Revolution& revolution, bool first, bool last) const;

  bool keep_partial_;
  bool finished_ = false;
  std::deque<Revolution> waiting_;
  std::size_t pushed_ = 0;
  std::size_t taken_ = 0;  //!< number of revolutions taken, delivered or not
  double usual_begin_;     //!< begin of the second revolution
  double usual_end_;       //!< end of the latest one that is neither first nor last
};

/** Cuts the blocks of a spinning lidar, in either direction, into revolutions: where the azimuth
 * passes the cut, also if the lidar leaves out the sector around it, and at gaps of a turn or more.
 */
class RevolutionCutter
{
 public:
  /** \param cut_azimuth where scans are cut, clockwise from azimuth 0 [rad]
   * \param keep_partial deliver also incomplete first and last revolutions. */
  RevolutionCutter(double cut_azimuth, bool keep_partial);

  /** The scan that a block belongs to, which begins with this block if it is the first past the
   * cut. Blocks of packets that were overtaken, and such whose azimuth steps back by up to a
   * degree, go to the current scan. \param azimuth of the block, 0 to 35999 [0.01 deg] \param stamp
   * of the block, and of a scan that begins here, UNIX time [s] \return valid until the next call
   * of any method */
  [[nodiscard]] Scan& scanOf(int azimuth, double stamp);
  /** Direction of rotation, by most of the steps so far. */
  [[nodiscard]] bool isClockwise() const { return steps_ >= 0; }
  /** To be called after the last block. */
  void finish();
  [[nodiscard]] std::optional<Scan> take() { return queue_.take(); }

 private:
  /** Whether a block is of a packet that was overtaken. \param onward angle from the last block, in
   * the direction of rotation [0.01 deg] */
  [[nodiscard]] bool isLate(int onward, double stamp) const;
  void push();

  int cut_;  //!< azimuth of the cut [0.01 deg]
  RevolutionQueue queue_;
  Scan scan_;
  bool begun_ = false;
  int first_azimuth_ = 0;            //!< first azimuth of the scan, from the cut on [0.01 deg]
  std::optional<int> last_azimuth_;  //!< of the latest block, from the cut on [0.01 deg]
  double last_stamp_ = std::numeric_limits<double>::infinity();  //!< of the latest block [s]
  std::int64_t steps_ = 0;  //!< number of clockwise steps minus that of the others
};
}  // namespace dyslam
