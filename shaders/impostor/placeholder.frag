precision highp float;
flat in vec4 v_color;  // premultiplied
in vec3 v_relative;
precise layout(location = 0) out vec4 o_color;
#ifdef TINT
uniform vec4 u_tint;  // shown instead
#endif
#ifdef FOG
#include "common/fog.glsl"
#endif
void main() {
  o_color = v_color;
#ifdef FOG
  o_color = fogged(o_color, v_relative);
#endif
#ifdef TINT
  o_color = u_tint;
#endif
}
