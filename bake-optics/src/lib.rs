//! Formulas of light in air: special functions, phase functions, media, air-light, harmonics. No I/O, threads or logging.
