// What is shown instead of light: the texels of the lightmap, and which placement a surface belongs to.

// Light and dark texels in turn.
fn texel_pattern(uv: vec2f) -> f32 { // if SHOW_TEXELS
    let at = vec2i(floor(uv * vec2f(textureDimensions(lightmap_texels)))); // if SHOW_TEXELS
    return select(0.4, 1.0, ((at.x + at.y) & 1) == 0); // if SHOW_TEXELS
} // if SHOW_TEXELS

// A colour for a number: PCG hash (Jarzynski and Olano 2020).
fn node_color(node: u32) -> vec3f { // if SHOW_NODES
    var state = node * 747796405u + 2891336453u; // if SHOW_NODES
    state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u; // if SHOW_NODES
    state = (state >> 22u) ^ state; // if SHOW_NODES
    return vec3f(vec3u(state, state >> 8u, state >> 16u) & vec3u(255u)) / 255.0; // if SHOW_NODES
} // if SHOW_NODES
