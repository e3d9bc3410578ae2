// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/TrainDylo.h>
#include <dyslam/train/TrainDyseg.h>

#include <iostream>

#include "../common/AppMain.h"
#include "TrainArguments.h"

namespace
{
using namespace dyslam;

/** Completes the arguments of the command that was given. \throws UserError. */
void prepare(TrainArguments& arguments)
{
  arguments.requireConsistent();
  arguments.start = startWeights(arguments.start);
  arguments.stopped = stopRequested;
  arguments.report = [](const std::string& line) { std::cout << line << std::endl; };
}
}  // namespace

int main(int argc, char** argv)
{
  tuneHeap(8);  // threads allocate often: with one arena they wait for each other
  TrainArguments dylo;
  TrainArguments dyseg;
  CLI::App* dylo_parser = nullptr;
  return runApp(
      argc, argv,
      [&](CLI::App& app)
      {
        app.description("Trains the networks");
        app.require_subcommand(1);
        dylo_parser = &declareDylo(app, dylo);
        declareDyseg(app, dyseg);
      },
      [&]
      {
        if (dylo_parser->parsed())
        {
          prepare(dylo);
          trainDylo(dylo.loadConfig("dylo"), dylo);
        }
        else
        {
          prepare(dyseg);
          trainDyseg(dyseg.loadConfig("dyseg"), dyseg);
        }
      });
}
