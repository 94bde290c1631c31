// SPDX-License-Identifier: MIT
// The program hapticast-client, which main.cpp starts. Tests run it in a process of theirs, without
// the time that the start of a program takes.
// Thread: main.
#pragma once

namespace hapticast::client {

/// Runs the program with the arguments of main(); returns its exit code.
int runMain(int argc, char** argv);

}  // namespace hapticast::client
