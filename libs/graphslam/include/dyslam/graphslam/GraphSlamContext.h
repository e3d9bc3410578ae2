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
 * The graph that is solved is the backend's, since MRPT's network holds only poses and edges
 * between them. The deciders show the backend's graph in the engine's network: node k is keyframe
 * k, edges are the odometry between keyframes and the accepted loops.
 *
 * Not thread-safe; one object per recording.
 */
class GraphSlamContext
{
 public:
  using Graph = mrpt::graphs::CNetworkOfPoses3DInf;

  /** \param pipeline outlives the context \param only_first_n number of scans to use; 0: all
   * \param on_frame gets each frame when nothing more will be added to it, in order of time */
  GraphSlamContext(Pipeline& pipeline,
                   ScanDecoder decoder,
                   std::size_t only_first_n = 0,
                   std::function<void(Frame)> on_frame = {});

  /** Begins a step of the engine: frame() is null until a scan comes. */
  void beginStep();
  /** Takes an observation of the step; a scan goes through the front end and into the backend.
   * \throws UserError for a second scan in one step, and as ScanDecoder does. */
  void takeObservation(const mrpt::obs::CObservation::Ptr& observation);
  /** Frame of the present step; null if the step had no scan. */
  [[nodiscard]] const Frame* frame() const;

  // Only for a step that has a frame:
  /** Pipeline::addLoops(). \return number of accepted loops */
  std::size_t addLoops();
  /** Pipeline::optimise(). \return whether keyframes were moved. */
  bool optimise();

  /** Whether all requested scans were used; further scans are skipped. */
  [[nodiscard]] bool done() const { return done_; }
  /** To be called once, after the last observation: decides the loops still open and solves once
   * more. */
  void finish();

  /** The backend's graph as the network that the engine should hold. */
  [[nodiscard]] Graph view() const;
  /** T_map_vehicle at the newest scan; identity before the first scan. */
  [[nodiscard]] const Pose& vehicle() const { return T_map_vehicle_; }
  [[nodiscard]] ScanDecoder& decoder() { return decoder_; }
  [[nodiscard]] const Pipeline& pipeline() const { return pipeline_; }
  [[nodiscard]] const Backend& backend() const;

 private:
  void complete();

  Pipeline& pipeline_;
  ScanDecoder decoder_;
  std::size_t only_first_n_;
  std::function<void(Frame)> on_frame_;
  std::optional<Frame> frame_;  //!< newest frame; its ground truth may still come
  double clock_shift_ = 0;      //!< clock shift of frame_'s scan [s]
  bool in_step_ = false;        //!< frame_ is of the present step
  bool done_ = false;
  bool finished_ = false;
  std::size_t scans_ = 0;
  Pose T_map_vehicle_ = Pose::Identity();
};
}  // namespace dyslam
