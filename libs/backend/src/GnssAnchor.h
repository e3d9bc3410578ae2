// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/GnssOptions.h>
#include <dyslam/core/Georeference.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Pose of the vehicle at some time, relative to a keyframe. */
struct VehicleInKeyframe
{
  std::size_t keyframe = 0;
  Pose T_keyframe_vehicle = Pose::Identity();
};

/** Pose of the vehicle at the stamp of a position [s]; nothing if no scan is near. */
using VehicleAt = std::function<std::optional<VehicleInKeyframe>(double stamp)>;

/** Collects the positions of a satellite receiver during a run, and georeferences the graph with
 * them at the end. */
class GnssAnchor
{
 public:
  explicit GnssAnchor(const GnssOptions& options) : options_(options) {}

  /** Adds the positions of the next frame, whose stamps are of a clock that is never set; those
   * that are none (isOnEarth()) are ignored. */
  void add(const std::vector<GnssFix>& fixes);

  /** Adds the georeference and its factors to the graph, with a value near the optimum at the
   * graph's present poses. Positions that jump against the trajectory are left out. \return whether
   * the positions could be used */
  bool addTo(FactorGraph& graph, const VehicleAt& vehicle_at);
  /** Whether most positions fit the graph. \param drift tolerated error of the trajectory, as a
   * fraction of its extent */
  [[nodiscard]] bool fits(const FactorGraph& graph, double drift) const;
  /** Whether most positions fit the graph if their latitudes and longitudes are swapped. \param
   * drift as of fits() */
  [[nodiscard]] bool fitsIfSwapped(const FactorGraph& graph,
                                   const VehicleAt& vehicle_at,
                                   double drift) const;
  /** Result. \pre addTo() returned true, and the graph still has the factors that it added */
  [[nodiscard]] Georeference georeference(const FactorGraph& graph) const;
  /** Reasons why positions were not used, one line each. */
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  void warn(const std::string& what) { warnings_.push_back(what); }
  [[nodiscard]] const GnssOptions& options() const { return options_; }

  void exchangeState(StateArchive& archive);

 private:
  /** A position that is used. */
  struct Used
  {
    std::size_t keyframe;
    GeodeticPosition on_earth;
    Eigen::Vector3d position;  //!< position of the antenna, east-north-up [m]
    Eigen::Vector3d antenna;   //!< position of the antenna, vehicle frame of the keyframe [m]
    double horizontal_sigma;   //!< sigma of east and of north [m]
    double vertical_sigma;     //!< sigma of the height [m]
    double stamp;              //!< of the position, as it was added [s]
  };
  void select(const FactorGraph& graph, const VehicleAt& vehicle_at);
  void leaveOutOutliers(const FactorGraph& graph);
  [[nodiscard]] Pose initialPose(const FactorGraph& graph) const;
  [[nodiscard]] Eigen::Vector3d inMap(const FactorGraph& graph, const Used& used) const;
  [[nodiscard]] Eigen::Vector3d errorOf(const FactorGraph& graph, const Used& used) const;
  [[nodiscard]] bool fits(const FactorGraph& graph, const Pose& T_enu_map, double drift) const;
  [[nodiscard]] double extent(const FactorGraph& graph) const;
  [[nodiscard]] double neededExtent() const;
  [[nodiscard]] double informationShare() const;

  GnssOptions options_;
  std::vector<GnssFix> fixes_;
  std::vector<Used> used_;
  GeodeticPosition origin_;
  std::vector<std::string> warnings_;
};
}  // namespace dyslam
