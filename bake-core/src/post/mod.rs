//! What is done to finished buffers: seams, dilation.
