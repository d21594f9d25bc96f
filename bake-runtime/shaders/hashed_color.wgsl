// A colour for a number: PCG hash (Jarzynski and Olano 2020).

fn hashed_color(number: u32) -> vec3f {
    var state = number * 747796405u + 2891336453u;
    state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    state = (state >> 22u) ^ state;
    return vec3f(vec3u(state, state >> 8u, state >> 16u) & vec3u(255u)) / 255.0;
}
