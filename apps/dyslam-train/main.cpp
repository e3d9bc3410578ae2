// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>
#include <dyslam/base/Version.h>

#include "../common/AppMain.h"
#include "TrainArguments.h"

int main(int argc, char** argv)
{
  dyslam::tuneHeap(8);  // threads allocate often: with one arena they wait for each other
  dyslam::TrainArguments dylo;
  dyslam::TrainArguments dyseg;
  CLI::App* dylo_parser = nullptr;
  return dyslam::runApp(
      argc, argv,
      [&](CLI::App& app)
      {
        app.description("Trains the networks");
        app.require_subcommand(1);
        dylo_parser = &declareDylo(app, dylo);
        declareDyseg(app, dyseg);
      },
      [&] { dylo_parser->parsed() ? trainDyloCommand(dylo) : trainDysegCommand(dyseg); });
}
