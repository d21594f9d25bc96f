//! Light on texels and probes.

pub mod buffers;
