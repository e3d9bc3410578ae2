// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>

#include <memory>
#include <string>
#include <vector>

namespace mrpt::system
{
class CTimeLogger;
}

namespace dyslam
{
class StateArchive;

/** Waiting times of the front end's two threads so far [s]. */
struct FrontEndWaits
{
  double for_encoding = 0;  //!< time process() waited for the encoding of the next scan [s]
  double for_scans = 0;     //!< time the encoding thread waited for scans [s]; 0 without it
};

/** The stages up to the pose: motion prior, preprocessing, segmentation, odometry, and the
 * classification of points as moving or static.
 *
 * Not thread-safe; one object per recording. The result is identical for any number of threads.
 */
class FrontEnd
{
 public:
  /** Loads [dyseg], [preprocess], the sections of the segmenters and of Odometry.
   * \param threads number of threads; 0: number of cores \param times records the time of each
   * stage; outlives the object. \throws UserError for bad options. */
  FrontEnd(int threads, ConfigLoader& config, mrpt::system::CTimeLogger& times);
  ~FrontEnd();

  /** Fills every part of the frame between source and detection. Frames come in order of time. The
   * cloud of the frame is deskewed with the motion prior.
   *
   * A segmenter that encodes ahead (MovingSegmenter::encodesAhead()) gets clouds that are deskewed
   * with the motion prior of the previous scan. \param next the scan after the frame, or null: it
   * is prepared and encoded in another thread, during segmentation and registration of the frame.
   * It is read until process() returns; the next call gets a frame with this scan. The result is
   * the same without it. */
  void process(Frame& frame, const Frame* next = nullptr);
  [[nodiscard]] FrontEndWaits waits() const;
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

  /** Names of the methods in use, such as "network + constant_velocity + point_to_plane". */
  [[nodiscard]] std::string summary() const;
  /** Warnings about config and recording, one sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};
}  // namespace dyslam
