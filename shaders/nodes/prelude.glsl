// SPDX-License-Identifier: GPL-3.0-or-later
// The words of the node files' common subset in GLSL; core/shading/glsl.h and
// core/shading/node_textures.h have them in C++.
#define NODE_FUNCTION
#define NODE_INLINE
#define OUT(type) out type
#define INOUT(type) inout type
#define NODE_HOST_PARAMETER
#define NODE_HOST
