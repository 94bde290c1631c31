#include "tests/evaluate/stability_parts.hpp"
namespace hapticast::evaluate {
void stabilityCases(const StabilityReport&) {}
}  // namespace hapticast::evaluate
