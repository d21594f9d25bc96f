// What lies behind all surfaces: a uniform sky, or the environment's picture.
// uses: frame, screen
// uses: sky_picture // if SKY_PICTURE

@fragment
fn fragment(in: Screen) -> @location(0) vec4f {
    let radiance = frame.sky; // unless SKY_PICTURE
    let dir = normalize(view_direction(in.position.xy)); // if SKY_PICTURE
    var radiance = frame.sky * latitude_longitude(sky_texels, dir, frame.sky_rotation); // if SKY_PICTURE
    radiance += latitude_longitude(glow_texels, dir, 0.0); // if SKY_PICTURE&SKY_FOGGED
    return vec4f(radiance, 1.0);
}
