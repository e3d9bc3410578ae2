// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Statistics.h>
#include <dyslam/eval/Association.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Alignment of an estimate to its reference before absolute errors are computed. */
enum class Alignment
{
  none,   //!< none: both are in the same frame
  first,  //!< the first poses coincide
  se3     //!< least-squares rigid motion of the positions (Umeyama without scale)
};

[[nodiscard]] std::string toString(Alignment alignment);
/** An alignment in words, for titles: "aligned to the reference by rotation and translation". */
[[nodiscard]] std::string describe(Alignment alignment);
/** Parses an alignment. \throws UserError for a word other than none, first or se3. */
[[nodiscard]] Alignment alignmentFromString(const std::string& word);

struct TrajectoryMetricsOptions
{
  Alignment alignment = Alignment::se3;
  std::vector<double> lengths{100, 200, 300, 400, 500, 600, 700, 800};  //!< segment lengths [m]
};

/** Mean drift over segments of one or more lengths. */
struct SegmentDrift
{
  double length = 0;                 //!< segment length [m]; 0 for the mean over all lengths
  std::size_t segments = 0;          //!< number of segments in the mean
  double translation_percent = 0;    //!< t_rel [%]
  double rotation_deg_per_100m = 0;  //!< r_rel [deg/100 m]
};

struct KittiDrift
{
  SegmentDrift overall;                  //!< mean over all segments of all lengths
  std::vector<SegmentDrift> per_length;  //!< segments = 0 for lengths without a segment
};

/** The KITTI odometry benchmark's errors.
 *
 * As defined by the benchmark's devkit: a segment starts at each `step`-th frame and ends, for each
 * length, at the first frame whose distance travelled along the reference exceeds the length. Its
 * error is the motion inverse(estimated) * true over the segment; translation and rotation angle
 * are divided by the length. Segments beyond the end are not counted. \throws std::invalid_argument
 * for step = 0 or a length that is not positive.
 */
[[nodiscard]] KittiDrift kittiDrift(const PosePairs& pairs,
                                    const std::vector<double>& lengths,
                                    std::size_t step);

/** Relative pose error over one step: errors of the motion between consecutive poses. */
struct RelativePoseError
{
  Statistics translation;   //!< error of the translation [m]
  Statistics rotation_deg;  //!< angle of the rotation error [deg]
};
[[nodiscard]] RelativePoseError relativePoseError(const PosePairs& pairs);

/** T_reference_estimate: transforms the estimate's frame to the reference's.
 *
 * For collinear positions, for which the rotation about the line is undetermined or follows the
 * noise (se3), the orientations determine that rotation, if the reference has any. Identity for an
 * empty set.
 */
[[nodiscard]] Pose alignEstimate(const PosePairs& pairs, Alignment alignment);

struct AbsoluteTrajectoryError
{
  Pose T_reference_estimate = Pose::Identity();
  Statistics translation;   //!< distance of positions after alignment [m]
  Statistics rotation_deg;  //!< angle between orientations after alignment [deg]; may be empty
  /** The path is nearly straight, and the orientations determined the rotation about its line
   * (SE(3) alignment), which the positions alone would not. */
  bool turned_by_orientations = false;
};
[[nodiscard]] AbsoluteTrajectoryError absoluteTrajectoryError(const PosePairs& pairs,
                                                              Alignment alignment);

/** Ratio of the estimated to the true distance travelled; each estimated step is projected on the
 * true direction.
 *
 * 1 for an unbiased odometry, below 1 for one that underestimates the motion; independent of the
 * frame's axes. Steps shorter than 1e-6 m are ignored.
 * \return nothing for a stationary reference.
 */
[[nodiscard]] std::optional<double> forwardRatio(const PosePairs& pairs);

/** Error of the last pose with the first poses aligned. */
struct EndError
{
  double translation = 0;   //!< [m]
  double rotation_deg = 0;  //!< [deg]
  double percent = 0;       //!< translation by the reference's length [%]; 0 for length 0
};
[[nodiscard]] EndError endError(const PosePairs& pairs);

/** All metrics of one estimate. Of a reference of positions alone those of motions between poses,
 * which need its orientations, are missing: `drift`, `relative`, `forward_ratio`, `end`, and the
 * rotations of `absolute`. */
struct TrajectoryReport
{
  std::string name;
  bool positions_only = false;  //!< PosePairs::positions_only
  Alignment alignment = Alignment::se3;
  std::size_t reference_size = 0;  //!< poses in the reference
  std::size_t estimate_size = 0;   //!< poses in the estimate
  std::size_t pairs = 0;           //!< associated poses
  std::size_t not_finite = 0;      //!< non-finite estimated poses
  double length = 0;               //!< of the associated reference [m]
  KittiDrift drift;
  RelativePoseError relative;
  AbsoluteTrajectoryError absolute;
  std::optional<double> forward_ratio;  //!< see forwardRatio()
  EndError end;
};

/** Computes all metrics. \throws UserError if fewer than two poses are associated, and for the
 * alignment `first` with a reference of positions alone. */
[[nodiscard]] TrajectoryReport evaluateTrajectory(const std::string& name,
                                                  const PosePairs& pairs,
                                                  const TrajectoryMetricsOptions& options = {});
}  // namespace dyslam
