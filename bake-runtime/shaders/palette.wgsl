// Colours for numbers, linear; the stops are generated from palette.rs. Twin: Palette::color.

// Share 0 is the first stop, 1 the last.
fn palette_color(share: f32) -> vec3f {
    let at = clamp(share, 0.0, 1.0) * f32(PALETTE_COUNT - 1u);
    let low = min(u32(at), PALETTE_COUNT - 2u);
    return mix(PALETTE[low], PALETTE[low + 1u], at - f32(low));
}
