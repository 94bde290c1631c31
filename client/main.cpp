// SPDX-License-Identifier: MIT
#include "client/program.hpp"

int main(int argc, char** argv) { return hapticast::client::runMain(argc, argv); }
