// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/io/GraphFiles.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv)
{
  using namespace dyslam;
  PoseGraphSolverOptions o;
  for (int i = 1; i < argc; ++i)
  {
    const PoseGraph graph = readPoseGraph(argv[i]);
    for (auto start : {GraphStart::file, GraphStart::spanning_tree, GraphStart::chordal})
      for (auto ls : {GraphLinearSolver::suite_sparse, GraphLinearSolver::eigen_sparse})
      {
        o.start = start;
        o.linear_solver = ls;
        PoseGraph g = graph;
        auto t0 = std::chrono::steady_clock::now();
        auto r = PoseGraphSolver(o).solve(g);
        std::chrono::duration<double> dt = std::chrono::steady_clock::now() - t0;
        std::printf("%s %d %d: %zu nodes %zu edges %g %g -> %.8g, %d it, %.3f s, %s\n", argv[i],
                    int(start), int(ls), g.nodes.size(), g.edges.size(), r.start_chi2,
                    r.initial_chi2, r.final_chi2, r.iterations, dt.count(), r.reason.c_str());
      }
  }
}
