// A view ray: starts relative to the eye, unit direction in world axes, length in metres.

struct ViewRay {
    origin: vec3f,
    dir: vec3f,
    length: f32,
}

// Length of rays that meet no surface, metres.
const FAR = 1e9;
