// Legendre moments of the media's phase functions: ORDERS a medium.

@group(0) @binding(13) var<storage, read> moments: array<f32>;
