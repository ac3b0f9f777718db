// What the command line of wobbled says.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "server/config.h"

namespace wobble::server {

struct Options {
  Config config;
  std::string scene = "arena";
  double runFor = 0;  // s; 0: until a signal
  double statusEvery = 0;
  std::string logLevel = "info";
  std::string summaryFile;
  std::string cacheFolder;
  std::string ops;  // address; empty: none
  std::string traceFile;
  bool isUntrained = false;
  bool listScenes = false;
  std::vector<std::string> errors;  // a line for every number that cannot be used
};

// Adds the options to a command line, which writes what it reads into them.
void DescribeOptions(CLI::App& app, Options& options);

}  // namespace wobble::server
