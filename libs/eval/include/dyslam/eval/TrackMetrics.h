// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** Reference and estimated tracks of one recording, in the same coordinate frame. */
struct TrackSequence
{
  int frames = 0;  //!< number of frames; boxes outside [0, frames) are ignored
  std::vector<LabelledBox> reference;
  std::vector<LabelledBox> estimate;  //!< `score` is the confidence of the track at the frame
};

/** Value of LabelledBox::occluded that marks reference boxes as ignored under any rules: neither
 * hits nor misses, and an estimate matched to one is no false alarm. */
constexpr int ignored_box = 99;

/** Rules which boxes are evaluated or ignored, as in KITTI's tracking benchmark and AB3DMOT. */
struct TrackRules
{
  std::string type;                     //!< class to evaluate; empty for all classes together
  std::vector<std::string> neighbours;  //!< reference classes whose boxes are ignored
  double min_iou = 0.25;                //!< least 3D IoU, or similarity, of a match
  /** If positive, boxes are matched by the horizontal distance of their centres [m] instead of the
   * IoU: their similarity is 1 at distance 0 and falls linearly to 0 at this distance. */
  double max_distance = 0;
  /** KITTI's image rules: truncated and heavily occluded reference boxes are ignored, and so are
   * unmatched estimates of small image height or in a DontCare area. */
  bool image_rules = true;
  bool switches_across_gaps = false;  //!< count id switches that happen while the object is missed

  /** Rules of KITTI for Car, Pedestrian or Cyclist. */
  [[nodiscard]] static TrackRules kitti(const std::string& type);
};

/** CLEAR-MOT (Bernardin and Stiefelhagen, 2008) at one confidence threshold. Ratios are fractions,
 * 1 is 100 %; NaN where the denominator is 0, such as the precision without an estimate.
 *
 * Under KITTI's image rules the figures are those of the benchmark's script, but for two cases that
 * it counts and this does not: a match of an ignored box that is the first of its track, as tracked
 * (which may also make a switch or a fragmentation later); and the match of a track's last box, if
 * none precedes it since the last ignored box, as a fragmentation. */
struct ClearMot
{
  double mota = 0;       //!< at most 1; negative with many false alarms
  double motp = 0;       //!< mean IoU of the matches, or similarity (TrackRules::max_distance)
  double precision = 0;  //!< in [0, 1]
  double recall = 0;     //!< in [0, 1]
  std::size_t references = 0;  //!< reference boxes that are not ignored
  /** True positives; under KITTI's image rules with the matched ignored boxes, as KITTI and AB3DMOT
   * count them. */
  std::size_t matches = 0;
  std::size_t misses = 0;
  std::size_t false_alarms = 0;
  std::size_t id_switches = 0;
  std::size_t fragmentations = 0;
  double mostly_tracked = 0;  //!< fraction of reference tracks matched in over 80 % of their frames
  double mostly_lost = 0;  //!< fraction of reference tracks matched in under 20 % of their frames
  double threshold = 0;    //!< estimated tracks with a lower mean score were removed
};

/** CLEAR-MOT of the estimated tracks with a mean score of at least `threshold` (default: all). */
[[nodiscard]] ClearMot clearMot(const std::vector<TrackSequence>& sequences,
                                const TrackRules& rules);
[[nodiscard]] ClearMot clearMot(const std::vector<TrackSequence>& sequences,
                                const TrackRules& rules,
                                double threshold);

/** The sequences without estimated tracks of a mean score below `threshold`. */
[[nodiscard]] std::vector<TrackSequence> tracksAbove(std::vector<TrackSequence> sequences,
                                                     double threshold);

/** AB3DMOT's averages over recall (Weng et al., 2020), and CLEAR-MOT at the best MOTA. The averages
 * are NaN if the reference has fewer boxes than there are recall values: most of these then have no
 * threshold of their own. */
struct RecallAverages
{
  struct Point
  {
    double recall = 0;  //!< target recall, a multiple of 1 / recall_points
    double smota = 0;   //!< MOTA scaled by the target recall, in [0, 1]
    ClearMot mot;
  };
  double samota = 0;          //!< mean of Point::smota, in [0, 1]
  double amota = 0;           //!< mean MOTA; may be negative
  double amotp = 0;           //!< mean MOTP, in [0, 1]
  ClearMot best;              //!< at the threshold with the best MOTA
  std::vector<Point> points;  //!< recalls that are not reached count as 0 in the averages
};
[[nodiscard]] RecallAverages averagesOverRecall(const std::vector<TrackSequence>& sequences,
                                                const TrackRules& rules,
                                                int recall_points = 40);

/** HOTA (Luiten et al., 2021), means over IoU thresholds 0.05 to 0.95, in [0, 1]. */
struct Hota
{
  double hota = 0;
  double detection = 0;     //!< detection accuracy DetA
  double association = 0;   //!< association accuracy AssA
  double localization = 0;  //!< localisation accuracy LocA
};
[[nodiscard]] Hota hota(const std::vector<TrackSequence>& sequences, const TrackRules& rules);
}  // namespace dyslam
