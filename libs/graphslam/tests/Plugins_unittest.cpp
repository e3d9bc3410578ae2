// SPDX-License-Identifier: BSD-3-Clause
// The plug-ins in MRPT's own engine, as a program of somebody else would use them.
#include <dyslam/backend/Backend.h>
#include <dyslam/base/Error.h>
#include <dyslam/graphslam/FactorGraphOptimizer.h>
#include <dyslam/graphslam/GraphSlamEngine.h>
#include <dyslam/graphslam/LoopEdgeDecider.h>
#include <dyslam/graphslam/OdometryNodeDecider.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogStream.h>
#include <dyslam/pipeline/Pipeline.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <stdexcept>

#include "Fixture.h"

namespace dyslam
{
namespace
{
using Graph = mrpt::graphs::CNetworkOfPoses3DInf;

/** The objects that plug-ins need. */
struct Plugins
{
  explicit Plugins(const Config& settings)
      : times(false),
        config(settings),
        input(config.get<RawlogSourceOptions>("input")),
        pipeline(config, times),
        stream(test::bundled("rawlog/campus16.rawlog")),
        context(std::make_shared<GraphSlamContext>(
            pipeline,
            ScanDecoder(input, stream.path(), stream.externalFolder()),
            static_cast<std::size_t>(input.only_first_n),
            [this](Frame frame) { frames.push_back(std::move(frame)); })),
        nodes(context),
        edges(context),
        optimizer(context)
  {
  }

