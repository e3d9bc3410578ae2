// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** A moving object as a picture of the map shows it; map frame. */
struct PictureObject
{
  ObjectClass object_class = ObjectClass::unknown;
  std::vector<Eigen::Vector3d> path;  //!< positions of the centre [m], in order of time
  Box last;                           //!< box at the last observation
};

/** The path of one of several runs. */
struct PictureRun
{
  /** Name in the legend, in Latin letters without accents; with the number of the run if it has
   * other characters. */
  std::string name;
  std::vector<Eigen::Vector3d> path;  //!< as MapPictureContent::path
};

/** What a picture of the map shows; all in the map frame [m]. */
struct MapPictureContent
{
  const std::vector<Eigen::Vector3f>* points = nullptr;  //!< points of the static map; may be null
  const std::vector<Eigen::Vector3f>* marked = nullptr;  //!< drawn red over `points`; may be null
  /** Positions of the vehicle, in order of time; the line is interrupted where a position is not
   * finite. */
  std::vector<Eigen::Vector3d> path;
  /** Several runs instead of `path`, each with its own colour and an entry in the legend. */
  std::vector<PictureRun> runs;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> loops;  //!< both ends of each loop
  std::vector<PictureObject> objects;
};

struct MapPictureOptions
{
  int pixels = 1600;        //!< longer side of the picture
  double margin = 40;       //!< width of the margin around the vehicle's path [m]
  double min_pixel = 0.05;  //!< least side of a pixel [m]
};

/** PNG of the map from above, x to the right and y up. Points are darker the higher they are over
 * the ground around them; ceilings (flat layers of points over free ground) are left out. Over the
 * points are drawn the paths of the vehicle and of the objects, the last box of each object, loops,
 * a scale and a legend. The part around the vehicle's path is shown. \return no bytes without a
 * path. \throws std::invalid_argument for options that are not positive.
 */
[[nodiscard]] std::vector<std::uint8_t> renderMapPicture(const MapPictureContent& content,
                                                         const MapPictureOptions& options = {});

/** Two maps side by side, or one above the other if they are wide, each with a title. Both show the
 * part around the vehicle's paths of both maps; a legend below names the runs, if there are
 * several. Both maps must have the runs in the same order. \return no bytes without a path. \throws
 * as renderMapPicture(). */
[[nodiscard]] std::vector<std::uint8_t> renderMapComparison(
    const std::pair<std::string, MapPictureContent>& first,
    const std::pair<std::string, MapPictureContent>& second,
    const MapPictureOptions& options = {});
}  // namespace dyslam
