// SPDX-License-Identifier: MIT
// Reports of the loop as rows of text, for --log and for the flight recorder's dump. Thread: any
// but the loop's.
#pragma once

#include <iosfwd>

#include "client/haptics/flight_recorder.hpp"

namespace hapticast::client {

const char* lookupName(Lookup lookup) noexcept;
const char* faultName(Fault fault) noexcept;

/// The columns: t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,...,dz_N,penetration_mm,lookup
void writeReportHeading(std::ostream& out);
void writeReport(std::ostream& out, const TickReport& report);

/// Writes a frozen recorder's ticks, oldest first, and lets it record again. Requires frozen().
void dumpRecorder(std::ostream& out, FlightRecorder& recorder);

}  // namespace hapticast::client
