// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Parallel.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/dyseg/TemporalFilter.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <mrpt/system/CTimeLogger.h>

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

struct FrontEnd::Stages
{
  Stages(int threads, ConfigLoader& config, mrpt::system::CTimeLogger& time_logger)
      : times(time_logger),
        segmentation(config.get<MovingSegmenterOptions>("dyseg")),
        pool(threads),
        preprocessor(config.get<PreprocessOptions>("preprocess"), pool),
        segmenter(makeSegmenter(segmentation.method, config, pool)),
        filter(config.get<TemporalFilterOptions>("dyseg_filter")),
        odometry(config, pool, times)
  {
  }

  void preprocess(Frame& frame);
  /** Segments now if the segmenter runs before (false) or after (true) the pose is known. */
  void segment(Frame& frame, bool pose_known);
  void filterOverTime(Frame& frame);

  mrpt::system::CTimeLogger& times;
  MovingSegmenterOptions segmentation;
  ThreadPool pool;
  Preprocessor preprocessor;
  std::unique_ptr<MovingSegmenter> segmenter;  //!< null: nothing is segmented
  TemporalFilter filter;
  Odometry odometry;
};

FrontEnd::FrontEnd(int threads, ConfigLoader& config, mrpt::system::CTimeLogger& times)
    : stages_(std::make_unique<Stages>(threads, config, times))
{
}

FrontEnd::~FrontEnd() = default;

void FrontEnd::process(Frame& frame)
{
  Stages& s = *stages_;
  s.odometry.predict(frame);
  s.preprocess(frame);
  s.segment(frame, false);
  s.odometry.estimate(frame);
  s.segment(frame, true);
  s.filterOverTime(frame);
  decideMoving(frame, s.segmentation.moving_threshold);
  s.odometry.integrate(frame);
}

void FrontEnd::Stages::preprocess(Frame& frame)
{
  const CTimeLoggerEntry timed(times, "preprocess");
  const auto prepare = [&](const Pose& T_previous_current, double dt)
  { return preprocessor.prepare(frame.scan, T_previous_current, dt, frame.sweep_duration); };
  frame.cloud = prepare(frame.prior.T_previous_current, frame.dt);
  odometry.settleTime(frame, prepare);
}

void FrontEnd::Stages::segment(Frame& frame, bool pose_known)
{
  if (segmenter && segmenter->needsPose() == pose_known)
  {
    const CTimeLoggerEntry timed(times, "dyseg");
    segmenter->segment(frame);
  }
}

void FrontEnd::Stages::filterOverTime(Frame& frame)
{
  if (segmentation.filter)
  {
    const CTimeLoggerEntry timed(times, "dyseg");
    filter.apply(frame);
  }
}

void FrontEnd::exchangeState(StateArchive& archive)
{
  Stages& s = *stages_;
  if (s.segmenter)
  {
    archive(*s.segmenter);
  }
  archive(s.filter, s.odometry);
}

std::string FrontEnd::summary() const
{
  const Stages& s = *stages_;
  std::string text = s.segmenter ? s.segmenter->name() + " + " : "";
  text += s.segmenter && s.segmentation.filter ? "filter + " : "";
  return text + s.odometry.name();
}

std::vector<std::string> FrontEnd::warnings() const
{
  return stages_->odometry.warnings();
}
}  // namespace dyslam
