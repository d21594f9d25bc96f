// Geometry of one view ray and one lamp. Twin: bake_optics::airlight::Sight, whose module derives the formulas.
// uses: arithmetic, phase

struct Sight {
    // Signed distance of the eye past the lamp's foot on the ray.
    z: f32,
    // Distance of the lamp from the line, at least its radius.
    h: f32,
    length: f32,
    eye_distance: f32,
    // r - z and r + z at the eye.
    ahead: f32,
    behind: f32,
    // Cosines of the lamp's axis with the ray and with the direction lamp -> foot.
    axis_along: f32,
    axis_across: f32,
    // Cosine of the lamp's axis with the plane's normal, >= 0.
    axis_off: f32,
}

struct PathPoint {
    // Distance from the eye.
    s: f32,
    // Length of lamp -> point -> eye beyond the direct way.
    excess: f32,
    deflection: Deflection,
    sin_theta: f32,
}

// A lamp is nowhere nearer than this share of its distance, nor than a nanometre: 1/r^2 stays finite for lamps without radius.
const LEAST_SHARE = 1e-6;

// w x q by split products: near the line the plain ones keep no digit of h.
fn moment(dir: vec3f, q: vec3f) -> vec3f {
    return vec3f(
        difference_of_products(dir.y, q.z, dir.z, q.y),
        difference_of_products(dir.z, q.x, dir.x, q.z),
        difference_of_products(dir.x, q.y, dir.y, q.x),
    );
}

// Twin: Sight::from_points. q = eye - lamp.
fn sight_of(dir: vec3f, q: vec3f, length_of_ray: f32, axis: vec3f, radius: f32) -> Sight {
    var sight: Sight;
    let across = moment(dir, q);
    let line = length(across);
    sight.h = max(line, max(radius, max(LEAST_SHARE * length(q), 1e-9)));
    sight.z = dot(dir, q);
    sight.length = length_of_ray;
    sight.eye_distance = sqrt(sight.z * sight.z + sight.h * sight.h);
    let far = sight.eye_distance + abs(sight.z);
    let other = sight.h * (sight.h / far);
    sight.ahead = select(other, far, sight.z <= 0.0);
    sight.behind = select(far, other, sight.z <= 0.0);
    sight.axis_along = dot(dir, axis);
    let limit = sqrt(max(0.0, (1.0 - sight.axis_along) * (1.0 + sight.axis_along)));
    let foot = dot(cross(across, dir), axis) / max(line, 1e-20);
    sight.axis_across = select(limit, clamp(foot, -limit, limit), line > 0.0);
    sight.axis_off = abs(dot(across, axis)) / max(line, 1e-20);
    return sight;
}

// sqrt(z^2 + h^2).
fn distance_at(z: f32, h: f32) -> f32 {
    return max(sqrt(z * z + h * h), max(abs(z), h));
}

// Twin: Sight::reach. Where the path has grown by `excess`.
fn reach(sight: Sight, excess: f32) -> f32 {
    return 0.5 * excess * (1.0 + sight.ahead / (sight.behind + excess));
}

// Twin: Sight::excess.
fn excess_at(sight: Sight, s: f32) -> f32 {
    let z = sight.z + s;
    let r = distance_at(z, sight.h);
    let slope = (z + sight.z) / (r + sight.eye_distance);
    if slope >= 0.0 {
        return s * (1.0 + slope);
    }
    if z <= 0.0 {
        return s * (1.0 - slope) * (sight.h / (r - z)) * (sight.h / (sight.eye_distance - sight.z));
    }
    return r + z - sight.behind;
}

// Twin: PathPoint::new. near = h/max(x, y).
fn path_point(s: f32, excess: f32, near: f32, past: bool) -> PathPoint {
    let square = near * near;
    let inverse = 1.0 / (1.0 + square);
    let small = 2.0 * square * inverse;
    let large = 2.0 * inverse;
    let cosine = (1.0 - square) * inverse;
    var deflection = Deflection(cosine, small, large);
    if past {
        deflection = Deflection(-cosine, large, small);
    }
    return PathPoint(s, excess, deflection, 2.0 * near * inverse);
}

// Twin: Sight::point.
fn point_at(sight: Sight, s: f32) -> PathPoint {
    let z = sight.z + s;
    let r = distance_at(z, sight.h);
    return path_point(s, excess_at(sight, s), sight.h / (r + abs(z)), z > 0.0);
}

// Twin: Sight::cos_axis.
fn cos_axis(sight: Sight, point: PathPoint) -> f32 {
    return sight.axis_across * point.sin_theta - sight.axis_along * point.deflection.cos_theta;
}

// Twin: Sight::crossings: distances where cos_axis passes `cosine`, -1 where it does not. a^2 + e^2 - c^2 is formed from the
// axis' part off the plane, in which grazing rays keep more digits.
fn crossings(sight: Sight, cosine: f32) -> vec2f {
    let e = sight.axis_along;
    let a = sight.axis_across;
    let sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    let square = (sine - sight.axis_off) * (sine + sight.axis_off);
    if square < 0.0 {
        return vec2f(-1.0);
    }
    let root = sqrt(square);
    let b = select(a - root, a + root, a >= 0.0);
    let v = vec2f(
        select(-b / (e - cosine), 0.0, abs(e - cosine) < 1e-9),
        select((e + cosine) / b, 0.0, abs(b) < 1e-9),
    );
    let s = 0.5 * sight.h * (v - 1.0 / max(v, vec2f(1e-12))) - sight.z;
    return select(vec2f(-1.0), s, v > vec2f(1e-9));
}
