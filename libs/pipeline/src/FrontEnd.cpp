// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Parallel.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/OwnVehicle.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <dyslam/pipeline/JobThread.h>
#include <mrpt/system/CTimeLogger.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "GivenLabels.h"

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

namespace
{
/** Predicted motion for deskewing. */
struct SweepPrediction
{
  Pose T_previous_current = Pose::Identity();
  double dt = 0;              //!< Frame::dt [s]
  double sweep_duration = 0;  //!< Frame::sweep_duration [s]
};

/** A prepared cloud, and the same as the segmenter's network encodes it. */
struct EncodedScan
{
  Cloud cloud;
  std::shared_ptr<const EncodedCloud> encoded;
};

/** Waits for the encoding of the next scan, also after an exception, as it reads the caller's
 * frame. */
struct WaitAtEnd
{
  const std::future<EncodedScan>& ahead;
  std::atomic<double>& waited;  //!< waiting time [s]
  ~WaitAtEnd()
  {
    if (ahead.valid())
    {
      const auto begin = std::chrono::steady_clock::now();
      ahead.wait();
      const std::chrono::duration<double> wait = std::chrono::steady_clock::now() - begin;
      waited = waited + wait.count();
    }
  }
};
}  // namespace

struct FrontEnd::Stages
{
  Stages(int threads, ConfigLoader& config, mrpt::system::CTimeLogger& time_logger)
      : times(time_logger),
        segmentation(config.get<MovingSegmenterOptions>("dyseg")),
        given_labels(segmentation.labels),
        pool(threads),
        preprocessor(config.get<PreprocessOptions>("preprocess"), pool),
        own_vehicle(preprocessor.options().own_vehicle_range),
        segmenter(makeSegmenter(segmentation.method, config, pool)),
        odometry(config, pool, times)
  {
  }

  [[nodiscard]] Cloud prepare(const Scan& scan, const SweepPrediction& sweep);
  /** \return prepared cloud without the labelled points */
  [[nodiscard]] Cloud prepareWithout(LabelledPoints& labelled,
                                     const Scan& scan,
                                     const SweepPrediction& sweep);
  [[nodiscard]] std::shared_ptr<const EncodedCloud> encode(const Cloud& cloud, const Scan& scan);
  [[nodiscard]] EncodedScan encodeAhead(const Scan& scan, const SweepPrediction& sweep);
  /** Starts preparing and encoding the next scan in ahead_thread, if it may be encoded ahead.
   * \param next see FrontEnd::process() */
  void beginAhead(const Frame* next);
  /** Sets the frame's cloud to the one that was encoded with the deskewing of sweep_ahead (now, if
   * beginAhead() was not called for it), and deskews it again by `predicted`. \return the encoding
   * \pre sweep_ahead is set */
  [[nodiscard]] std::shared_ptr<const EncodedCloud> takeAhead(const SweepPrediction& predicted,
                                                              Frame& frame);
  /** Sets the frame's cloud, without the labelled points. \return it as the segmenter encodes it;
   * null if it does not */
  [[nodiscard]] std::shared_ptr<const EncodedCloud> preprocess(Frame& frame,
                                                               LabelledPoints& labelled);
  /** Segments, if the segmenter runs before (false) or after (true) the pose is known. */
  void segment(Frame& frame, bool pose_known, const std::shared_ptr<const EncodedCloud>& encoded);
  /** Puts the points with a given moving label back into scan and cloud, as moving. */
  void putBack(const LabelledPoints& labelled, Frame& frame) const;

  mrpt::system::CTimeLogger& times;
  MovingSegmenterOptions segmentation;
  GivenLabels given_labels;
  ThreadPool pool;
  Preprocessor preprocessor;
  OwnVehicle own_vehicle;
  std::unique_ptr<MovingSegmenter> segmenter;  //!< null: no segmentation
  Odometry odometry;
  /** Motion for deskewing and encoding the next scan ahead; empty if the scan is encoded after its
   * own prediction. */
  std::optional<SweepPrediction> sweep_ahead;
  std::future<EncodedScan> ahead;  //!< encoding of the next scan, if it was given
  std::atomic<double> waited = 0;  //!< time waited for `ahead` [s]
  JobThread ahead_thread{1};
};

FrontEnd::FrontEnd(int threads, ConfigLoader& config, mrpt::system::CTimeLogger& times)
    : stages_(std::make_unique<Stages>(threads, config, times))
{
}

FrontEnd::~FrontEnd() = default;

void FrontEnd::process(Frame& frame, const Frame* next)
{
  Stages& s = *stages_;
  s.odometry.predict(frame);
  LabelledPoints labelled = s.given_labels.pointsOf(frame);
  const auto encoded = s.preprocess(frame, labelled);
  labelled.takeFrom(frame.scan);
  s.own_vehicle.observe(frame.scan);
  s.beginAhead(next);
  const WaitAtEnd wait{s.ahead, s.waited};
  s.segment(frame, false, encoded);
  s.odometry.estimate(frame);
  s.putBack(labelled, frame);
  s.segment(frame, true, encoded);
  decideMoving(frame, s.segmentation.moving_threshold);
  s.odometry.integrate(frame);
  s.own_vehicle.addMotion(frame.motion.T_previous_current);
}

