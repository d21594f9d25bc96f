// Shadow maps: whether a lamp or a sun reaches a place (relative to the eye).

@group(0) @binding(19) var<storage, read> shadow_views: array<ShadowView>;
@group(0) @binding(20) var shadow_map: texture_depth_2d_array;

const UNSHADOWED = 0xffffffffu;

// Depths are reversed: lit where nothing lies nearer to the light.
fn layer_is_lit(layer: u32, place: vec3f) -> bool {
    let clip = shadow_views[layer].clip_from_relative * vec4f(place, 1.0);
    if clip.w <= 0.0 {
        return true;
    }
    let share = clip.xyz / clip.w;
    if any(abs(share.xy) >= vec2f(1.0)) {
        return true;
    }
    let size = vec2f(textureDimensions(shadow_map));
    let texel = vec2i((share.xy * vec2f(0.5, -0.5) + 0.5) * size);
    return share.z >= textureLoad(shadow_map, texel, layer, 0) * (1.0 - 2e-4);
}

// The face of a point lamp's cube that looks towards an offset: +x, -x, +y, -y, +z, -z.
fn face_of(offset: vec3f) -> u32 {
    let a = abs(offset);
    if a.x >= a.y && a.x >= a.z { return select(1u, 0u, offset.x > 0.0); }
    if a.y >= a.z { return select(3u, 2u, offset.y > 0.0); }
    return select(5u, 4u, offset.z > 0.0);
}

// The maps of one light: its first layer, how many (6: a cube's faces about `centre`).
struct ShadowMaps {
    centre: vec3f,
    first: u32,
    count: u32,
}

fn maps_of_lamp(lamp: Lamp) -> ShadowMaps {
    return ShadowMaps(lamp.position, lamp.shadow, lamp.shadow_count);
}

fn maps_of_sun(sun: Sun) -> ShadowMaps {
    return ShadowMaps(vec3f(0.0), sun.shadow, 1u);
}

fn is_lit(maps: ShadowMaps, place: vec3f) -> bool {
    if maps.first == UNSHADOWED {
        return true;
    }
    let face = select(0u, face_of(place - maps.centre), maps.count == 6u);
    return layer_is_lit(maps.first + face, place);
}

// How far off the surface a shadow is looked up: about two texels of the map, metres.
fn shadow_offset(lamp: Lamp, place: vec3f) -> f32 {
    return 4.0 * length(place - lamp.position) / f32(textureDimensions(shadow_map).x);
}
