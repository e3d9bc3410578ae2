// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>
#include <mrpt/img/TColor.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CRenderizable.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dyslam
{
/** Colour of a value in [0, 1]: dark blue over green and yellow to red. */
[[nodiscard]] mrpt::img::TColor rampColour(float value);
/** One of eight colours that are easy to tell apart, by an object's id. */
[[nodiscard]] mrpt::img::TColor objectColour(int id);

struct HeightRange
{
  float low = 0;   //!< [m]
  float high = 1;  //!< [m], above `low`
};

/** Heights that frame all but the outermost points: their 2nd and 98th percentile, at least 1 m
 * apart. */
[[nodiscard]] HeightRange heightRange(const std::vector<Eigen::Vector3f>& points);

/** Points coloured by height between the 2nd and the 98th percentile, brightness by intensity (may
 * be empty). */
[[nodiscard]] mrpt::opengl::CPointCloudColoured::Ptr heightColoured(
    const std::vector<Eigen::Vector3f>& points,
    const std::vector<float>& intensity,
    float point_size);
/** As above, with the colours from `low` to `high` [m]. */
[[nodiscard]] mrpt::opengl::CPointCloudColoured::Ptr heightColoured(
    const std::vector<Eigen::Vector3f>& points,
    const std::vector<float>& intensity,
    const HeightRange& range,
    float point_size);
[[nodiscard]] mrpt::opengl::CPointCloudColoured::Ptr plainColoured(
    const std::vector<Eigen::Vector3f>& points, const mrpt::img::TColor& colour, float point_size);

/** Wire box with a cross at its front. \param T takes the box's frame to the scene's. */
[[nodiscard]] mrpt::opengl::CRenderizable::Ptr wireBox(const Box& box,
                                                       const Pose& T,
                                                       const mrpt::img::TColor& colour);
[[nodiscard]] mrpt::opengl::CRenderizable::Ptr textAt(const std::string& words,
                                                      const Eigen::Vector3d& at,
                                                      const mrpt::img::TColor& colour);
/** Arrow of a velocity [m/s], as long as the path in a second; null if too short to draw. */
[[nodiscard]] mrpt::opengl::CRenderizable::Ptr velocityArrow(const Eigen::Vector3d& at,
                                                             const Eigen::Vector3d& velocity,
                                                             const mrpt::img::TColor& colour);
/** Box, label (class, id, speed) and velocity of a tracked object, grey unless it is dynamic.
 * \param T takes the object's frame to the scene's. */
void insertObject(mrpt::opengl::COpenGLScene& scene, const TrackedObject& object, const Pose& T);
/** A line through points; null for fewer than two. */
[[nodiscard]] mrpt::opengl::CRenderizable::Ptr polyline(const std::vector<Eigen::Vector3d>& points,
                                                        const mrpt::img::TColor& colour,
                                                        float width);
}  // namespace dyslam
