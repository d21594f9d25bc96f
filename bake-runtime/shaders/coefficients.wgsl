// Numbers that media and lamps refer to: series, planes, grids.

@group(0) @binding(10) var<storage, read> coefficients: array<f32>;
