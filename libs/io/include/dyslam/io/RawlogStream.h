// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class GzInput;
class RawlogObjects;

/** Reads the observations of a rawlog, plain or gzip, in either of MRPT's two styles. Observations
 * other than scans, poses and samples of IMU and wheel odometry, and damaged samples, come empty
 * and without a time stamp; observations of classes unknown to MRPT are left out. Counts in the
 * file are checked against its bytes before memory is allocated. Not thread-safe. */
class RawlogStream
{
 public:
  /** \param stop asked while the stream waits for more of a file that grows
   * (dyslam/base/GrowingFile.h): true ends it. Null for never.
   * \throws UserError if the file is missing, empty or clearly no rawlog. */
  explicit RawlogStream(const std::string& path, std::function<bool()> stop = nullptr);
  ~RawlogStream();
  RawlogStream(RawlogStream&&) noexcept;
  RawlogStream& operator=(RawlogStream&&) noexcept;

  /** The next observation, null at the end and when stopped.
   * \throws UserError if the file is cut short, damaged, of a newer MRPT, or holds things that are
   * no rawlog's. */
  [[nodiscard]] mrpt::obs::CObservation::Ptr next();

  [[nodiscard]] const std::string& path() const { return path_; }
  /** externalFolderOf() the file; without such a folder, the folder of the file. */
  [[nodiscard]] const std::string& externalFolder() const { return external_folder_; }
  /** Whether `stop` has ended it. */
  [[nodiscard]] bool isStopped() const;
  /** Number of observations left out so far, by class unknown to MRPT. */
  [[nodiscard]] const std::map<std::string, std::size_t>& leftOut() const;
  /** Warnings about observations left out, one line per class, and about what follows the last
   * gzip data of the file. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** Fraction of the (compressed) file read so far, 0 to 1. */
  [[nodiscard]] double progress() const;

 private:
  void readObject();
  [[noreturn]] void failReading(const std::string& reason) const;

  std::string path_;
  std::string external_folder_;
  std::unique_ptr<GzInput> file_;
  std::unique_ptr<RawlogObjects> objects_in_;
  std::deque<mrpt::obs::CObservation::Ptr> queue_;
  std::size_t objects_ = 0;  //!< number of complete objects read
};
}  // namespace dyslam
