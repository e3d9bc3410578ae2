// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/graphslam/GraphFileRun.h>
#include <dyslam/io/GraphFiles.h>

#include "Fixture.h"

namespace dyslam
{
namespace
{
/** Information matrix: 1 for translations, and so much for rotations that they stay nearly fixed.
 */
constexpr const char* information = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1e9 0 0 1e9 0 1e9\n";

/** Four corners of a square whose last side disagrees with the others by 0.4 m. */
std::string squareText()
{
  const std::string i = information;
  std::string text =
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\n"
      "VERTEX_SE3:QUAT 2 1 1 0 0 0 0 1\nVERTEX_SE3:QUAT 3 0 1 0 0 0 0 1\nFIX 0\n";
  text += "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1" + i;
  text += "EDGE_SE3:QUAT 1 2 0 1 0 0 0 0 1" + i;
  text += "EDGE_SE3:QUAT 2 3 -1 0 0 0 0 0 1" + i;
  text += "EDGE_SE3:QUAT 3 0 0 -1.4 0 0 0 0 1" + i;
  return text;
}

class GraphFileRun : public test::WithFolder
{
 protected:
  static std::string write(const std::string& name, const std::string& text)
  {
    std::ofstream(pathOf(name)) << text;
    return pathOf(name);
  }

  static std::string errorOf(const std::string& input, const std::string& output = "")
  {
    try
    {
      (void)optimiseGraphFile(input, output);
      return "";
    }
    catch (const UserError& error)
    {
      return error.what();
    }
  }
};

TEST_F(GraphFileRun, SpreadsTheErrorOfALoopAndWritesBothFormats)
{
  const std::string input = write("square.g2o", squareText());
  for (const char* name : {"out.g2o", "out.graph"})
  {
    const GraphFileReport report = optimiseGraphFile(input, pathOf(name));
    EXPECT_EQ(report.nodes, 4U);
    EXPECT_EQ(report.edges, 4U);
    EXPECT_TRUE(report.result.converged) << report.result.reason;
    EXPECT_NEAR(report.result.start_chi2, 0.16, 1e-9);
    // Each of the four sides takes a quarter of the error, in y.
    EXPECT_NEAR(report.result.final_chi2, 4 * 0.1 * 0.1, 1e-6);
    const auto written = readPoseGraph(pathOf(name));
    EXPECT_NEAR(PoseGraphSolver(PoseGraphSolverOptions()).chi2(written), report.result.final_chi2,
                1e-9);
    EXPECT_NEAR(written.nodes.at(1).y(), 0.1, 1e-6);
    EXPECT_NEAR(written.nodes.at(2).y(), 1.2, 1e-6);
    EXPECT_NEAR(written.nodes.at(3).y(), 1.3, 1e-6);
  }
}

TEST_F(GraphFileRun, TorosPlanarGraphsAreThoseOfG2o)
{
  // A square whose last side is too long; x and y are known equally well.
  const auto square =
      [](const std::string& vertex, const std::string& edge, const std::string& information)
  {
    const std::string turn = " 1.5707963267948966 ";
    return vertex + " 0 0 0 0\n" + edge + " 0 1 1 0" + turn + information + edge + " 1 2 1 0" +
           turn + information + edge + " 2 3 1 0" + turn + information + edge + " 3 0 1.4 0.1" +
           turn + information;
  };
  const auto toro = optimiseGraphFile(
      write("toro.graph", square("VERTEX2", "EDGE2", "40 0 40 900 0 0\n")), pathOf("out.graph"));
  const auto g2o = optimiseGraphFile(
      write("se2.g2o", square("VERTEX_SE2", "EDGE_SE2", "40 0 0 40 0 900\n")), "");
  EXPECT_GT(g2o.result.final_chi2, 0.1);
  EXPECT_NEAR(toro.result.final_chi2, g2o.result.final_chi2, 1e-6);
  EXPECT_TRUE(toro.warnings.empty());
  EXPECT_EQ(optimiseGraphFile(write("bare.g2o", square("VERTEX_SE2", "EDGE_SE2", "\n")), "")
                .warnings.size(),
            1U);
}

TEST_F(GraphFileRun, TakesTheSolversOptions)
{
  const std::string input = write("options.g2o", squareText());
  Config config;
  config.set("pose_graph.max_iterations=1");
  config.set("pose_graph.start=file");
  EXPECT_EQ(optimiseGraphFile(input, "", config).result.iterations, 1);
  config.set("pose_graph.max_iteration=1");
  EXPECT_THROW((void)optimiseGraphFile(input, "", config), UserError);
}

TEST_F(GraphFileRun, BadFilesAreNamed)
{
  EXPECT_EQ(errorOf(pathOf("missing.g2o")), pathOf("missing.g2o") + ": no such file");
  const std::string good = write("good.g2o", squareText());
  EXPECT_EQ(errorOf(good, pathOf("out.txt")),
            pathOf("out.txt") + ": unknown kind of graph file; end it in .graph or .g2o");
  EXPECT_FALSE(errorOf(good, pathOf("no/such/folder/out.g2o")).empty());

  const std::string loose = write("loose.g2o", squareText() + "VERTEX_SE3:QUAT 9 0 0 0 0 0 0 1\n");
  const std::string error = errorOf(loose);
  EXPECT_EQ(error.rfind(loose + ": ", 0), 0U) << error;
  EXPECT_NE(error.find('9'), std::string::npos) << error;

  const std::string nan =
      write("nan.g2o", squareText() + "EDGE_SE3:QUAT 0 2 nan 0 0 0 0 0 1" + information);
  EXPECT_EQ(errorOf(nan).rfind(nan, 0), 0U) << errorOf(nan);
}

TEST_F(GraphFileRun, OptimisesAFactorGraphWithObjects)
{
  const std::string unit = information;
  const std::string input =
      write("factor_graph.txt",
            "DYSLAM_FACTOR_GRAPH 1\nEGO 0 0 0 0 0 0 0 1\nFIX EGO 0\nEGO 1 1 0 0 0 0 0 1\n"
            "STATIC_OBJECT 5 0 4 0 0 0 0 0 1\n"
            "ODOMETRY 0 1 1 0 0 1.3 0 1 0 0 0 0 1 0" +
                unit + "OBSERVATION 0 STATIC_OBJECT 5 0 1 0 0 4 0 1 0 0 0 0 1 0" + unit +
                "OBSERVATION 1 STATIC_OBJECT 5 0 1 0 0 3 0 1 0 0 0 0 1 0" + unit +
                "OBSERVATION 1 STATIC_OBJECT 5 0 1 0 0 nan 0 1 0 0 0 0 1 0" + unit);
  const FactorGraphFileReport report = optimiseFactorGraphFile(input, pathOf("out.txt"));
  EXPECT_EQ(report.variables.at("ego poses"), 2U);
  EXPECT_EQ(report.variables.at("static objects"), 1U);
  EXPECT_EQ(report.factors.at("odometry"), 1U);
  EXPECT_EQ(report.factors.at("observation"), 2U);
  EXPECT_EQ(report.warnings.size(), 1U);
  EXPECT_NEAR(report.result.initial_chi2, 0.09, 1e-9);
  EXPECT_NEAR(report.result.final_chi2, 0.03, 1e-6);  // an error of 0.3 m is shared by three edges
  const FactorGraphFileReport again = optimiseFactorGraphFile(pathOf("out.txt"), "");
  EXPECT_NEAR(again.result.initial_chi2, 0.03, 1e-6);
  EXPECT_TRUE(again.warnings.empty());
}
}  // namespace
}  // namespace dyslam
