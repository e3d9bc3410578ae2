// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/Conversion.h>
#include <dyslam/io/RecordingOptions.h>

#include <optional>
#include <string>

namespace dyslam
{
/** Converts a recording that is no rawlog with convertScans() or convertKitti(), chosen by
 * recordingKind(). */
class RecordingConverter
{
 public:
  /** \throws UserError for a folder that no converter reads. */
  explicit RecordingConverter(const std::string& input);

  /** Whether the recording has to be converted; false for a file that may be a rawlog. */
  [[nodiscard]] bool isNeeded() const { return needed_; }
  /** Program for the same conversion: "kitti2rawlog --kind raw" or "scans2rawlog". */
  [[nodiscard]] std::string program() const;
  /** Converts. \pre isNeeded() \param unpacking see convertScans() \param range the part that is
   * converted \throws UserError, also for options that don't apply to the recording. */
  ConversionResult convert(const std::string& output,
                           const RecordingOptions& options,
                           const ConversionProgress& progress = {},
                           const BagUnpackingProgress& unpacking = {},
                           const ScanRange& range = {}) const;

 private:
  std::string input_;
  std::optional<KittiKind> kitti_;  //!< nothing: no KITTI recording
  bool needed_;
};
}  // namespace dyslam
