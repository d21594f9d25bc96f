// Air-light as the difference of two look-ups a Legendre order. Twin: bake_optics::airlight::Lut.
// Where the two cancel, and straight away from the lamp, where the table's last cells span all distances, quadrature takes over.
// uses: airlight_quadrature, moments

// Share of the endless ray's light below which they do.
const LEAST_DIFFERENCE = 0.05;

// Largest v that is looked up: some three degrees off the ray that leads straight away.
const LARGEST_V = 20.0;

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

fn lamp_airlight_table(ray: ViewRay, lamp: Lamp) -> vec3f {
    let offset = ray.origin - lamp.position;
    let sight = sight_of(ray.dir, offset, ray.length, lamp.axis, max(lamp.radius, 1e-4 * length(offset)));
    let sigma_t = air_sigma_t();
    let excess = excess_at(sight, place_at(sight, sight.length));
    let va = sight.behind / sight.h;
    let vb = va + excess / sight.h;
    var sum = vec3f(0.0);
    var cancels = va > LARGEST_V;
    for (var l = 0u; l < ORDERS; l++) {
        var weight = vec3f(0.0);
        for (var m = 0u; m < MEDIA; m++) {
            weight += media[m].sigma_s * (moments[m * ORDERS + l] * f32(2u * l + 1u) * INVERSE_FOUR_PI);
        }
        for (var c = 0u; c < 3u; c++) {
            let h = sigma_t[c] * sight.h;
            let whole = tail(l, h, va);
            let left = whole - fall(sigma_t[c] * excess) * tail(l, h, vb);
            sum[c] += weight[c] * left;
            cancels = cancels || l == 0u && left < LEAST_DIFFERENCE * whole;
        }
    }
    if cancels {
        return airlight_between(ray, lamp, sight, 0.0, ray.length);
    }
    return max(vec3f(0.0), 2.0 / sight.h * sum * air_common(sight));
}
