// Where a view ray crosses a cone about the lamp's axis, and how far inside it a point is: differences that one f32 cannot hold
// where a ray grazes the cone.
// uses: sight, twofold

// No crossing.
const NOWHERE = 1e30;

// Squared cosine of the axis with the normal dir x q of the plane that ray and lamp span, in two parts.
fn off_square(dir: vec3f, q: vec3f, axis: vec3f) -> vec2f {
    var along_normal = vec2f(0.0);
    var normal_square = vec2f(0.0);
    var axis_square = vec2f(0.0);
    for (var i = 0u; i < 3u; i++) {
        let j = (i + 1u) % 3u;
        let k = (i + 2u) % 3u;
        let normal = two_add(two_product(dir[j], q[k]), -two_product(dir[k], q[j]));
        along_normal = two_add(along_normal, two_times(normal, vec2f(axis[i], 0.0)));
        normal_square = two_add(normal_square, two_times(normal, normal));
        axis_square = two_add(axis_square, two_product(axis[i], axis[i]));
    }
    return two_over(two_times(along_normal, along_normal), two_times(normal_square, axis_square));
}

// Where cos_axis passes `cosine`, past the foot. Twin: Sight::crossings, with a^2 + e^2 - c^2 = (1 - c^2) - off_square.
fn crossings(sight: Sight, off: vec2f, cosine: f32) -> vec2f {
    let e = sight.axis_along;
    let a = sight.axis_across;
    let square = two_add(two_times(two_sum(1.0, -cosine), two_sum(1.0, cosine)), -off).x;
    if square < 0.0 {
        return vec2f(NOWHERE);
    }
    let root = sqrt(square);
    let b = select(a - root, a + root, a >= 0.0);
    let v = vec2f(
        select(-b / (e - cosine), 0.0, abs(e - cosine) < 1e-9),
        select((e + cosine) / b, 0.0, abs(b) < 1e-9),
    );
    let z = 0.5 * sight.h * (v - 1.0 / max(v, vec2f(1e-12)));
    return select(vec2f(NOWHERE), z, v > vec2f(1e-9));
}

// cos_axis less the outer edge's cosine c: between two crossings z_1, z_2 by the roots of
// cos^2 - c^2 = (e^2 - c^2) (z - z_1) (z - z_2)/r^2, e = axis_along.
fn beyond_edge(sight: Sight, point: PathPoint, cosine: f32, edge: f32) -> f32 {
    if max(sight.outer.x, sight.outer.y) >= NOWHERE || edge + cosine < 0.1 {
        return cosine - edge;
    }
    let r = distance_at(point.place.z, sight.h);
    let lead = (sight.axis_along - edge) * (sight.axis_along + edge);
    return lead * ((point.place.z - sight.outer.x) / r) * ((point.place.z - sight.outer.y) / r) / (cosine + edge);
}