  mrpt::system::CTimeLogger times;
  ConfigLoader config;
  RawlogSourceOptions input;
  Pipeline pipeline;
  RawlogStream stream;
  std::vector<Frame> frames;
  std::shared_ptr<GraphSlamContext> context;
  OdometryNodeDecider nodes;
  LoopEdgeDecider edges;
  FactorGraphOptimizer optimizer;
};

void expectSame(const Graph& graph, const Graph& expected)
{
  ASSERT_EQ(graph.nodeCount(), expected.nodeCount());
  ASSERT_EQ(graph.edgeCount(), expected.edgeCount());
  EXPECT_EQ(graph.root, expected.root);
  for (const auto& [id, pose] : expected.nodes)
  {
    EXPECT_EQ(graph.nodes.at(id).asVectorVal(), pose.asVectorVal()) << id;
  }
}

/** The next observations of a recording, up to and including a scan of the lidar. */
mrpt::obs::CSensoryFrame::Ptr nextSensoryFrame(RawlogStream& stream)
{
  static const std::string lidar = RawlogSource(stream.path()).sensorLabel();
  auto frame = mrpt::obs::CSensoryFrame::Create();
  while (auto observation = stream.next())
  {
    frame->insert(observation);
    if (observation->sensorLabel == lidar)
    {
      break;
    }
  }
  return frame;
}

class GraphSlamPlugins : public test::WithFolder
{
};

TEST_F(GraphSlamPlugins, RunInMrptsEngine)
{
  Plugins p(test::loopyConfig(40));
  const std::string ini = pathOf("engine.ini");
  std::ofstream(ini) << "[GeneralConfiguration]\nclass_verbosity = 3\n";
  GraphSlamEngine engine(ini, "", p.nodes, p.edges, p.optimizer);
  std::size_t entry = 0;
  std::size_t nodes = 0;
  std::size_t loops = 0;
  bool moved = false;
  while (auto observation = p.context->done() ? nullptr : p.stream.next())
  {
    ASSERT_TRUE(engine.execGraphSlamStep(observation, entry));
    ++entry;
    const std::size_t now = engine.getGraph().nodeCount();
    EXPECT_TRUE(now == nodes || now == nodes + 1 || (nodes == 0 && now == 2)) << now;
    nodes = now;
    loops += p.edges.justInsertedLoopClosure() ? 1 : 0;
    moved = moved || p.optimizer.justFullyOptimizedGraph();
    if (const Frame* frame = p.context->frame())
    {
      const mrpt::poses::CPose3D pose = engine.getCurrentRobotPosEstimation();
      EXPECT_NEAR(pose.x(), frame->T_map_vehicle().translation().x(), 1e-12);
      EXPECT_NEAR(pose.y(), frame->T_map_vehicle().translation().y(), 1e-12);
    }
  }
  EXPECT_GT(nodes, 5U);
  EXPECT_GT(loops, 0U);
  EXPECT_TRUE(moved);
  p.optimizer.finish();
  EXPECT_EQ(p.frames.size(), 40U);
  expectSame(engine.getGraph(), p.pipeline.backend().graph());
  std::map<std::string, int> stats;
  p.edges.getEdgesStats(&stats);
  EXPECT_EQ(static_cast<std::size_t>(stats.at("LC")),
            engine.getGraph().edgeCount() - (engine.getGraph().nodeCount() - 1));
  std::string report;
  p.edges.getDescriptiveReport(&report);
  for (const LoopVerdict verdict : loop_verdicts)
  {
    EXPECT_NE(report.find("\n" + toString(verdict) + ": "), std::string::npos) << report;
  }
}

/** The engine resets the nodes at a registration; the next scan's step shows the solution again. */
TEST_F(GraphSlamPlugins, NodesAreTheBackendsAfterEveryStepWithoutRegistration)
{
  Plugins p(test::loopyConfig(40));
  const std::string ini = pathOf("engine.ini");
  std::ofstream(ini) << "[GeneralConfiguration]\nclass_verbosity = 3\n";
  GraphSlamEngine engine(ini, "", p.nodes, p.edges, p.optimizer);
  std::size_t entry = 0;
  std::size_t compared = 0;
  while (auto observation = p.context->done() ? nullptr : p.stream.next())
  {
    engine.execGraphSlamStep(observation, entry);
    const Frame* frame = p.context->frame();
    if (frame != nullptr && !frame->is_keyframe && engine.getGraph().nodeCount() > 0)
    {
      expectSame(engine.getGraph(), p.pipeline.backend().graph());
      ++compared;
    }
  }
  EXPECT_GT(compared, 5U);
}

TEST_F(GraphSlamPlugins, TheNodeDeciderTakesSensoryFrames)
{
  Plugins single(test::loopyConfig(12));
  Plugins framed(test::loopyConfig(12));
  Graph graph;
  Graph expected;
  single.nodes.setGraphPtr(&expected);
  framed.nodes.setGraphPtr(&graph);
  std::vector<bool> registered;
  while (auto observation = single.context->done() ? nullptr : single.stream.next())
  {
    const bool added = single.nodes.updateState(nullptr, nullptr, observation);
    if (single.context->frame() != nullptr)
    {
      registered.push_back(added);
    }
  }
  std::vector<bool> in_frames;
  while (in_frames.size() < registered.size())
  {
    in_frames.push_back(
        framed.nodes.updateState(nullptr, nextSensoryFrame(framed.stream), nullptr));
    ASSERT_NE(framed.context->frame(), nullptr);
  }
  EXPECT_EQ(in_frames, registered);
  EXPECT_EQ(in_frames.size(), 12U);
  EXPECT_EQ(std::count(in_frames.begin(), in_frames.end(), true), 2);
  expectSame(graph, expected);
}

TEST_F(GraphSlamPlugins, TwoScansInOneSensoryFrameAreAnError)
{
  Plugins p(test::loopyConfig(0));
  Graph graph;
  p.nodes.setGraphPtr(&graph);
  const auto frame = nextSensoryFrame(p.stream);
  const auto next = nextSensoryFrame(p.stream);
  for (const auto& observation : *next)
  {
    frame->insert(observation);
  }
  EXPECT_THROW(p.nodes.updateState(nullptr, frame, nullptr), UserError);
}

TEST_F(GraphSlamPlugins, AFrameThatFailsIsNotHandedOn)
{
  Plugins p(test::loopyConfig(0));
  Graph graph;
  p.nodes.setGraphPtr(&graph);
  p.optimizer.setGraphPtr(&graph);
  p.nodes.updateState(nullptr, nextSensoryFrame(p.stream), nullptr);
  p.nodes.updateState(nullptr, nextSensoryFrame(p.stream), nullptr);
  ASSERT_EQ(p.frames.size(), 1U);
  Frame later = p.frames.front();
  later.scan.stamp += 1000;
  later.detections.clear();
  p.pipeline.trackObjects(later);  // so that the tracker refuses the next frame
  EXPECT_THROW(p.nodes.updateState(nullptr, nextSensoryFrame(p.stream), nullptr),
               std::invalid_argument);
  EXPECT_EQ(p.context->frame(), nullptr);
  p.optimizer.finish();
  EXPECT_EQ(p.frames.size(), 2U);
}

TEST_F(GraphSlamPlugins, NothingComesAfterTheEnd)
{
  Plugins p(test::loopyConfig(0));
  Graph graph;
  p.nodes.setGraphPtr(&graph);
  p.optimizer.setGraphPtr(&graph);
  p.optimizer.finish();
  EXPECT_EQ(graph.nodeCount(), 0U);
  EXPECT_THROW(p.nodes.updateState(nullptr, nullptr, p.stream.next()), std::logic_error);
}
}  // namespace
}  // namespace dyslam
