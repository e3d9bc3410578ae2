// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Static confidence of DyLO's network for the points of a scan, with their true labels. */
struct MaskScan
{
  enum class Truth : std::uint8_t
  {
    unknown,
    stationary,
    moving
  };
  struct Point
  {
    Eigen::Vector2f position;  //!< sensor frame, x forward, y left [m]
    float confidence = -1;     //!< static confidence in [0, 1]; negative: point not sampled
    Truth truth = Truth::unknown;
  };
  std::string name;
  std::vector<Point> points;
};

/** Parses a file of `dyslam-train dylo --mask-csv`: x, y, z, static_confidence, label (0 unknown,
 * 1 static, 2 moving). \param name file name for error messages. \throws UserError for another
 * header, a row that is not five numbers, or no rows. */
[[nodiscard]] MaskScan parseMaskScan(const std::string& text, const std::string& name);

/** Number of the sampled points with this label. */
[[nodiscard]] std::size_t sampledPoints(const MaskScan& scan, MaskScan::Truth truth);

/** ROC curve of the moving class over all thresholds of the static confidence, in ascending order:
 * false positive rate (x) and true positive rate (y) of the sampled points. From (0, 0) to (1, 1);
 * empty without static or without moving points. */
[[nodiscard]] std::vector<Eigen::Vector2d> rocCurve(const MaskScan& scan);

/** Area under rocCurve(), 0.5 for chance; NaN without a curve. */
[[nodiscard]] double areaUnderCurve(const MaskScan& scan);
}  // namespace dyslam
