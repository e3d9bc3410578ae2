// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Layout.h>
#include <dyslam/core/Options.h>
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
  bool hindsight_tracking = true;  //!< track again with the labels of `labels.hindsight`
  bool mapping = true;             //!< build the static map
  void describe(OptionsVisitor& visitor) override;
};

/** Begins to load what the config's methods need beyond the program itself, in a thread of its own:
 * the networks. \return a future; keep it until the Pipeline is constructed. \throws UserError for
 * a bad config.
 */
[[nodiscard]] std::future<void> loadAhead(const Config& config);

/** The complete pipeline (the paper's Fig. 1): from a scan to its pose, moving points and objects.
 *
 * Stages are chosen by name in the config: [dyseg] method, [odometry] method, [refine] method.
 * Results depend on the frames, the config and the seed alone, not on the number of threads.
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

  /** Fills every part of the frame that the source left open: runFrontEnd(), then runBackEnd().
   * Frames come in order of time. */
  void process(Frame& frame);

  // The two halves share nothing but the frame: one thread may run the front end on a frame while
  // another runs the back end on the frame before. Each gets every frame, in order of time.

  /** FrontEnd::process(). */
  void runFrontEnd(Frame& frame, const Frame* next = nullptr);
  /** deskew(), trackObjects(), addOdometry(), addLoops(), optimise() and finaliseFrames(). */
  void runBackEnd(Frame& frame);

  // The steps of runBackEnd(), for callers that do something in between, as MRPT's graph-SLAM
  // engine does: all of them for every frame, in this order.

  /** Deskews the cloud by the motion that the front end has found. */
  void deskew(Frame& frame);
  /** Detector and Tracker, where `pipeline.tracking` is on. */
  void trackObjects(Frame& frame);
  /** Backend::addOdometry(). \return whether the frame is a keyframe, and so a new node. */
  bool addOdometry(Frame& frame);
  /** Backend::addLoops(). \return how many were accepted. */
  std::size_t addLoops(const Frame& frame);
  /** Backend::optimise(). \return whether a keyframe was moved. */
  bool optimise(Frame& frame);
  /** Makes final what can be: moving points and objects of the scans whose later scans are known
   * (`labels.hindsight`), which onFinal()'s receiver gets, and the map of final keyframes, if
   * mapping is on. The first frame waits for the second one, whose motion deskews it. */
  void finaliseFrames(const Frame& frame);

  /** Sets the receiver of every frame, in order, once its moving points and objects are final: with
   * `labels.hindsight` some seconds later, the last ones in finish().
   * \param parts what it needs of a frame, `points` at least; the less, the less memory. */
  void onFinal(std::function<void(Frame)> use, FrameParts parts);
  /** Whether final frames have other objects than those of trackObjects(), with ids of their own:
   * detected and tracked again with hindsight (`pipeline.hindsight_tracking`). Not if objects are
   * in the graph, which has those of trackObjects(). */
  [[nodiscard]] bool tracksWithHindsight() const;

  /** After the last frame: optimises once more and corrects the map. */
  void finish();

  // What is kept from frame to frame, of each half, for its own thread. It is loaded before the
  // first frame, into a pipeline with the same config.
  void exchangeFrontEndState(StateArchive& archive);
  void exchangeBackEndState(StateArchive& archive);

  [[nodiscard]] const Backend& backend() const;
  /** The static map; null if mapping is off. */
  [[nodiscard]] const StaticMap* map() const;
  /** Pose of the vehicle at every frame by the backend's present estimate, map frame. */
  [[nodiscard]] Trajectory trajectory() const;
  /** FrontEnd::waits(). */
  [[nodiscard]] FrontEndWaits frontEndWaits() const;
  /** The methods in use, for reports: "network + constant_velocity + point_to_plane". */
  [[nodiscard]] std::string summary() const;
  /** Warnings about config and recording, one sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};
}  // namespace dyslam
