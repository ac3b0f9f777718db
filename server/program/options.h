// The command line of wobbled.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/admission/open_gate.h"
#include "server/config.h"

namespace wobble::server {

struct Options {
  Config config;
  std::string scene = "arena";
  std::vector<std::string> rotation;  // scenes that follow one another, scene being the first; empty: none
  bool hasAfterMatch = false;         // it was given
  double runFor = 0;                  // s; 0: until a signal
  double statusEvery = 0;             // s; 0: no status lines
  std::string name;                   // that browsers of servers show; empty: the scene's
  bool isHidden = false;              // tells strangers nothing of what is played
  bool isAnnounced = false;           // in the local network
  std::string bind;                   // address to listen at; empty: every one of the machine
  std::string keyFile;                // of the server's key; empty: server.key in the state folder
  admission::GateFiles gate;
  std::string adminSocket;  // path; empty: none
  std::string adminHttp;    // HOST:PORT; empty: none
  std::string rcon;         // HOST:PORT; empty: none
  std::string rconPasswordFile;
  std::string logLevel = "info";
  std::string logFormat = "text";  // or "json"
  std::string summaryFile;
  std::string cacheFolder;
  std::string ops;  // address of the endpoint; empty: none
  std::string traceFile;
  std::string recordFolder;  // empty: nothing is recorded
  int recordMib = 256;       // the most of one file, MiB
  std::string stateFolder;   // empty: the world ends with the process
  std::string replayFile;    // empty: none is played
  bool isVerify = false;     // of replayFile
  std::string exportTarget;  // file or folder; empty: nothing is exported
  bool isForced = false;     // what is at exportTarget is replaced
  std::string exportFormat = "csv";
  double exportFrom = 0;                                      // s since the recording began
  double exportTo = std::numeric_limits<double>::infinity();  // s; infinite: its end
  double exportFps = 30;                                      // frames a second
  std::vector<std::uint32_t> exportBodies;                    // empty: all
  bool isUntrained = false;
  bool isCheck = false;
  bool listScenes = false;
  std::string listFolder;           // whose recordings are listed; empty: none
  std::vector<std::string> errors;  // one line for each number that is malformed or out of range
  // Puts names of variables in place of the options that they set, in a line for people.
  std::function<std::string(std::string)> nameVariables = [](std::string line) { return line; };
};

// Declares the options; parsing then writes into `options`, which outlives `app`.
void DescribeOptions(CLI::App& app, Options& options);

// Prints each mistake on standard error; who set an option by a variable reads of the variable.
void Complain(const Options& options, const std::vector<std::string>& mistakes);

}  // namespace wobble::server
