// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Association.h>
#include <dyslam/eval/Statistics.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** How an estimate is laid over its reference before absolute errors are taken. */
enum class Alignment
{
  none,   //!< not at all: both are in one frame
  first,  //!< so that the first poses agree
  se3     //!< rigid motion with the least squared position errors (Umeyama without scale)
};

[[nodiscard]] std::string toString(Alignment alignment);
/** \throws UserError for another word than none, first or se3. */
[[nodiscard]] Alignment alignmentFromString(const std::string& word);

struct TrajectoryMetricsOptions
{
  Alignment alignment = Alignment::se3;
  std::vector<double> lengths{100, 200, 300, 400, 500, 600, 700, 800};  //!< of segments [m]
};

/** Mean drift over segments of one or more lengths. */
struct SegmentDrift
{
  double length = 0;                 //!< [m]; 0 for the mean over all lengths
  std::size_t segments = 0;          //!< how many entered the mean
  double translation_percent = 0;    //!< t_rel
  double rotation_deg_per_100m = 0;  //!< r_rel
};

struct KittiDrift
{
  SegmentDrift overall;                  //!< mean over all segments of all lengths
  std::vector<SegmentDrift> per_length;  //!< lengths without a segment have segments = 0
};

/** The KITTI odometry benchmark's errors.
 *
 * As the benchmark's devkit defines them: from every `step`-th frame, and for each length, the
 * segment ends at the first frame whose travelled distance (along the reference) exceeds the
 * length; its error is the motion inverse(estimated) * true over the segment, translation and
 * rotation angle, divided by the length. Segments that do not fit are left out.
 */
[[nodiscard]] KittiDrift kittiDrift(const PosePairs& pairs,
                                    const std::vector<double>& lengths,
                                    std::size_t step);

/** Errors of the motion from each pose to the next (relative pose error at a distance of one). */
struct RelativePoseError
{
  Statistics translation;   //!< [m]
  Statistics rotation_deg;  //!< [deg]
};
[[nodiscard]] RelativePoseError relativePoseError(const PosePairs& pairs);

/** T_reference_estimate: takes the estimate's frame to the reference's.
 *
 * For se3 of positions on one line, where Umeyama's rotation about that line is free or follows the
 * noise across it, the orientations decide that rotation. Identity for an empty set.
 */
[[nodiscard]] Pose alignEstimate(const PosePairs& pairs, Alignment alignment);

struct AbsoluteTrajectoryError
{
  Pose T_reference_estimate = Pose::Identity();
  Statistics translation;   //!< distance of positions after alignment [m]
  Statistics rotation_deg;  //!< angle between orientations after alignment [deg]
};
[[nodiscard]] AbsoluteTrajectoryError absoluteTrajectoryError(const PosePairs& pairs,
                                                              Alignment alignment);

/** Sum of estimated over sum of true motion, each step's estimate projected on the true direction.
 *
 * 1 for a faithful odometry, below 1 for one that shrinks towards standing still, whatever the
 * frame's axes. Steps shorter than a micrometre have no direction and are left out.
 * \return nothing where the reference stands still.
 */
[[nodiscard]] std::optional<double> forwardRatio(const PosePairs& pairs);

/** Error of the last pose when the first poses agree. */
struct EndError
{
  double translation = 0;   //!< [m]
  double rotation_deg = 0;  //!< [deg]
  double percent = 0;       //!< of the reference's length; 0 where that is 0
};
[[nodiscard]] EndError endError(const PosePairs& pairs);

/** Everything above for one estimate. */
struct TrajectoryReport
{
  std::string name;
  Alignment alignment = Alignment::se3;
  std::size_t reference_size = 0;
  std::size_t estimate_size = 0;
  std::size_t pairs = 0;
  std::size_t not_finite = 0;
  double length = 0;  //!< of the associated reference [m]
  KittiDrift drift;
  RelativePoseError relative;
  AbsoluteTrajectoryError absolute;
  std::optional<double> forward_ratio;
  EndError end;
};

/** \throws UserError where fewer than two poses are associated. */
[[nodiscard]] TrajectoryReport evaluateTrajectory(const std::string& name,
                                                  const PosePairs& pairs,
                                                  const TrajectoryMetricsOptions& options = {});
}  // namespace dyslam
