// Density that falls off about a ball, by Gauss-Legendre nodes over the hyperbolic angle. Twin: bake_optics::medium::planet, whose
// module derives the formulas. Altitudes grow from the eye's own, which f32 would not hold as a radius.
// uses: arithmetic, view_ray

// Exponent after which a climbing ray has left the air.
const ORBIT_DEPTH = 20.0;

// Altitude and distance from the centre.
struct Orbit {
    altitude: f32,
    radius: f32,
}

// How much farther from the centre: q/(r + sqrt(r^2 + q)).
fn orbit_rise(radius: f32, q: f32) -> f32 {
    return q / (radius + sqrt(max(radius * radius + q, 0.0)));
}

fn orbit_of(medium: Medium, place: vec3f) -> Orbit {
    let rise = orbit_rise(medium.grid_x.w, dot(place, place - 2.0 * medium.grid_x.xyz));
    return Orbit(medium.base + rise, medium.grid_x.w + rise);
}

// e^(-n altitude), cut where products would overflow.
fn planet_density(n: f32, altitude: f32) -> f32 {
    return exp(clamp(-n * altitude, -DARK, THICKEST));
}

fn planet_at(medium: Medium, place: vec3f) -> f32 {
    return planet_density(medium.slope, orbit_of(medium, place).altitude);
}

// Distance along a climbing line from radius r0, `tangent` past its perigee, after which the exponent is `depth`.
fn orbit_reach(n: f32, r0: f32, tangent: f32, depth: f32) -> f32 {
    let rise = depth / n;
    let gained = rise * (2.0 * r0 + rise);
    return gained / (tangent + sqrt(tangent * tangent + gained));
}

// Hyperbolic angle of the point `length_of_ray` further on.
fn orbit_angle(r0: f32, tangent: f32, length_of_ray: f32) -> f32 {
    let sum = length_of_ray * (2.0 * tangent + length_of_ray);
    let growth = sum / (r0 + sqrt(r0 * r0 + sum));
    return log1p((length_of_ray + growth) / (tangent + r0));
}

fn orbit_panel(n: f32, r0: f32, tangent: f32, begin: f32, width: f32) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < ORBIT_COUNT; i++) {
        let m = expm1(0.5 * (begin + width * ORBIT_NODES[i]));
        let s = 0.5 * (m + m / (1.0 + m));
        let c = 0.5 * (1.0 + m + 1.0 / (1.0 + m));
        sum += ORBIT_WEIGHTS[i] * fall(2.0 * n * s * (r0 * s + tangent * c)) * (r0 * (1.0 + 2.0 * s * s) + 2.0 * tangent * s * c);
    }
    return width * sum;
}

// Twin: Rising::optical_length. One panel, or three where the air ends within the ray.
fn climbing_length(n: f32, radius: f32, tangent: f32, length_of_ray: f32) -> f32 {
    let r0 = max(radius, 1.7e-5 / n);
    let passed = min(length_of_ray, orbit_reach(n, r0, tangent, ORBIT_DEPTH));
    let end = orbit_angle(r0, tangent, passed);
    var borders = vec3f(end);
    if end >= 1.0 {
        borders.x = orbit_angle(r0, tangent, min(orbit_reach(n, r0, tangent, 0.02), passed));
        borders.y = orbit_angle(r0, tangent, min(orbit_reach(n, r0, tangent, 1.0), passed));
    }
    var begin = 0.0;
    var sum = 0.0;
    for (var i = 0u; i < 3u && begin < end; i++) {
        sum += orbit_panel(n, r0, tangent, begin, borders[i] - begin);
        begin = borders[i];
    }
    return exp(clamp(n * (radius - r0), -DARK, 0.0)) * sum;
}

// Twin: planet::optical_length. A ray climbs from one end, or from its lowest place to both.
fn planet_length(medium: Medium, ray: ViewRay) -> f32 {
    let n = medium.slope;
    let start = orbit_of(medium, ray.origin);
    let from_centre = ray.origin - medium.grid_x.xyz;
    let cosine = clamp(dot(from_centre, ray.dir) / max(start.radius, 1e-20), -1.0, 1.0);
    let perigee = -start.radius * cosine;
    var rise = 0.0;
    var tangent = -perigee;
    var low = start.radius;
    var climbs = vec2f(ray.length, 0.0);
    if perigee > 0.0 && ray.length <= perigee {
        rise = orbit_rise(start.radius, ray.length * (ray.length - 2.0 * perigee));
        tangent = perigee - ray.length;
        low = start.radius + rise;
    } else if perigee > 0.0 {
        let sine = sqrt((1.0 - cosine) * (1.0 + cosine));
        rise = perigee * cosine / (1.0 + sine);
        tangent = 0.0;
        low = start.radius * sine;
        climbs = vec2f(perigee, ray.length - perigee);
    }
    var sum = 0.0;
    for (var i = 0u; i < 2u && climbs[i] > 0.0; i++) {
        sum += climbing_length(n, low, tangent, climbs[i]);
    }
    return planet_density(n, start.altitude + rise) * sum;
}

// Distance after which a ray from the eye has left the air for good.
fn planet_end(medium: Medium, ray: ViewRay) -> f32 {
    let along = dot(ray.origin - medium.grid_x.xyz, ray.dir);
    let height = 25.0 / medium.slope - min(medium.base, 0.0);
    let gained = height * (2.0 * medium.grid_x.w + height);
    let root = sqrt(along * along + gained);
    return select(root - along, gained / (root + along), along > 0.0);
}
