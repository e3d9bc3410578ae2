// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Trajectory.h>

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** Content of a `.3Dscene`; empty parts are left out. All in the map frame. */
struct SceneContent
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;  //!< intensity in [0, 1], one per point, or empty
  Trajectory trajectory;
  std::vector<Trajectory> other_trajectories;  //!< trajectories of other runs in the map
  Trajectory reference;                        //!< ground truth
  std::vector<LabelledBox> boxes;              //!< objects, with their ids
  std::vector<Eigen::Vector3d> velocities;     //!< one per box, drawn as arrows, or empty [m/s]
  /** Paths of moving objects by id, drawn as lines in the colour of the box. */
  std::map<int, std::vector<Eigen::Vector3d>> object_paths;
};

/** Write a scene that MRPT's SceneViewer3D shows: map points coloured by height (brightness by
 * intensity), trajectories, boxes with ids. The points of ceilings (ceilingPointsIfMany()) are an
 * object `ceilings` of their own, which is not visible. \throws UserError if the file cannot be
 * written.
 */
void writeScene(const SceneContent& content, const std::string& path);
}  // namespace dyslam
