// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class GzInput;
class RawlogObjects;

/** The observations of a rawlog, plain or gzip, one by one, whichever of MRPT's two styles it is
 * written in. Those that hold neither scans nor poses nor the samples of an IMU or of wheel
 * odometry come empty and without a time stamp, and so do samples that are damaged; those of
 * classes that MRPT does not have are left out. Counts in the file are checked against its bytes
 * before any memory is taken. Not thread-safe. */
class RawlogStream
{
 public:
  /** \throws UserError if the file is missing, empty or clearly no rawlog. */
  explicit RawlogStream(const std::string& path);
  ~RawlogStream();
  RawlogStream(RawlogStream&&) noexcept;
  RawlogStream& operator=(RawlogStream&&) noexcept;

  /** The next observation, null at the end.
   * \throws UserError if the file is cut short, damaged, of a newer MRPT, or holds things that are
   * no rawlog's. */
  [[nodiscard]] mrpt::obs::CObservation::Ptr next();

  [[nodiscard]] const std::string& path() const { return path_; }
  /** externalFolderOf() the file, else the file's own folder. */
  [[nodiscard]] const std::string& externalFolder() const { return external_folder_; }
  /** How many observations were left out so far, for each class that MRPT does not have. */
  [[nodiscard]] const std::map<std::string, std::size_t>& leftOut() const;
  /** The same in words, a line for each class. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** Bytes of the (compressed) file read so far, 0 to 1. */
  [[nodiscard]] double progress() const;

 private:
  void readObject();
  [[noreturn]] void failReading(const std::string& reason) const;

  std::string path_;
  std::string external_folder_;
  std::unique_ptr<GzInput> file_;
  std::unique_ptr<RawlogObjects> objects_in_;
  std::deque<mrpt::obs::CObservation::Ptr> queue_;
  std::size_t objects_ = 0;  //!< whole objects read
};
}  // namespace dyslam
