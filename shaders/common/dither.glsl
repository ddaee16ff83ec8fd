// Ordered dither, 4 x 4 (Bayer): a share `fade` of the pixels is kept, the same ones every frame.
// Kept pixels are drawn in full, so opaque things keep their alpha of 1 while they fade.
bool dithered_away(ivec2 at, float fade) {
  ivec2 p = at & 3;
  int coarse = (((p.x ^ p.y) & 1) << 1) | (p.y & 1);
  int fine = ((((p.x >> 1) ^ (p.y >> 1)) & 1) << 1) | ((p.y >> 1) & 1);
  float threshold = (float(coarse * 4 + fine) + 0.5) / 16.0;
  return threshold > fade;
}
bool dithered_away(float fade) { return dithered_away(ivec2(gl_FragCoord.xy), fade); }
