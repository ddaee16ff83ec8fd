// Makes one triangle over the whole viewport, from gl_VertexID alone.
precise out vec2 v_ndc;
PRECISE_BUILT_IN(gl_Position)

void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  v_ndc = corner;
  gl_Position = vec4(corner, 1.0, 1.0);
}
