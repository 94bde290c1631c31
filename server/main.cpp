// SPDX-License-Identifier: MIT
#include "server/program.hpp"

int main(int argc, char** argv) { return hapticast::server::runMain(argc, argv); }
