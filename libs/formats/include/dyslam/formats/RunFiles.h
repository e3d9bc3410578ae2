// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** Names in the output folder of a run, for those that write a file and those that look for it. */
namespace run_files
{
constexpr const char* settings = "effective.ini";         //!< every setting of the run
constexpr const char* report = "report.json";             //!< figures, written last
constexpr const char* page = "report.html";               //!< the run in a browser
constexpr const char* trajectory = "trajectory_tum.txt";  //!< T_map_vehicle of every scan
constexpr const char* trajectory_utm = "trajectory_utm.txt";
constexpr const char* odometry = "odometry_tum.txt";    //!< T_odom_vehicle of every scan
constexpr const char* reference = "reference_tum.txt";  //!< ground truth in the map frame
constexpr const char* motions = "motions.csv";          //!< covariance of each odometry motion
constexpr const char* scan_table = "scans.csv";         //!< result of each scan
constexpr const char* scan_parts = "scan_parts.csv";    //!< scans of further lidars
constexpr const char* labels = "labels";                //!< folder of label files
constexpr const char* tracks = "tracks.txt";            //!< objects, lidar frame
constexpr const char* track_table = "tracks.csv";       //!< objects, odometry frame
constexpr const char* factor_graph = "factor_graph.txt";
constexpr const char* georeference = "georeference.ini";
constexpr const char* map_pcd = "map_static.pcd";
constexpr const char* map_ply = "map_static.ply";
constexpr const char* state = "resume.state";          //!< checkpoint of an unfinished run
constexpr const char* recording = "recording.rawlog";  //!< what another input is converted to
}  // namespace run_files

/** Names of the files that a run wrote, by report.json in its folder; none without it or if it is
 * damaged. */
[[nodiscard]] std::vector<std::string> filesOfRun(const std::string& folder);
/** Whether a folder has the settings and the report of a run, so that clouds in it are maps and no
 * scans; false if it cannot be read. */
[[nodiscard]] bool isRunFolder(const std::string& folder);
/** Whether a file is one of filesOfRun() its folder. */
[[nodiscard]] bool isFileOfRun(const std::string& file);

/** Path of the recording of a run: `input` or, if that is not there, the file of its name in the
 * folder of the run, if there is one. A converted recording is moved with that folder.
 * \param input as in report.json of the run */
[[nodiscard]] std::string recordingOfRun(const std::string& folder, const std::string& input);

/** Path of the static map of a run, map_static.pcd or map_static.ply; empty if it has neither. */
[[nodiscard]] std::string staticMapOfRun(const std::string& folder);
}  // namespace dyslam
