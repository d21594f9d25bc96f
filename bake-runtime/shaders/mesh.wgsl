// The inside of a closed mesh: sorted parts of a ray, watertight. Twin: bake_optics::medium::mesh::ClosedMesh.
//
// Crossings are decided by exact signs of 2 x 2 determinants, ties by moving the ray aside by (eps, eps^2): what enters leaves.
// uses: twofold, coefficients, view_ray

// Crossings ahead of a ray's start that are told apart; the nearest ones.
const MESH_CROSSINGS = 16u;
const MESH_PARTS = 9u;

// Numbers of a box: lowest corner, the box after its own; highest corner, first triangle times 8 plus their number.
const MESH_BOX = 8u;

struct MeshCrossings {
    // Distance; +1 where the ray leaves a shell, -1 where it enters one.
    at: array<vec2f, MESH_CROSSINGS>,
    count: u32,
    // Shells around the start.
    winding: f32,
}

// Distances of entry and exit.
struct MeshParts {
    at: array<vec2f, MESH_PARTS>,
    count: u32,
}

// The ray as third axis: order of axes, shear, distance per step along the largest axis. Twin: Sheared.
struct Sheared {
    axes: vec3u,
    shear: vec2f,
    scale: f32,
}

fn mesh_vector(at: u32) -> vec3f {
    return vec3f(coefficients[at], coefficients[at + 1u], coefficients[at + 2u]);
}

fn sheared_of(dir: vec3f) -> Sheared {
    let size = abs(dir);
    var z = select(1u, 0u, size.x >= size.y);
    if size.z > max(size.x, size.y) { z = 2u; }
    let x = (z + 1u) % 3u;
    let y = (z + 2u) % 3u;
    return Sheared(vec3u(x, y, z), vec2f(dir[x], dir[y]) / dir[z], 1.0 / dir[z]);
}

// The same bits for a corner in whichever triangle.
fn sheared_point(sheared: Sheared, from_origin: vec3f) -> vec3f {
    let z = from_origin[sheared.axes.z];
    let aside = vec2f(kept(sheared.shear.x * z), kept(sheared.shear.y * z));
    return vec3f(kept(from_origin[sheared.axes.x] - aside.x), kept(from_origin[sheared.axes.y] - aside.y), z);
}

// Side of the edge from a to b on which the origin lies: +1, -1; 0 only where a = b. Twin: side.
fn mesh_side(a: vec3f, b: vec3f) -> f32 {
    let p = two_product(a.x, b.y);
    let q = two_product(a.y, b.x);
    if p.x != q.x { return sign(p.x - q.x); }
    if p.y != q.y { return sign(p.y - q.y); }
    if a.y != b.y { return sign(a.y - b.y); }
    return sign(b.x - a.x);
}

// Whether the half line may meet a box: separating axes (Ericson 2005, section 5.3.3). Twin: Line::may_meet.
fn may_meet(ray: ViewRay, low: vec3f, high: vec3f) -> bool {
    let centre = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let from_centre = ray.origin - centre;
    let slack = 2e-6 * dot(abs(ray.origin) + abs(centre) + half, vec3f(1.0));
    let d = abs(ray.dir);
    let reach = half.yzx * d.zxy + half.zxy * d.yzx;
    return all(abs(cross(from_centre, ray.dir)) <= reach + slack) && dot(half, d) - dot(from_centre, ray.dir) >= -slack;
}

// Twin: Sheared::crossing. A distance below 0 is none ahead.
fn mesh_crossing(sheared: Sheared, a: vec3f, b: vec3f, c: vec3f) -> vec2f {
    let turn = mesh_side(b, c);
    if turn == 0.0 || mesh_side(c, a) != turn || mesh_side(a, b) != turn {
        return vec2f(-1.0, 0.0);
    }
    let u = difference_of_products(b.x, c.y, b.y, c.x);
    let v = difference_of_products(c.x, a.y, c.y, a.x);
    let w = difference_of_products(a.x, b.y, a.y, b.x);
    let area = u + v + w;
    // From the first corner, so that large depths do not cancel. Rounding may leave a sliver no area: any point of it will do.
    var depth = a.z;
    if abs(area) > 1e-37 { depth += (v * (b.z - a.z) + w * (c.z - a.z)) / area; }
    depth = clamp(depth, min(a.z, min(b.z, c.z)), max(a.z, max(b.z, c.z)));
    return vec2f(depth * sheared.scale, turn * sign(sheared.scale));
}

// Keeps the nearest crossings, in order.
fn add_crossing(list: ptr<function, MeshCrossings>, crossing: vec2f) {
    var i = min((*list).count, MESH_CROSSINGS - 1u);
    if (*list).count == MESH_CROSSINGS && crossing.x >= (*list).at[i].x {
        return;
    }
    while i > 0u && crossing.x < (*list).at[i - 1u].x {
        (*list).at[i] = (*list).at[i - 1u];
        i--;
    }
    (*list).at[i] = crossing;
    (*list).count = min((*list).count + 1u, MESH_CROSSINGS);
}

// Crossings of the half line. Boxes lie depth first; one that is missed names the box after all that it holds.
fn mesh_crossings(medium: Medium, ray: ViewRay) -> MeshCrossings {
    let sheared = sheared_of(ray.dir);
    let triangles = medium.planes + MESH_BOX * medium.plane_count;
    var list: MeshCrossings;
    list.count = 0u;
    list.winding = 0.0;
    var index = 0u;
    // Each box is seen once.
    for (var seen = 0u; seen < medium.plane_count && index < medium.plane_count; seen++) {
        let box = medium.planes + MESH_BOX * index;
        if !may_meet(ray, mesh_vector(box), mesh_vector(box + 4u)) {
            index = u32(coefficients[box + 3u]);
            continue;
        }
        let leaf = u32(coefficients[box + 7u]);
        for (var i = leaf / 8u; i < leaf / 8u + leaf % 8u; i++) {
            let at = triangles + 9u * i;
            let a = sheared_point(sheared, mesh_vector(at) - ray.origin);
            let b = sheared_point(sheared, mesh_vector(at + 3u) - ray.origin);
            let c = sheared_point(sheared, mesh_vector(at + 6u) - ray.origin);
            let crossing = mesh_crossing(sheared, a, b, c);
            if crossing.x > 0.0 {
                list.winding += crossing.y;
                add_crossing(&list, crossing);
            }
        }
        index++;
    }
    return list;
}

// The parts of the ray inside, cut to [0, length]. Twin: ClosedMesh::intervals.
fn mesh_parts(medium: Medium, ray: ViewRay) -> MeshParts {
    let list = mesh_crossings(medium, ray);
    var parts: MeshParts;
    parts.count = 0u;
    var winding = list.winding;
    var begin = 0.0;
    for (var i = 0u; i < list.count; i++) {
        let before = winding;
        winding -= list.at[i].y;
        if before == 0.0 {
            begin = list.at[i].x;
        } else if winding == 0.0 && begin < min(list.at[i].x, ray.length) {
            parts.at[parts.count] = vec2f(begin, min(list.at[i].x, ray.length));
            parts.count++;
        }
    }
    return parts;
}

// Twin: ClosedMesh::contains.
fn inside_mesh(medium: Medium, place: vec3f) -> bool {
    return mesh_crossings(medium, ViewRay(place, vec3f(0.36, 0.48, 0.8), FAR)).winding != 0.0;
}
