// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/RunMerger.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace dyslam
{
/** Satellite positions and vertical of one run of a merge. Keyframes are counted from the run's
 * first one. */
class RunAnchor
{
 public:
  RunAnchor() = default;
  /** \param graph of the run: its factors of satellite positions and of gravity, if it was
   * optimised with them; else the references count for the map as a whole */
  RunAnchor(const FactorGraph& graph, const RunReferences& references);

  [[nodiscard]] const std::optional<Georeference>& georeference() const
  {
    return references_.georeference;
  }
  [[nodiscard]] const std::optional<Gravity>& gravity() const { return references_.gravity; }
  [[nodiscard]] std::size_t keyframes() const { return poses_.size(); }

  /** Pose of a keyframe on the earth by the run alone, east-north-up of `origin`.
   * \pre georeference() */
  [[nodiscard]] Pose onEarth(std::size_t keyframe, const GeodeticPosition& origin) const;
  /** Sigma of the run's place on the earth, horizontally [m]. \pre georeference() */
  [[nodiscard]] double positionSigma() const;

  /** Adds the satellite positions, and the pose of the map on the earth if the graph does not have
   * it. \param first number of the run's first keyframe \param origin of the east-north-up axes
   * \pre georeference() */
  void addPositions(FactorGraph& merged, std::size_t first, const GeodeticPosition& origin) const;
  /** Adds the measured gravity with the run's own bias, and the vertical if the graph does not have
   * it. \param run number of the run \pre gravity() */
  void addVertical(FactorGraph& merged, std::size_t first, std::size_t run) const;

  /** How the references fit the merged map, of whose references those count that it has.
   * \param merged T_map_vehicle of the run's keyframes */
  [[nodiscard]] ReferenceFit fit(const std::vector<Pose>& merged,
                                 const std::optional<Georeference>& georeference,
                                 const std::optional<Gravity>& gravity) const;

 private:
  struct Position
  {
    std::size_t keyframe = 0;
    Eigen::Vector3d position;  //!< position of the antenna, east-north-up of the run's origin [m]
    Eigen::Vector3d antenna;   //!< position of the antenna, vehicle frame of the keyframe [m]
    Matrix6 information;       //!< as of GnssFactor
  };
  struct Direction
  {
    std::size_t keyframe = 0;
    Eigen::Vector3d upwards;  //!< measured gravity, vehicle frame of the keyframe [m/s^2]
    Matrix6 information;      //!< as of GravityFactor
  };
  void takePositions(const FactorGraph& graph);
  void takeDirections(const FactorGraph& graph);
  /** Upwards in the merged map, by the run alone. \param T_map_vehicle of the middle keyframe */
  [[nodiscard]] Eigen::Vector3d upIn(const Pose& T_map_vehicle) const;
  [[nodiscard]] std::size_t middle() const { return poses_.size() / 2; }

  RunReferences references_;
  std::vector<Pose> poses_;  //!< T_map_vehicle by the run alone
  std::vector<Position> positions_;
  /** Axis of the run's map that is about vertical, for the satellite positions. */
  Eigen::Vector3d upwards_ = Eigen::Vector3d::UnitZ();
  std::vector<Direction> directions_;
  std::optional<Vector6> bias_;  //!< of the accelerometer, if the graph has it as a variable
};
}  // namespace dyslam
