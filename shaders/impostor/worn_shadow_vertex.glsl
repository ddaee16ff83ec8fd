// The vertex half of worn_shadow.glsl.
layout(location = 13) in vec4 i_shadow_rotation;
layout(location = 14) in vec4 i_shadow_view;
layout(location = 15) in vec4 i_shadow_place;
precise flat out vec4 v_shadow_rotation;
precise flat out vec4 v_shadow_view;
precise flat out vec4 v_shadow_place;

void wear_shadow() {
  v_shadow_rotation = i_shadow_rotation;
  v_shadow_view = i_shadow_view;
  v_shadow_place = i_shadow_place;
}
