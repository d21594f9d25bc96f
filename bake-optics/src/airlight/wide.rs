//! Eight rays at once in f32.
