// Light shafts of a sun: the ray is split into lit intervals by its shadow map, and each is integrated as if it were alone.
// uses: airlight_sun, shadow_border

// The part of a ray that a sun's map covers; beyond it all is lit.
fn mapped_span(ray: ViewRay, sun: Sun) -> vec2f {
    let view = shadow_views[sun.shadow].clip_from_relative;
    let at = (view * vec4f(ray.origin, 1.0)).xy;
    let speed = (view * vec4f(ray.dir, 0.0)).xy;
    var span = vec2f(0.0, ray.length);
    for (var i = 0u; i < 2u; i++) {
        if abs(speed[i]) < 1e-12 {
            if abs(at[i]) >= 1.0 { return vec2f(0.0); }
            continue;
        }
        let a = clamp((-1.0 - at[i]) / speed[i], -1e30, 1e30);
        let b = clamp((1.0 - at[i]) / speed[i], -1e30, 1e30);
        span = vec2f(max(span.x, min(a, b)), min(span.y, max(a, b)));
    }
    return span;
}

// The integral is called at one place, as in shafts.
fn sun_airlight_shadowed(ray: ViewRay, sun: Sun) -> vec3f {
    var span = vec2f(0.0);
    if sun.shadow != UNSHADOWED { span = mapped_span(ray, sun); }
    let maps = maps_of_sun(sun);
    let step = (span.y - span.x) / f32(SHAFT_STEPS);
    var sum = vec3f(0.0);
    var begin = 0.0;
    var lit = true;
    var s = span.x;
    // Behind the steps one turn leaves the map for the light behind it, one closes the ray; without a map there is no other.
    for (var i = select(SHAFT_STEPS + 2u, 0u, span.x < span.y); i <= SHAFT_STEPS + 2u; i++) {
        let next = min(span.x + step * f32(i), span.y);
        var next_lit = i == SHAFT_STEPS + 1u;
        if i <= SHAFT_STEPS { next_lit = is_lit(maps, ray.origin + ray.dir * next); }
        if next_lit != lit {
            var border = select(next, ray.length, i > SHAFT_STEPS + 1u);
            if i > 0u && i <= SHAFT_STEPS { border = shadow_border(ray, maps, s, next, lit); }
            if lit { sum += sun_between(ray, sun, begin, border); }
            begin = border;
            lit = next_lit;
        }
        s = next;
    }
    return sum;
}
