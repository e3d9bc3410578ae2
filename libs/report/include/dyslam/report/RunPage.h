// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Georeference.h>
#include <dyslam/core/Gravity.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/PriorMapFit.h>
#include <dyslam/core/Trajectory.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Result of one scan. */
struct PageScan
{
  std::size_t index = 0;          //!< number of the scan in the recording
  std::size_t points = 0;         //!< number of points used
  std::size_t moving_points = 0;  //!< number of moving points
  bool registered = false;        //!< false: its motion was predicted, not measured
  bool keyframe = false;
};

/** A moving object at one scan, map frame. */
struct PageObjectState
{
  std::size_t scan = 0;  //!< index in RunPage::scans
  Box box;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< velocity in the map frame [m/s]
};

struct PageObject
{
  int id = -1;
  ObjectClass object_class = ObjectClass::unknown;
  std::vector<PageObjectState> states;  //!< in order of time, at least one
};

struct PageLoop
{
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  //!< position at the first visit, map frame [m]
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    //!< position at the later visit, map frame [m]
};

/** A scan of a further lidar that was merged into one of the first lidar. */
struct PageScanPart
{
  std::size_t scan = 0;  //!< PageScan::index of the scan that it was merged into
  std::string sensor_label;
  double stamp = 0;  //!< [s]
  std::size_t points = 0;
};

/** Content of the page of a run. Texts may have any characters; the page shows them literally. */
struct RunPage
{
  std::string title;
  std::string input;     //!< path of the recording
  std::string sensor;    //!< description of the sensor; may be empty
  std::string method;    //!< names of the methods in use
  std::string settings;  //!< the effective ini
  /** usable, doubtful (the warnings say why) or unusable (failure says why) */
  std::string verdict = "usable";
  std::string failure;  //!< why the result is unusable; empty if it is usable
  std::vector<std::string> warnings;
  std::vector<std::string> files;          //!< names of the files in the folder of the run
  std::map<std::string, double> stage_ms;  //!< mean time of each stage per scan [ms]
  double run_time = 0;                     //!< time of the run up to the page [s]; 0: unknown
  double recording_time = 0;               //!< duration of the processed part of the recording [s]

  std::vector<PageScan> scans;
  std::vector<PageScanPart> parts;  //!< scans of further lidars
  Trajectory trajectory;            //!< vehicle pose of every scan, map frame
  Trajectory odometry;              //!< vehicle pose of every scan by odometry, odometry frame
  Trajectory reference;             //!< ground truth in the map frame; empty without
  std::string reference_origin;     //!< source of the ground truth, and whether it is exact
  /** What `reference` is if its own errors can be as large as those of the run, as "GNSS/INS": the
   * page then speaks of differences to it, not of errors; else empty. */
  std::string difference_to;
  std::vector<PageLoop> loops;     //!< loops in use
  std::size_t loops_left_out = 0;  //!< number of loops that contradict the others
  std::optional<Georeference> georeference;
  std::optional<Gravity> gravity;
  std::optional<PriorMapFit> prior_map;  //!< nothing without a prior map
  std::vector<PageObject> objects;       //!< objects that moved
  std::size_t reported_tracks = 0;       //!< number of ids in tracks.csv; also of those at rest

  const std::vector<Eigen::Vector3f>* map_points = nullptr;  //!< map frame [m]; null: no map
  const std::vector<float>* map_intensity = nullptr;         //!< in [0, 1], one per point, or null
  std::size_t map_size = 0;  //!< number of points of the map, if map_points are a part of them
  std::vector<std::uint8_t> picture;  //!< PNG of the map from above, or none
};

/** Ini section `[report]`. */
struct RunPageOptions : Options
{
  int max_points = 1000000;  //!< map points in the 3D view; beyond, they are voxel-sampled
  int max_scans = 10000;     //!< upper limit of the scans in the plots, evenly sampled
  void describe(OptionsVisitor& visitor) override;
};

/** The page as one HTML file that needs no other files and no network.
 * \param page_template text of share/dyslam/report/page.html
 * \throws std::invalid_argument if trajectory or odometry has another length than `scans`, or the
 * intensity another than the points. \throws UserError if the template lacks a placeholder. */
[[nodiscard]] std::string renderRunPage(const RunPage& page,
                                        const std::string& page_template,
                                        const RunPageOptions& options = {});
}  // namespace dyslam
