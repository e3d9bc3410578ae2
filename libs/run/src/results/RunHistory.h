// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/SwappedStore.h>
#include <dyslam/core/Frame.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Data of a scan that are kept until the end of the run. */
struct PastScan
{
  std::size_t index = 0;  //!< Frame::index
  double stamp = 0;       //!< UNIX time [s]
  double time = 0;        //!< Frame::time() [s]
  Pose T_odom_vehicle = Pose::Identity();
  std::uint32_t points = 0;         //!< number of points of its cloud
  std::uint32_t moving_points = 0;  //!< number of moving points of its cloud
  std::uint32_t mount = 0;          //!< index in RunHistory::mounts()
  bool registered = false;          //!< false: its motion was predicted, not measured
  bool keyframe = false;
};

/** An object at a scan: TrackedObject without its covariances. */
struct PastObject
{
  std::size_t scan = 0;  //!< index in RunHistory::scans()
  int id = -1;
  ObjectClass object_class = ObjectClass::unknown;
  Box box;                                             //!< odometry frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< odometry frame [m/s]
  double score = 0;
  bool dynamic = false;
  bool observed = false;
  bool reported = false;  //!< TrackedObject::reported at this scan

  [[nodiscard]] TrackedObject tracked() const;
};

/** The scans at which a track counts. */
enum class TrackLife
{
  reported,  //!< the scans at which the tracker reported it
  whole      //!< from its first to its last observation, if it was reported at any scan
};

/** All scans of a run and their objects; the objects are on disk, except for the last ones. */
class RunHistory
{
 public:
  explicit RunHistory(const MemoryLimit& memory = {}) : objects_(memory) {}

  void addScan(const Frame& frame);
  /** Adds the objects of a scan that was added before, in the order of scans.
   * \param scan Frame::index */
  void addObjects(std::size_t scan, const std::vector<TrackedObject>& objects, TrackLife life);
  void exchangeState(StateArchive& archive);

  [[nodiscard]] const std::vector<PastScan>& scans() const { return scans_; }
  /** The different values of T_vehicle_lidar. */
  [[nodiscard]] const std::vector<Pose>& mounts() const { return mounts_; }
  /** Calls `use` with every object at each scan at which it counts (TrackLife), by scan, then in
   * the order of Frame::objects. */
  void forEachObject(const std::function<void(const PastObject&)>& use) const;
  /** forEachObject() with merged tracks. Of several tracks of an object at a scan, the observed one
   * counts; if several are observed, the one with the smallest id. \param merged result of
   * findMergedTracks(): id of the object of each merged track */
  void forEachObject(const std::map<int, int>& merged,
                     const std::function<void(const PastObject&)>& use) const;

 private:
  /** Indices in scans_ of a track's first and last observation. */
  struct Observations
  {
    std::size_t first = 0;
    std::size_t last = 0;
  };
  /** A block of successive objects, for SwappedStore. */
  struct Part
  {
    std::vector<PastObject> objects;
    [[nodiscard]] std::size_t memory() const { return objects.capacity() * sizeof(PastObject); }
    [[nodiscard]] std::string toBytes() const;
    [[nodiscard]] static Part fromBytes(std::string_view bytes);
  };

  void add(std::size_t scan, const TrackedObject& object);
  /** Updates first and last observation of the tracks. \param scan index in scans_ */
  void noteObservations(std::size_t scan, const std::vector<TrackedObject>& objects);
  /** Whether the object counts at its scan, see TrackLife. */
  [[nodiscard]] bool counts(const PastObject& object) const;

  std::vector<PastScan> scans_;
  std::vector<Pose> mounts_;
  SwappedStore<Part> objects_;
  std::size_t in_last_part_ = 0;
  std::map<int, Observations> whole_;       //!< reported tracks that count as a whole
  std::map<int, Observations> unreported_;  //!< present tracks that were not reported so far
};
}  // namespace dyslam
