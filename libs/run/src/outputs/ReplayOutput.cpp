// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Options.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/io/ReplayWriter.h>

#include <optional>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* rawlog = "replay.rawlog";

/** Ini section `[replay]`. */
struct ReplayOptions : ReplayWriterOptions
{
  bool hindsight = true;  //!< of final frames

  void describe(OptionsVisitor& v) override
  {
    ReplayWriterOptions::describe(v);
    v.flag(
        "hindsight", hindsight,
        "write moving points and objects as labelled with hindsight; false: as known at each scan");
  }
};

/** `replay.rawlog`, see ReplayWriter. */
class ReplayOutput : public RunOutput
{
 public:
  explicit ReplayOutput(const RunOutputContext& context)
      : RunOutput(context, {rawlog}), options_(context.config.get<ReplayOptions>("replay"))
  {
  }
  [[nodiscard]] OutputThread thread() const override { return OutputThread::writer; }
  [[nodiscard]] WantedFrames wants() const override
  {
    return options_.hindsight ? WantedFrames::final_points : WantedFrames::causal;
  }
  void open() override { writer_.emplace(path(rawlog), options_); }
  void exchangeState(StateArchive& archive) override
  {
    if (archive.isLoading())
    {
      writer_.emplace(path(rawlog), options_, archive);
    }
    else
    {
      writer_->saveState(archive);
    }
  }
  void add(const Frame& frame) override { writer_->write(frame); }
  void finish(const RunResults& /*results*/) override { writer_->close(); }

 private:
  ReplayOptions options_;
  std::optional<ReplayWriter> writer_;
};
}  // namespace

std::unique_ptr<RunOutput> makeReplayOutput(const RunOutputContext& context)
{
  return std::make_unique<ReplayOutput>(context);
}
}  // namespace dyslam
