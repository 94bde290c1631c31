// SPDX-License-Identifier: MIT
#include "tests/evaluate/gnuplot.hpp"
#include "tests/support/installed.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace hapticast::evaluate {

void gnuplot(const std::filesystem::path& out, const std::string& name, const std::string& script) {
  if (!isInstalled("gnuplot")) {
    std::fprintf(stderr, "no gnuplot: %s.png is left out (apt-get install gnuplot-nox)\n",
                 name.c_str());
    return;
  }
  const std::string file = name + ".gnuplot";
  std::ofstream(out / file) << script;
  const std::string run = "cd '" + out.string() + "' && gnuplot '" + file + "'";
  if (std::system(run.c_str()) != 0) std::fprintf(stderr, "gnuplot failed on %s\n", file.c_str());
  std::filesystem::remove(out / file);
}

}  // namespace hapticast::evaluate
