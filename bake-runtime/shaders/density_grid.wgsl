// Density grids: trilinear between points, exact optical length cell by cell. Twin: bake_optics::medium::grid::DensityGrid.
// uses: coefficients, view_ray

fn grid_size(medium: Medium) -> vec3i {
    return vec3i(i32(medium.count_x), i32(medium.count_y), i32(medium.count_z));
}

fn grid_direction(medium: Medium, dir: vec3f) -> vec3f {
    return vec3f(dot(medium.grid_x.xyz, dir), dot(medium.grid_y.xyz, dir), dot(medium.grid_z.xyz, dir));
}

fn grid_place(medium: Medium, place: vec3f) -> vec3f {
    return grid_direction(medium, place) + vec3f(medium.grid_x.w, medium.grid_y.w, medium.grid_z.w);
}

// The value at a point; 0 beyond the outermost.
fn grid_value(medium: Medium, at: vec3i) -> f32 {
    let size = grid_size(medium);
    if any(at < vec3i(0)) || any(at >= size) {
        return 0.0;
    }
    return coefficients[medium.values + u32(at.x + size.x * (at.y + size.y * at.z))];
}

// Values around the cell whose lowest point is `lowest`: those at low z, then at high z.
struct GridCell {
    lowest: vec3i,
    near: vec4f,
    far: vec4f,
}

fn grid_cell(medium: Medium, lowest: vec3i) -> GridCell {
    return GridCell(
        lowest,
        vec4f(
            grid_value(medium, lowest),
            grid_value(medium, lowest + vec3i(1, 0, 0)),
            grid_value(medium, lowest + vec3i(0, 1, 0)),
            grid_value(medium, lowest + vec3i(1, 1, 0)),
        ),
        vec4f(
            grid_value(medium, lowest + vec3i(0, 0, 1)),
            grid_value(medium, lowest + vec3i(1, 0, 1)),
            grid_value(medium, lowest + vec3i(0, 1, 1)),
            grid_value(medium, lowest + vec3i(1, 1, 1)),
        ),
    );
}

// Twin: Cell::at.
fn density_in_cell(cell: GridCell, local: vec3f) -> f32 {
    let share = clamp(local - vec3f(cell.lowest), vec3f(0.0), vec3f(1.0));
    let square = mix(cell.near, cell.far, share.z);
    let edge = mix(square.xy, square.zw, share.y);
    return mix(edge.x, edge.y, share.x);
}

fn grid_at(medium: Medium, place: vec3f) -> f32 {
    let local = grid_place(medium, place);
    if any(local <= vec3f(-1.0)) || any(local >= vec3f(grid_size(medium))) {
        return 0.0;
    }
    return density_in_cell(grid_cell(medium, vec3i(floor(local))), local);
}

// Two Gauss-Legendre nodes a cell, exact for the cubic that a ray meets there.
fn grid_length(medium: Medium, ray: ViewRay) -> f32 {
    let size = grid_size(medium);
    let origin = grid_place(medium, ray.origin);
    let dir = grid_direction(medium, ray.dir);
    let moves = abs(dir) > vec3f(1e-20);
    let speed = select(vec3f(1e-20), dir, moves);
    let first = clamp((vec3f(-1.0) - origin) / speed, vec3f(-1e30), vec3f(1e30));
    let last = clamp((vec3f(size) - origin) / speed, vec3f(-1e30), vec3f(1e30));
    let enter = select(vec3f(-1e30), min(first, last), moves);
    let leave = select(vec3f(1e30), max(first, last), moves);
    var at = max(0.0, max(enter.x, max(enter.y, enter.z)));
    let end = min(ray.length, min(leave.x, min(leave.y, leave.z)));
    let beside = !moves & ((origin <= vec3f(-1.0)) | (origin >= vec3f(size)));
    if at >= end || any(beside) {
        return 0.0;
    }
    let ahead = select(vec3i(-1), vec3i(1), dir > vec3f(0.0));
    var lowest = clamp(vec3i(floor(origin + dir * at)), vec3i(-1), size - 1);
    var sum = 0.0;
    let most = size.x + size.y + size.z + 6;
    for (var i = 0; i < most && at < end; i++) {
        let border = vec3f(lowest + max(ahead, vec3i(0)));
        let reached = select(vec3f(1e30), (border - origin) / speed, moves);
        let exit = min(reached.x, min(reached.y, reached.z));
        let across = select(select(vec3i(0, 0, 1), vec3i(0, 1, 0), reached.y <= reached.z), vec3i(1, 0, 0), reached.x == exit);
        let next = lowest + ahead * across;
        let outside = any(next < vec3i(-1)) || any(next >= size);
        // The last cell takes what rounding left before the border.
        let to = select(min(exit, end), end, outside);
        if to > at {
            let cell = grid_cell(medium, lowest);
            let middle = 0.5 * (at + to);
            let offset = 0.28867513459 * (to - at);
            sum += 0.5 * (to - at) * (density_in_cell(cell, origin + dir * (middle - offset)) + density_in_cell(cell, origin + dir * (middle + offset)));
            at = to;
        }
        lowest = next;
    }
    return sum;
}
