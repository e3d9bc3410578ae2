// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** Tracks of one recording: reference and estimate in the same frame of coordinates. */
struct TrackSequence
{
  int frames = 0;  //!< number of frames; boxes at frames outside [0, frames) are left out
  std::vector<LabelledBox> reference;
  std::vector<LabelledBox> estimate;  //!< score: the track's confidence at that frame
};

/** Value of LabelledBox::occluded of reference boxes that are neither hits nor misses under any
 * rules. */
constexpr int passed_over_box = 99;

/** What counts and what is passed over, as KITTI's tracking benchmark and AB3DMOT define it. */
struct TrackRules
{
  std::string type;                     //!< class name to evaluate; empty: all of them together
  std::vector<std::string> neighbours;  //!< reference classes that are neither hit nor false alarm
  double min_iou = 0.25;                //!< of the volumes, for a match
  /** Above 0, pairs are made by the centres' distance in the ground plane instead [m]: their
   * overlap is then 1 at distance 0, falling to 0 at this distance. */
  double max_distance = 0;
  /** KITTI's: truncated and heavily occluded reference boxes are passed over, and so are unmatched
   * estimates that are low in the image or in a DontCare area. */
  bool image_rules = true;
  bool switches_across_gaps = false;  //!< count an id that changed while the object was missed

  /** The rules of KITTI for Car, Pedestrian or Cyclist. */
  [[nodiscard]] static TrackRules kitti(const std::string& type);
};

/** CLEAR-MOT (Bernardin and Stiefelhagen, 2008) at one confidence threshold. */
struct ClearMot
{
  double mota = 0;
  double motp = 0;  //!< mean IoU of the matches
  double precision = 0;
  double recall = 0;
  double f1 = 0;
  std::size_t references = 0;  //!< boxes that count
  std::size_t matches = 0;     //!< KITTI's true positives: matched passed-over boxes too
  std::size_t misses = 0;
  std::size_t false_alarms = 0;
  std::size_t id_switches = 0;
  std::size_t fragmentations = 0;
  double mostly_tracked = 0;  //!< part of the reference tracks matched in over 80 % of their frames
  double mostly_lost = 0;     //!< under 20 %
  double threshold = 0;       //!< tracks with a lower mean score were left out
};

/** Of all estimates, or of tracks whose mean score is at least `threshold`. */
[[nodiscard]] ClearMot clearMot(const std::vector<TrackSequence>& sequences,
                                const TrackRules& rules);
[[nodiscard]] ClearMot clearMot(const std::vector<TrackSequence>& sequences,
                                const TrackRules& rules,
                                double threshold);

/** The same without estimated tracks of a mean score below `threshold`. */
[[nodiscard]] std::vector<TrackSequence> tracksAbove(std::vector<TrackSequence> sequences,
                                                     double threshold);

/** AB3DMOT's averages over recall (Weng et al., 2020), and CLEAR-MOT where MOTA is best. */
struct RecallAverages
{
  struct Point
  {
    double recall = 0;  //!< aimed at, a multiple of 1/40
    double smota = 0;   //!< MOTA scaled to that recall, within [0, 1]
    ClearMot mot;
  };
  double samota = 0;
  double amota = 0;
  double amotp = 0;
  ClearMot best;
  std::vector<Point> points;  //!< recalls never reached count 0 in the averages
};
[[nodiscard]] RecallAverages averagesOverRecall(const std::vector<TrackSequence>& sequences,
                                                const TrackRules& rules,
                                                int recall_points = 40);

/** HOTA (Luiten et al., 2021), means over IoU thresholds 0.05 to 0.95. */
struct Hota
{
  double hota = 0;
  double detection = 0;     //!< DetA
  double association = 0;   //!< AssA
  double localization = 0;  //!< LocA
};
[[nodiscard]] Hota hota(const std::vector<TrackSequence>& sequences, const TrackRules& rules);
}  // namespace dyslam
