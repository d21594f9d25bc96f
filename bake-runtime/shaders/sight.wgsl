// Geometry of one view ray and one lamp. Twin: bake_optics::airlight::Sight, whose module derives the formulas.
// uses: arithmetic, phase, twofold

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
    // Where the ray crosses the outer and the inner edge of the lamp's cone, past the foot; NOWHERE where it does not.
    outer: vec2f, // if LAMP_CONE
    inner: vec2f, // if LAMP_CONE
}

// A place on the ray: each number has digits where the other has lost them, near the eye and near the lamp.
struct Place {
    // Distance from the eye.
    s: f32,
    // Signed distance past the lamp's foot.
    z: f32,
}

struct PathPoint {
    place: Place,
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
    sight.z = exact_dot(dir, q);
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

fn place_at(sight: Sight, s: f32) -> Place {
    return Place(s, sight.z + s);
}

fn place_past_foot(sight: Sight, z: f32) -> Place {
    return Place(z - sight.z, z);
}

fn lies_before(a: Place, b: Place) -> bool {
    return a.z < b.z || (a.z == b.z && a.s < b.s);
}

// From one place to the next, by the numbers that keep more digits of it.
fn way_between(a: Place, b: Place) -> f32 {
    return select(b.z - a.z, b.s - a.s, abs(b.s) <= max(abs(a.z), abs(b.z)));
}

// Twin: Sight::excess.
fn excess_at(sight: Sight, place: Place) -> f32 {
    let s = place.s;
    let z = place.z;
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
fn path_point(place: Place, excess: f32, near: f32, past: bool) -> PathPoint {
    let square = near * near;
    let inverse = 1.0 / (1.0 + square);
    let small = 2.0 * square * inverse;
    let large = 2.0 * inverse;
    let cosine = (1.0 - square) * inverse;
    var deflection = Deflection(cosine, small, large);
    if past {
        deflection = Deflection(-cosine, large, small);
    }
    return PathPoint(place, excess, deflection, 2.0 * near * inverse);
}

// Twin: Sight::point.
fn point_at(sight: Sight, place: Place) -> PathPoint {
    let r = distance_at(place.z, sight.h);
    return path_point(place, excess_at(sight, place), sight.h / (r + abs(place.z)), place.z > 0.0);
}

// Twin: Sight::cos_axis.
fn cos_axis(sight: Sight, point: PathPoint) -> f32 {
    return sight.axis_across * point.sin_theta - sight.axis_along * point.deflection.cos_theta;
}
