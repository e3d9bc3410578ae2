// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/SwappedStore.h>

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

/** What is kept of a scan until the end of the run. */
struct PastScan
{
  std::size_t index = 0;  //!< Frame::index
  double stamp = 0;       //!< [s]
  double time = 0;        //!< Frame::time() [s]
  Pose T_odom_vehicle = Pose::Identity();
  std::uint32_t points = 0;         //!< used of it
  std::uint32_t moving_points = 0;  //!< of these
  std::uint32_t mount = 0;          //!< position in RunHistory::mounts()
  bool registered = false;          //!< false: its motion was predicted, not measured
  bool keyframe = false;
};

/** An object at a scan: TrackedObject without its covariances. */
struct PastObject
{
  std::size_t scan = 0;  //!< position in RunHistory::scans()
  int id = -1;
  ObjectClass object_class = ObjectClass::unknown;
  Box box;                                             //!< odometry frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< odometry frame [m/s]
  double score = 0;
  bool dynamic = false;
  bool observed = false;
  bool reported = false;  //!< by the tracker, at this scan

  [[nodiscard]] TrackedObject tracked() const;
};

/** The scans at which a track counts. */
enum class TrackLife
{
  reported,  //!< those at which the tracker reported it
  whole      //!< if it was reported at one: from its first observation to its last
};

/** All scans of a run and the objects at them; the objects on disk, but for the last ones. */
class RunHistory
{
 public:
  explicit RunHistory(const MemoryLimit& memory = {}) : objects_(memory) {}

  void addScan(const Frame& frame);
  /** Adds the objects of a scan that was added, in the order of scans.
   * \param scan Frame::index */
  void addObjects(std::size_t scan, const std::vector<TrackedObject>& objects, TrackLife life);
  void exchangeState(StateArchive& archive);

  [[nodiscard]] const std::vector<PastScan>& scans() const { return scans_; }
  /** T_vehicle_lidar, the different ones. */
  [[nodiscard]] const std::vector<Pose>& mounts() const { return mounts_; }
  /** Calls `use` with every object at each scan at which it counts, by scan, then in the order of
   * Frame::objects. */
  void forEachObject(const std::function<void(const PastObject&)>& use) const;
  /** The same with merged tracks. Where several tracks of one object are at a scan, the one that is
   * observed counts; if several are, the one with the smallest id. \param merged of
   * findMergedTracks(): the id of each merged track's object */
  void forEachObject(const std::map<int, int>& merged,
                     const std::function<void(const PastObject&)>& use) const;

 private:
  /** Positions in scans_ of a track's first and last observation. */
  struct Observations
  {
    std::size_t first = 0;
    std::size_t last = 0;
  };
  /** Objects one after the other. */
  struct Part
  {
    std::vector<PastObject> objects;
    [[nodiscard]] std::size_t memory() const { return objects.capacity() * sizeof(PastObject); }
    [[nodiscard]] std::string toBytes() const;
    [[nodiscard]] static Part fromBytes(std::string_view bytes);
  };

  void add(std::size_t scan, const TrackedObject& object);
  /** Updates first and last observation of the tracks. \param scan position in scans_ */
  void noteObservations(std::size_t scan, const std::vector<TrackedObject>& objects);
  /** Whether the object counts at its scan, see TrackLife. */
  [[nodiscard]] bool counts(const PastObject& object) const;

  std::vector<PastScan> scans_;
  std::vector<Pose> mounts_;
  SwappedStore<Part> objects_;
  std::size_t in_last_part_ = 0;
  std::map<int, Observations> whole_;       //!< of reported tracks that count as a whole
  std::map<int, Observations> unreported_;  //!< of present tracks that were not reported so far
};
}  // namespace dyslam
