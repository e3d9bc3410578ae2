// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Trajectory.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Result of one scan. */
struct PageScan
{
  std::size_t index = 0;          //!< number in the recording
  std::size_t points = 0;         //!< used of it
  std::size_t moving_points = 0;  //!< of these
  bool registered = false;        //!< false: its motion was predicted, not measured
  bool keyframe = false;
};

/** A moving object at one scan, map frame. */
struct PageObjectState
{
  std::size_t scan = 0;  //!< position in RunPage::scans
  Box box;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< [m/s]
};

struct PageObject
{
  int id = -1;
  ObjectClass object_class = ObjectClass::unknown;
  std::vector<PageObjectState> states;  //!< in order of time, at least one
};

struct PageLoop
{
  Eigen::Vector3d from =
      Eigen::Vector3d::Zero();                   //!< where the place was seen first, map frame [m]
  Eigen::Vector3d to = Eigen::Vector3d::Zero();  //!< where it was seen again
};

/** All that the page of a run shows. Texts may hold anything; the page shows them as they are. */
struct RunPage
{
  std::string title;
  std::string input;     //!< the recording
  std::string sensor;    //!< what the recording shows of it; may be empty
  std::string method;    //!< stages in use
  std::string settings;  //!< the effective ini
  /** usable, doubtful (the warnings say why) or unusable (failure says why) */
  std::string verdict = "usable";
  std::string failure;  //!< why the result is unusable; empty if it is usable
  std::vector<std::string> warnings;
  std::vector<std::string> files;          //!< in the folder of the run, beside the page
  std::map<std::string, double> stage_ms;  //!< mean per scan [ms]

  std::vector<PageScan> scans;
  Trajectory trajectory;            //!< of the vehicle in the map frame, a pose per scan
  Trajectory odometry;              //!< before the graph, a pose per scan, in a frame of its own
  Trajectory reference;             //!< ground truth in the map frame; empty where there is none
  std::string reference_origin;     //!< where the ground truth is from, and whether it is exact
  std::vector<PageLoop> loops;      //!< in use
  std::size_t loops_left_out = 0;   //!< that contradict these
  std::vector<PageObject> objects;  //!< those that moved

  const std::vector<Eigen::Vector3f>* map_points = nullptr;  //!< map frame [m]; null: no map
  const std::vector<float>* map_intensity = nullptr;         //!< in [0, 1], one per point, or null
  std::vector<std::uint8_t> picture;                         //!< PNG of the map from above, or none
};

/** Ini section `[report]`. */
struct RunPageOptions : Options
{
  int max_points = 1000000;  //!< map points in the 3D view; beyond, they are voxel-sampled
  int max_scans = 10000;     //!< upper limit of the scans in the plots, evenly sampled
  void describe(OptionsVisitor& visitor) override;
};

/** One HTML file that needs nothing beside it and no network.
 * \param page_template text of share/dyslam/report/page.html
 * \throws std::invalid_argument if trajectory or odometry has another length than `scans`, or the
 * intensity another than the points. \throws UserError if the template lacks a placeholder. */
[[nodiscard]] std::string renderRunPage(const RunPage& page,
                                        const std::string& page_template,
                                        const RunPageOptions& options = {});
}  // namespace dyslam