Cloud FrontEnd::Stages::prepare(const Scan& scan, const SweepPrediction& sweep)
{
  const CTimeLoggerEntry timed(times, "preprocess");
  return preprocessor.prepare(scan, sweep.T_previous_current, sweep.dt, sweep.sweep_duration,
                              &own_vehicle);
}

Cloud FrontEnd::Stages::prepareWithout(LabelledPoints& labelled,
                                       const Scan& scan,
                                       const SweepPrediction& sweep)
{
  Cloud cloud = prepare(scan, sweep);
  labelled.takeFrom(cloud);
  return cloud;
}

std::shared_ptr<const EncodedCloud> FrontEnd::Stages::encode(const Cloud& cloud, const Scan& scan)
{
  const CTimeLoggerEntry timed(times, "dyseg");
  return segmenter->encode(cloud, scan.T_vehicle_lidar);
}

EncodedScan FrontEnd::Stages::encodeAhead(const Scan& scan, const SweepPrediction& sweep)
{
  EncodedScan result;
  result.cloud = prepare(scan, sweep);
  result.encoded = encode(result.cloud, scan);
  return result;
}

void FrontEnd::Stages::beginAhead(const Frame* next)
{
  if (next != nullptr && sweep_ahead)
  {
    auto job = std::make_shared<std::packaged_task<EncodedScan()>>(
        [this, next, sweep = *sweep_ahead] { return encodeAhead(next->scan, sweep); });
    ahead = job->get_future();
    ahead_thread.add([job] { (*job)(); });
  }
}

std::shared_ptr<const EncodedCloud> FrontEnd::Stages::takeAhead(const SweepPrediction& predicted,
                                                                Frame& frame)
{
  EncodedScan scan = ahead.valid() ? ahead.get() : encodeAhead(frame.scan, *sweep_ahead);
  frame.cloud = std::move(scan.cloud);
  const CTimeLoggerEntry timed(times, "preprocess");
  redeskew(predicted.T_previous_current, frame.dt, pool, frame.cloud);
  return std::move(scan.encoded);
}

std::shared_ptr<const EncodedCloud> FrontEnd::Stages::preprocess(Frame& frame,
                                                                 LabelledPoints& labelled)
{
  const SweepPrediction predicted{frame.prior.T_previous_current, frame.dt, frame.sweep_duration};
  std::shared_ptr<const EncodedCloud> encoded;
  if (sweep_ahead)
  {
    encoded = takeAhead(predicted, frame);
  }
  else
  {
    frame.cloud = prepareWithout(labelled, frame.scan, predicted);
  }
  bool prepared_again = false;
  odometry.resolveInterval(
      frame,
      [&](const Pose& T_previous_current, double dt)
      {
        prepared_again = true;
        return prepareWithout(labelled, frame.scan, {T_previous_current, dt, frame.sweep_duration});
      });
  if (segmenter && (!encoded || prepared_again))
  {
    encoded = encode(frame.cloud, frame.scan);
  }
  sweep_ahead.reset();
  if (segmenter && segmenter->encodesAhead() && frame.prior.reliable && !prepared_again &&
      !given_labels.any())
  {
    sweep_ahead = predicted;
  }
  return encoded;
}

void FrontEnd::Stages::segment(Frame& frame,
                               bool pose_known,
                               const std::shared_ptr<const EncodedCloud>& encoded)
{
  if (segmenter && segmenter->needsPose() == pose_known)
  {
    const CTimeLoggerEntry timed(times, "dyseg");
    segmenter->segmentEncoded(frame, encoded);
  }
}

void FrontEnd::Stages::putBack(const LabelledPoints& labelled, Frame& frame) const
{
  if (given_labels.any())
  {
    if (!segmenter)
    {
      frame.moving_probability.assign(frame.cloud.size(), 0);
    }
    labelled.putBack(frame);
  }
}

FrontEndWaits FrontEnd::waits() const
{
  return {stages_->waited, stages_->ahead_thread.waits().for_items};
}

void FrontEnd::exchangeState(StateArchive& archive)
{
  Stages& s = *stages_;
  if (s.segmenter)
  {
    archive(*s.segmenter);
  }
  archive(s.odometry, s.sweep_ahead, s.own_vehicle);
}

std::string FrontEnd::summary() const
{
  const Stages& s = *stages_;
  return (s.segmenter ? s.segmenter->name() + " + " : "") + s.odometry.name();
}

std::vector<std::string> FrontEnd::warnings() const
{
  std::vector<std::string> result = stages_->odometry.warnings();
  const std::vector<std::string> of_labels = stages_->given_labels.warnings();
  result.insert(result.end(), of_labels.begin(), of_labels.end());
  return result;
}
}  // namespace dyslam
