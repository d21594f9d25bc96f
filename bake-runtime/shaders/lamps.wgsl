// Lights of the picture; places relative to the eye.

@group(0) @binding(14) var<storage, read> lamps: array<Lamp>; // if LAMPS
@group(0) @binding(15) var<storage, read> suns: array<Sun>; // if SUNS
