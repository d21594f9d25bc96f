// Air-light as the difference of two look-ups a Legendre order. Twin: bake_optics::airlight::Lut.
// uses: sight, air_uniform, moments

// Layer l: tails f_l over (sqrt(H)/(1 + sqrt(H)), 2 atan(v)/pi), divided by their scale.
@group(0) @binding(12) var tail_texels: texture_2d_array<f32>;

// Twin: scale_of.
fn tail_scale(h: f32, v: f32) -> f32 {
    let angle = angle_of(1.0, v);
    return 1.0 / (h * (1.0 + v * v) + 1.0 / max(angle, 1e-30));
}

// Twin: Lut::tail.
fn tail(l: u32, h: f32, v: f32) -> f32 {
    let last = f32(textureDimensions(tail_texels).x - 1u);
    let root = sqrt(h);
    let place = clamp(vec2f(root / (1.0 + root), angle_of(v, 1.0) / (0.5 * PI)) * last, vec2f(0.0), vec2f(last));
    let low = min(floor(place), vec2f(last - 1.0));
    let share = place - low;
    let at = vec2i(low);
    let top = mix(textureLoad(tail_texels, at, l, 0).r, textureLoad(tail_texels, at + vec2i(1, 0), l, 0).r, share.x);
    let bottom = mix(textureLoad(tail_texels, at + vec2i(0, 1), l, 0).r, textureLoad(tail_texels, at + vec2i(1, 1), l, 0).r, share.x);
    return mix(top, bottom, share.y) * tail_scale(h, v);
}

fn lamp_airlight(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = sight_of(ray.dir, ray.origin - lamp.position, ray.length, lamp.axis, max(lamp.radius, 1e-4 * length(ray.origin - lamp.position)));
    let sigma_t = air_sigma_t();
    let excess = excess_at(sight, sight.length);
    let va = sight.behind / sight.h;
    let vb = va + excess / sight.h;
    var sum = vec3f(0.0);
    for (var l = 0u; l < ORDERS; l++) {
        var weight = vec3f(0.0);
        for (var m = 0u; m < MEDIA; m++) {
            weight += media[m].sigma_s * (moments[m * ORDERS + l] * f32(2u * l + 1u) * INVERSE_FOUR_PI);
        }
        for (var c = 0u; c < 3u; c++) {
            let h = sigma_t[c] * sight.h;
            sum[c] += weight[c] * (tail(l, h, va) - fall(sigma_t[c] * excess) * tail(l, h, vb));
        }
    }
    return max(vec3f(0.0), 2.0 / sight.h * sum * air_common(sight));
}
