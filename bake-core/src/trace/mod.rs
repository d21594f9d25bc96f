//! Rays against the scene: closest hit, and what is left of light along a segment. Watertight.
