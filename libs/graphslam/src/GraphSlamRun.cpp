// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/graphslam/FactorGraphOptimizer.h>
#include <dyslam/graphslam/GraphSlamEngine.h>
#include <dyslam/graphslam/GraphSlamRun.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogStream.h>
#include <dyslam/pipeline/Pipeline.h>

#include <filesystem>
#include <utility>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Writes the engine's own settings. \return path of the ini file \throws UserError. */
std::string writeEngineIni(const fs::path& folder)
{
  const std::string path = (folder / "engine.ini").string();
  writeWhole(path,
             "[GeneralConfiguration]\n"
             "class_verbosity = 1\n"
             "user_decides_about_output_dir = false\n"
             "[VisualizationParameters]\n"
             "visualize_map = false\n"
             "visualize_odometry_poses = false\n"
             "visualize_estimated_trajectory = false\n"
             "visualize_SLAM_metric = false\n"
             "visualize_ground_truth = false\n"
             "enable_curr_pos_viewport = false\n");
  return path;
}

constexpr const char* node_kind = "node registration decider";
constexpr const char* edge_kind = "edge registration decider";
constexpr const char* optimizer_kind = "optimizer";

void requireKnown(const GraphSlamPluginNames& names)
{
  (void)findPlugin(nodeDeciders(), node_kind, names.node_decider);
  (void)findPlugin(edgeDeciders(), edge_kind, names.edge_decider);
  (void)findPlugin(graphOptimizers(), optimizer_kind, names.optimizer,
                   " (the folder for results is --output)");
}

/** The engine and its plug-ins. */
class Engine
{
 public:
  Engine(const GraphSlamPluginNames& names,
         std::shared_ptr<GraphSlamContext> context,
         const SlamRunSettings& settings)
      : context_(std::move(context)),
        folder_(settings.output_folder),
        nodes_(findPlugin(nodeDeciders(), node_kind, names.node_decider).make(context_)),
        edges_(findPlugin(edgeDeciders(), edge_kind, names.edge_decider).make(context_)),
        optimizer_(findPlugin(graphOptimizers(), optimizer_kind, names.optimizer).make(context_)),
        engine_(writeEngineIni(folder_), settings.rawlog, *nodes_, *edges_, *optimizer_)
  {
  }

  /** Gives an observation to the engine. \throws UserError of a plug-in, unwrapped from MRPT's
   * exception. */
  void step(mrpt::obs::CObservation::Ptr observation, std::size_t entry)
  {
    if (observation->timestamp == INVALID_TIMESTAMP)
    {
      context_->takeObservation(observation);  // the engine would throw; the context warns
      return;
    }
    try
    {
      engine_.execGraphSlamStep(observation, entry);
    }
    catch (const mrpt::ExceptionWithCallBackBase& error)
    {
      throw UserError(error.originalWhat);
    }
  }

  void finish()
  {
    auto* ours = dynamic_cast<FactorGraphOptimizer*>(optimizer_.get());
    ours != nullptr ? ours->finish() : context_->finish();
  }

  /** Writes the files that graphslam-engine writes. \return their names */
  [[nodiscard]] std::vector<std::string> writeReports()
  {
    engine_.generateReportFiles(folder_);
    writeGraph(engine_.getGraph(), (fs::path(folder_) / "output_graph.graph").string());
    return {"engine.ini",         "output_graph.graph", "CGraphSlamEngine.log", "timings.log",
            "node_registrar.log", "edge_registrar.log", "optimizer.log"};
  }

 private:
  std::shared_ptr<GraphSlamContext> context_;
  std::string folder_;
  std::unique_ptr<NodeDecider> nodes_;
  std::unique_ptr<EdgeDecider> edges_;
  std::unique_ptr<GraphOptimizer> optimizer_;
  GraphSlamEngine engine_;
};

/** Gives every observation to the engine. \return whether the run was stopped */
bool replay(const SlamRunSettings& settings,
            const SlamRun& run,
            GraphSlamContext& context,
            RawlogStream& stream,
            Engine& engine,
            const FrameCallback& on_frame)
{
  std::size_t entry = 0;
  std::size_t frames = 0;
  while (auto observation = context.done() ? nullptr : stream.next())
  {
    engine.step(observation, entry++);
    if (run.frames() == frames)
    {
      continue;
    }
    frames = run.frames();
    if (on_frame)
    {
      on_frame(context.decoder().progress(stream.progress(), frames), frames);
    }
    if (settings.stop && settings.stop())
    {
      return true;
    }
  }
  return false;
}
}  // namespace

SlamRunReport runGraphSlam(const SlamRunSettings& settings,
                           const GraphSlamPluginNames& plugins,
                           const FrameCallback& on_frame)
{
  requireKnown(plugins);
  SlamRun run(settings);
  (void)RawlogSource(settings.rawlog, run.input());  // throws if there is no scan to use
  requireNotStopped(settings);
  run.open();
  RawlogStream stream(settings.rawlog);
  const auto context = std::make_shared<GraphSlamContext>(
      run.pipeline(), ScanDecoder(run.input(), settings.rawlog, stream.externalFolder()),
      static_cast<std::size_t>(run.input().only_first_n),
      [&run](Frame frame) { run.add(std::move(frame)); });
  Engine engine(plugins, context, settings);
  std::vector<std::string> files;
  const EarlyEnd end = replayToTheEnd(
      run, [&] { return replay(settings, run, *context, stream, engine, on_frame); },
      [&]
      {
        engine.finish();
        if (run.frames() > 0)
        {
          files = engine.writeReports();
        }
      });
  if (run.frames() == 0)
  {
    throw UserError(end.damage.empty() ? settings.rawlog + ": no scan could be processed"
                                       : end.damage);
  }
  std::vector<std::string> warnings = context->decoder().warnings();
  const std::vector<std::string> of_file = stream.warnings();
  warnings.insert(warnings.end(), of_file.begin(), of_file.end());
  SlamRunReport report = run.finish(warnings, end);
  report.files.insert(report.files.end(), files.begin(), files.end());
  return report;
}
}  // namespace dyslam
