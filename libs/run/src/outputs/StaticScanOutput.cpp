// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>

#include <optional>

#include "RunOutput.h"
#include "ScanLabels.h"

namespace dyslam
{
namespace
{
constexpr const char* scan_folder = "static_scans";
constexpr const char* scan_extension = ".bin";
constexpr const char* rawlog = "static_scans.rawlog";

/** The scan without the points labelled as moving; with several lidars without ring numbers, which
 * would not be those of one lidar. */
Scan staticPartOf(const Frame& frame)
{
  const std::vector<Label> labels = scanLabels(frame);
  Scan kept = frame.scan;
  if (!kept.parts.empty())
  {
    kept.parts.clear();
    kept.ring.clear();
  }
  std::size_t count = 0;
  const auto keep = [&](auto& values, std::size_t from)
  {
    if (!values.empty())
    {
      values[count] = values[from];
    }
  };
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    if (!isMovingLabel(labels[i]))
    {
      keep(kept.points, i);
      keep(kept.intensity, i);
      keep(kept.time, i);
      keep(kept.ring, i);
      ++count;
    }
  }
  kept.points.resize(count);
  kept.intensity.resize(kept.intensity.empty() ? 0 : count);
  kept.time.resize(kept.time.empty() ? 0 : count);
  kept.ring.resize(kept.ring.empty() ? 0 : count);
  return kept;
}

/** Scans without moving points: `static_scans/NNNNNN.bin` and `static_scans.rawlog`, in the vehicle
 * frame of the recording. */
class StaticScanOutput : public RunOutput
{
 public:
  explicit StaticScanOutput(const RunOutputContext& context)
      : RunOutput(context, {{scan_folder, scan_extension}, rawlog}),
        levelling_(context.config.get<RawlogSourceOptions>("input").levelling())
  {
  }
  [[nodiscard]] OutputThread thread() const override { return OutputThread::writer; }
  [[nodiscard]] WantedFrames wants() const override { return WantedFrames::final_scans; }
  void open() override
  {
    makeFolder(path(scan_folder));
    writer_.emplace(path(rawlog));
  }
  void exchangeState(StateArchive& archive) override
  {
    if (archive.isLoading())
    {
      makeFolder(path(scan_folder));
      writer_.emplace(path(rawlog), RawlogWriterOptions(), archive);
    }
    else
    {
      writer_->saveState(archive);
    }
  }
  void add(const Frame& frame) override
  {
    Scan kept = staticPartOf(frame);
    levelling_.undo(kept);
    writeBin(numberedPath(path(scan_folder), frame.index, scan_extension), kept.points,
             kept.intensity);
    const auto& truth = frame.T_world_vehicle_truth;
    writer_->write(kept, truth ? std::optional<Pose>(levelling_.recorded(*truth)) : std::nullopt);
  }
  void finish(const RunResults& /*results*/) override { writer_->close(); }

 private:
  Levelling levelling_;
  std::optional<RawlogWriter> writer_;
};
}  // namespace

std::unique_ptr<RunOutput> makeStaticScanOutput(const RunOutputContext& context)
{
  return std::make_unique<StaticScanOutput>(context);
}
}  // namespace dyslam
