// SPDX-License-Identifier: MIT
// Limits of a hand: what a stream may do to it. The constants of the energy tank and of trust
// follow from them. The devices that hapticast drives are weaker than the machines of these
// standards; the limits are a yardstick, not a claim of conformity. Thread: any.
#pragma once

namespace hapticast::client {

/// Largest speed that a stream may give to a hand: the reduced speed of ISO 10218-1.
inline constexpr double kHandSpeed_m_s = 0.25;
/// Effective mass of hand and fingers: ISO/TS 15066, table A.3.
inline constexpr double kHandMass_kg = 0.6;
/// Largest energy of one event: that mass at that speed, 18.75 mJ. Its impulse is 0.15 N·s.
inline constexpr double kHandEvent_mJ = 0.5e3 * kHandMass_kg * kHandSpeed_m_s * kHandSpeed_m_s;
/// Largest energy of a burst beyond the lasting power: about three events. Chosen.
inline constexpr double kHandBurst_mJ = 60.0;
/// Lasting mean power of a stream. Chosen: tank, burst and 10 s of it are below 300 mJ, and a ball
/// that bounces on the hand at 1 m/s does 240 mJ in 10 s.
inline constexpr double kHandPower_W = 0.02;
/// Largest vibration: the daily exposure limit value of the directive 2002/44/EC, weighted as in
/// ISO 5349-1.
inline constexpr double kHandVibration_m_s2 = 5.0;

}  // namespace hapticast::client
