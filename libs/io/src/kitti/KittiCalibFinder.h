// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/KittiFiles.h>
#include <dyslam/io/KittiConverter.h>

#include <filesystem>
#include <string>
#include <vector>

namespace dyslam
{
/** The file or folder that an option names, else the first candidate that exists; empty if none
 * does. \throws UserError if the one that is named is not there. */
[[nodiscard]] std::string firstExisting(const std::string& named,
                                        const std::vector<std::filesystem::path>& candidates);

/** The folder that a folder is in, also of one that is given from within that: `..` of `.`. */
[[nodiscard]] std::filesystem::path folderAbove(const std::filesystem::path& folder);

/** The calibration of a KITTI recording, which is looked for when something needs it. */
class KittiCalibFinder
{
 public:
  /** \param input folder of the recording \param sequence of tracking's official layout, or empty
   * \param options must outlive this */
  KittiCalibFinder(const std::filesystem::path& input,
                   const std::string& sequence,
                   const KittiConverterOptions& options);

  /** Reads the calibration that the options name, or that the layout has, if there is one.
   * \throws UserError if it is named and not there, or damaged. */
  void read();

  /** T_cam_velo. \param for_what what needs it, for the message. \throws UserError without it. */
  [[nodiscard]] const Pose& requireCamera(const std::string& for_what);
  /** T_velo_imu. \param for_what what needs it, for the message. \throws UserError without it. */
  [[nodiscard]] const Pose& requireImu(const std::string& for_what);

 private:
  [[nodiscard]] std::vector<std::filesystem::path> rawFolders() const;
  [[nodiscard]] std::vector<std::filesystem::path> foldersOf360() const;
  [[nodiscard]] std::string missingText(const std::string& for_what) const;
  const KittiCalib& require(const std::string& for_what);

  std::filesystem::path input_;
  std::string sequence_;
  const KittiConverterOptions& options_;
  std::string path_;  //!< of the calibration; empty: not read
  KittiCalib calib_;
};
}  // namespace dyslam
