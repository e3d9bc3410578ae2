// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <tuple>

namespace dyslam
{
/** The variables of a factor graph (paper, Fig. 6), the pose of the map on the earth, its tilt, the
 * bias of the accelerometer, and the frame of a prior map. */
enum class VariableKind : std::uint8_t
{
  ego_pose,            //!< x_k: T_map_vehicle at keyframe k
  static_object,       //!< s_j: T_map_object of a static object, one for a whole sighting
  object_pose,         //!< l_j,k: T_map_object of a moving object at scan k
  object_velocity,     //!< V_j,k: twist of a moving object over the interval that ends at scan k
  georeference,        //!< G: T_enu_map, the pose of the map on the earth
  vertical,            //!< D: T_level_map, whose rotation makes z of the map vertical
  accelerometer_bias,  //!< B: vehicle axes [m/s^2], then three zeros
  prior_map,           //!< M: T_map_prior, pose of the prior map; of a run the identity, held fixed
};

/** Names one variable of a factor graph. */
struct Key
{
  VariableKind kind = VariableKind::ego_pose;
  std::int64_t object = -1;  //!< id of the object; -1 for ego poses
  std::int64_t index = -1;   //!< keyframe or scan; for static objects: number of the sighting

  [[nodiscard]] static Key ego(std::size_t keyframe)
  {
    return {VariableKind::ego_pose, -1, static_cast<std::int64_t>(keyframe)};
  }
  [[nodiscard]] static Key staticObject(int object, int sighting = 0)
  {
    return {VariableKind::static_object, object, sighting};
  }
  [[nodiscard]] static Key objectPose(int object, std::size_t scan)
  {
    return {VariableKind::object_pose, object, static_cast<std::int64_t>(scan)};
  }
  [[nodiscard]] static Key objectVelocity(int object, std::size_t scan)
  {
    return {VariableKind::object_velocity, object, static_cast<std::int64_t>(scan)};
  }

  [[nodiscard]] static Key georeference() { return {VariableKind::georeference, -1, 0}; }
  [[nodiscard]] static Key vertical() { return {VariableKind::vertical, -1, 0}; }
  /** \param run number of a run in a graph of several, which may be localised in different maps */
  [[nodiscard]] static Key priorMap(std::size_t run = 0)
  {
    return {VariableKind::prior_map, -1, static_cast<std::int64_t>(run)};
  }
  /** \param run number of the run in a graph of several, each with its own accelerometer */
  [[nodiscard]] static Key accelerometerBias(std::size_t run = 0)
  {
    return {VariableKind::accelerometer_bias, -1, static_cast<std::int64_t>(run)};
  }

  /** Whether the value is a pose; else six numbers that are perturbed by addition. */
  [[nodiscard]] bool isPose() const
  {
    return kind != VariableKind::object_velocity && kind != VariableKind::accelerometer_bias;
  }
  /** Whether the graph of a run has at most one such variable. */
  [[nodiscard]] bool isSingle() const
  {
    return kind == VariableKind::georeference || kind == VariableKind::vertical ||
           kind == VariableKind::accelerometer_bias || kind == VariableKind::prior_map;
  }

  friend bool operator==(const Key& a, const Key& b)
  {
    return std::tie(a.kind, a.object, a.index) == std::tie(b.kind, b.object, b.index);
  }
  friend bool operator!=(const Key& a, const Key& b) { return !(a == b); }
  /** Order by kind, then object, then index. */
  friend bool operator<(const Key& a, const Key& b)
  {
    return std::tie(a.kind, a.object, a.index) < std::tie(b.kind, b.object, b.index);
  }
};

/** Name of a key: "x12", "s4", "s4#1" for a second sighting, "l4@123", "v4@123", "g", "d", "b",
 * "m". */
[[nodiscard]] std::string toString(const Key& key);
}  // namespace dyslam
