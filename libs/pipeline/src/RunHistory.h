// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/SwappedStore.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
class StateArchive;

/** What is kept of a scan until the end of the run. */
struct PastScan
{
  std::size_t index = 0;  //!< Frame::index
  double stamp = 0;       //!< [s]
  Pose T_odom_vehicle = Pose::Identity();
  std::uint32_t points = 0;         //!< used of it
  std::uint32_t moving_points = 0;  //!< of these
  std::uint32_t mount = 0;          //!< position in RunHistory::mounts()
  bool registered = false;          //!< false: its motion was predicted, not measured
  bool keyframe = false;
};

/** An object as it was reported at a scan: TrackedObject without its covariances. */
struct ReportedObject
{
  std::size_t scan = 0;  //!< position in RunHistory::scans()
  int id = -1;
  ObjectClass object_class = ObjectClass::unknown;
  Box box;                                             //!< odometry frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< odometry frame [m/s]
  double score = 0;
  bool dynamic = false;
  bool observed = false;

  [[nodiscard]] TrackedObject tracked() const;
};

/** All scans of a run and the objects that were reported at them; the objects on disk, but for the
 * last ones. */
class RunHistory
{
 public:
  explicit RunHistory(const MemoryLimit& memory = {}) : objects_(memory) {}

  void add(const Frame& frame);
  void exchangeState(StateArchive& archive);

  [[nodiscard]] const std::vector<PastScan>& scans() const { return scans_; }
  /** T_vehicle_lidar, the different ones. */
  [[nodiscard]] const std::vector<Pose>& mounts() const { return mounts_; }
  /** Calls `use` with every reported object, by scan, then in the order of Frame::objects. */
  void forEachReported(const std::function<void(const ReportedObject&)>& use) const;

 private:
  /** Objects that were reported one after the other. */
  struct Part
  {
    std::vector<ReportedObject> objects;
    [[nodiscard]] std::size_t memory() const { return objects.capacity() * sizeof(ReportedObject); }
    [[nodiscard]] std::string toBytes() const;
    [[nodiscard]] static Part fromBytes(std::string_view bytes);
  };

  std::vector<PastScan> scans_;
  std::vector<Pose> mounts_;
  SwappedStore<Part> objects_;
  std::size_t in_last_part_ = 0;
};
}  // namespace dyslam
