// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <deque>
#include <string>

#include "GzInput.h"

namespace dyslam
{
/** The observations of a rawlog one by one, whichever of MRPT's two styles it is written in. */
class RawlogStream
{
 public:
  /** \throws UserError if the file is missing, empty or clearly no rawlog. */
  explicit RawlogStream(const std::string& path);

  /** The next observation, null at the end.
   * \throws UserError if the file is cut short, damaged or holds things that are no rawlog's. */
  [[nodiscard]] mrpt::obs::CObservation::Ptr next();

  [[nodiscard]] const std::string& path() const { return path_; }
  /** `<name>_Images` beside the file if it is there, else the file's own folder. */
  [[nodiscard]] const std::string& externalFolder() const { return external_folder_; }
  [[nodiscard]] double progress() const { return file_.progress(); }

 private:
  void readObject();
  [[noreturn]] void failReading(const std::string& reason) const;

  std::string path_;
  std::string external_folder_;
  GzInput file_;
  std::deque<mrpt::obs::CObservation::Ptr> queue_;
  std::size_t objects_ = 0;  //!< whole objects read
};
}  // namespace dyslam
