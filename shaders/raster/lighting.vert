// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: vertex, of the lighting pass (paper, listing 4): one triangle that covers the picture,
// from the vertex numbers 0 ... 2 alone. No inputs, no outputs but the position.

void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
