// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** How surely DyLO's network holds each point of a scan for static, beside the truth. */
struct MaskScan
{
  enum class Truth : std::uint8_t
  {
    unknown,
    still,
    moving
  };
  struct Point
  {
    Eigen::Vector2f position;  //!< from above, x ahead and y to the left [m]
    float confidence = -1;     //!< in [0, 1]; below 0 where the network did not sample
    Truth truth = Truth::unknown;
  };
  std::string name;
  std::vector<Point> points;
};

/** Reads what `dyslam-train dylo --mask-csv` writes: x, y, z, static_confidence, label (0 unknown,
 * 1 static, 2 moving). \param name of the file, for errors. \throws UserError for another header, a
 * row that is not five numbers, or no rows. */
[[nodiscard]] MaskScan parseMaskScan(const std::string& text, const std::string& name);

/** Calling moving what has at most some confidence, for each threshold in ascending order: shares
 * of the static sampled points (x, false alarms) and of the moving ones (y, found) that are called
 * so. From (0, 0) to (1, 1); empty without points of either kind. */
[[nodiscard]] std::vector<Eigen::Vector2d> rocCurve(const MaskScan& scan);

/** Area under rocCurve(), 0.5 for chance; NaN without a curve. */
[[nodiscard]] double areaUnder(const std::vector<Eigen::Vector2d>& roc);

/** The scan from above, 80 m square with x up (returns grey, truly moving ones dark red; sampled
 * points from blue, held for static, to red; large where they truly move) and the curve beside it
 * where there is one, as PNG bytes. */
[[nodiscard]] std::vector<std::uint8_t> renderMaskScan(const MaskScan& scan);
}  // namespace dyslam
