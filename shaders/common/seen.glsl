// Least alpha at which a blended surface counts as visible. Neither the depths in tiles nor the
// full render they are compared with consider fainter surfaces.
const float kSeenAlpha = 1.0 / 16.0;
