// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Layout.h>
#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <functional>
#include <future>
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

class Backend;
class StaticMap;
struct FrontEndWaits;
enum class FrameParts;

struct PipelineOptions : Options
{
  int threads = 0;                 //!< threads of the stages' loops; 0: one per core
  bool tracking = true;            //!< detect and track moving objects
  bool hindsight_tracking = true;  //!< second tracking, on the labels with hindsight
  bool mapping = true;             //!< build the static map
  void describe(OptionsVisitor& visitor) override;
};

/** Starts loading the libraries of the networks that the config's methods need, in another thread.
 * \return future to be kept until the Pipeline is constructed \throws UserError for a bad config.
 */
[[nodiscard]] std::future<void> loadAhead(const Config& config);

/** The complete pipeline (the paper's Fig. 1): from a scan to its pose, moving points and objects.
 *
 * Stages are chosen by name in the config: [dyseg] method, [odometry] method, [refine] method.
 * Results depend only on the frames, the config and the seed, not on the number of threads.
 */
class Pipeline
{
 public:
  /** Builds every stage. \param times gets the time of each stage \param temporary_folder where
   * map and keyframes beyond `memory.limit` go, in a file without a name; exists at the first frame
   * \param program leave it out: that of the caller's compiler flags is compared with the library's
   * \throws UserError for a bad config; std::logic_error for a program with another layout. */
  Pipeline(ConfigLoader& config,
           mrpt::system::CTimeLogger& times,
           const std::string& temporary_folder = "",
           const Layout& program = layout_here);
  ~Pipeline();

  /** Runs all stages on a frame: runFrontEnd(), then runBackEnd(). Frames come in order of time. */
  void process(Frame& frame);

  // Front end and back end share only the frame: one thread may run the front end on a frame while
  // another one runs the back end on the previous frame. Each gets every frame, in order of time.

  /** See FrontEnd::process(). */
  void runFrontEnd(Frame& frame, const Frame* next = nullptr);
  /** Calls deskew(), trackObjects(), addOdometry(), addLoops(), optimise() and finaliseFrames(). */
  void runBackEnd(Frame& frame);

  // The steps of runBackEnd(), for callers that do something between them (MRPT's graph-SLAM
  // engine): all of them for every frame, in this order.

  /** Deskews the cloud with the motion estimated by the front end. */
  void deskew(Frame& frame);
  /** Runs Detector and Tracker, if `pipeline.tracking` is on. */
  void trackObjects(Frame& frame);
  /** See Backend::addOdometry(). \return whether the frame is a keyframe (a new node) */
  bool addOdometry(Frame& frame);
  /** See Backend::addLoops(). \return number of loops added */
  std::size_t addLoops(const Frame& frame);
  /** See Backend::optimise(). \return whether the pose of a keyframe changed */
  bool optimise(Frame& frame);
  /** Makes frames final whose later scans are known now: passes them to the receiver of onFinal(),
   * and adds final keyframes to the map, if mapping is on. The frame itself is one of them without
   * `labels.hindsight`; with it, the frame of `labels.window` scans before. */
  void finaliseFrames(const Frame& frame);

  // Each scan has two frames. The causal frame is what process() or the last step leaves in its
  // argument: moving points and objects by this scan and those before. The final frame follows
  // later, with what the later scans show: labels with hindsight (`labels.hindsight`) and, where
  // hasSecondTracking(), other objects. It is a copy.

  /** Sets the receiver of final frames. It gets the final frame of every scan once, in the order of
   * the scans: from finaliseFrames(), in its thread; the last ones from finish(), which may call it
   * in a thread of its own that has ended when finish() returns. Without `labels.hindsight` the
   * final frame of a scan (but the first) comes while its causal frame is still being processed.
   * The receiver may keep the frame.
   *
   * \param parts parts of a frame that the receiver needs; it may get more. They are held in memory
   *   for `labels.window` scans. `none`: the receiver is not called
   * \throws std::logic_error after the first frame, of which no such copy was made */
  void onFinal(std::function<void(Frame)> receive, FrameParts parts);
  /** Whether the objects of final frames are those of a second tracking
   * (`pipeline.hindsight_tracking`), with ids of their own; if not, they are those of
   * trackObjects(). False without tracking or `labels.hindsight`, with boxes of another program,
   * and if objects are in the graph, which has those of trackObjects(). */
  [[nodiscard]] bool hasSecondTracking() const;

  /** To be called after the last frame: optimises once more, makes the remaining frames final, and
   * corrects the map. */
  void finish();

  // Save or load the state between frames of front end and back end, each in its own thread. It is
  // loaded before the first frame, into a pipeline with the same config.
  void exchangeFrontEndState(StateArchive& archive);
  void exchangeBackEndState(StateArchive& archive);

  [[nodiscard]] const Backend& backend() const;
  /** The static map; null if mapping is off. */
  [[nodiscard]] const StaticMap* map() const;
  /** Pose of the vehicle at every frame by the backend's present estimate, map frame. */
  [[nodiscard]] Trajectory trajectory() const;
  /** See FrontEnd::waits(). */
  [[nodiscard]] FrontEndWaits frontEndWaits() const;
  /** Names of the methods in use, such as "network + constant_velocity + point_to_plane". */
  [[nodiscard]] std::string summary() const;
  /** Warnings about config and recording, one sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};
}  // namespace dyslam
