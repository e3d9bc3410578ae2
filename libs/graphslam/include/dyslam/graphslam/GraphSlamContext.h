// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/io/ScanDecoder.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <cstddef>
#include <functional>
#include <optional>

namespace dyslam
{
class Backend;
class Pipeline;

/** Shared state of node decider, edge decider and optimiser of one engine: the decoder of its
 * observations, the pipeline whose steps they call, and the frame of the current observation.
 *
 * MRPT's network holds poses and edges between them only, so it is not what is solved: that is the
 * backend's graph. The deciders show it in the engine's network: node k is keyframe k, edges are
 * the odometry between keyframes and the accepted loops.
 *
 * Not thread-safe; one object per recording.
 */
class GraphSlamContext
{
 public:
  using Graph = mrpt::graphs::CNetworkOfPoses3DInf;

  /** \param pipeline outlives the context \param only_first_n scans to use; 0: all
   * \param on_frame gets each frame when nothing more will be added to it, in order of time */
  GraphSlamContext(Pipeline& pipeline,
                   ScanDecoder decoder,
                   std::size_t only_first_n = 0,
                   std::function<void(Frame)> on_frame = {});

  /** Begins a step of the engine: frame() is null until a scan comes. */
  void beginStep();
  /** An observation of the step; if it is a scan it goes through the front end and into the
   * backend. \throws UserError for a second scan in one step, and as ScanDecoder does. */
  void takeObservation(const mrpt::obs::CObservation::Ptr& observation);
  /** Of the present step, null if it had no scan. */
  [[nodiscard]] const Frame* frame() const;

  // Of a step that has a frame:
  /** Pipeline::addLoops(). \return how many were accepted. */
  std::size_t addLoops();
  /** Pipeline::optimise(). \return whether keyframes were moved. */
  bool optimise();

  /** Whether all requested scans were used; further ones are skipped. */
  [[nodiscard]] bool done() const { return done_; }
  /** After the last observation: decides the loops still open, solves once more. Once only. */
  void finish();

  /** The backend's graph as the network that the engine should hold. */
  [[nodiscard]] Graph view() const;
  /** T_map_vehicle at the newest scan; identity before the first. */
  [[nodiscard]] const Pose& vehicle() const { return T_map_vehicle_; }
  [[nodiscard]] const ScanDecoder& decoder() const { return decoder_; }
  [[nodiscard]] const Pipeline& pipeline() const { return pipeline_; }
  [[nodiscard]] const Backend& backend() const;

 private:
  void complete();

  Pipeline& pipeline_;
  ScanDecoder decoder_;
  std::size_t only_first_n_;
  std::function<void(Frame)> on_frame_;
  std::optional<Frame> frame_;  //!< newest; its ground truth may still come
  double clock_shift_ = 0;      //!< of frame_'s scan [s]
  bool in_step_ = false;        //!< frame_ is of the present step
  bool done_ = false;
  bool finished_ = false;
  std::size_t scans_ = 0;
  Pose T_map_vehicle_ = Pose::Identity();
};
}  // namespace dyslam
