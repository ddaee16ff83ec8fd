#pragma once
// A light probe on the wire: a page of its own, reflections as differences of neighbours.

#include "protocol/base/result.h"
#include "protocol/impostor/light_probe.h"
#include "protocol/wire/message.h"

namespace mirage {

/// The page a client is sent, as a whole message.
Bytes encode_probe(const LightProbe& probe);
/// Error kWireMalformed, kWireValue: the payload is no map, or not the one of this id.
Result<LightProbe> decode_probe(const wire::LightProbePageT& page, const Bytes& payload);

}  // namespace mirage
