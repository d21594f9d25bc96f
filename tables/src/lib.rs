//! Impulse-response tables: compute, map, store, look up.
