// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

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
  double for_encoding = 0;  //!< of process() for the encoding of the next scan
  double for_scans = 0;     //!< of the encoding thread; 0 if nothing was encoded ahead
};

/** The stages up to the pose: motion prior, preprocessing, segmentation, odometry, and the decision
 * what moves.
 *
 * Not thread-safe; one object per recording. Same bytes for any number of threads.
 */
class FrontEnd
{
 public:
  /** Loads [dyseg], [preprocess], the segmenters' sections and those of Odometry.
   * \param threads 0: as many as the machine has \param times outlives the object; gets the time of
   * each stage. \throws UserError for bad options. */
  FrontEnd(int threads, ConfigLoader& config, mrpt::system::CTimeLogger& times);
  ~FrontEnd();

  /** Fills every part of the frame between source and detection. Frames come in order of time. The
   * cloud of the frame is deskewed by the prior.
   *
   * A segmenter that encodes ahead (MovingSegmenter::encodesAhead()) gets its clouds as they were
   * expected to be one scan earlier: deskewed by the prior of the scan before. \param next the scan
   * after the frame, if it is there: it is prepared and encoded so in another thread, beside
   * segmentation and registration of the frame. Read until process() returns; the next call gets a
   * frame with this scan. Same bytes without it. */
  void process(Frame& frame, const Frame* next = nullptr);
  [[nodiscard]] FrontEndWaits waits() const;
  /** What is kept from frame to frame. */
  void exchangeState(StateArchive& archive);

  /** The methods in use, as "network + constant_velocity + point_to_plane". */
  [[nodiscard]] std::string summary() const;
  /** Warnings about config and recording, one sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};
}  // namespace dyslam
