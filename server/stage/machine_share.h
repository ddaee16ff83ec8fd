#pragma once
// How much of the machine the stages take.

namespace mirage {

/// Returns the processor cores that this process may use. In a container they may be fewer than the
/// machine has.
int usable_cores();

/// Returns the number of encoders for a machine. A software renderer uses all cores itself, and one
/// encoder keeps up with it. With a graphics card the encoders set the pace: they take all cores
/// but two, one for the network loop and one for the graphics thread. More than 14 are not measured
/// (docs/decisions/057).
int encoders_for(int cores, bool software_renderer);

}  // namespace mirage
